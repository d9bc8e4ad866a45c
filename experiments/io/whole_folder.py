"""Several files that appear in a folder together or not at all."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Generator, Sequence
from contextlib import contextmanager
from pathlib import Path

from icage.errors import OutputError


@contextmanager
def whole_folder(folder: Path, names: Sequence[str]) -> Generator[Path]:
    """A place to write files to; they move into ``folder`` together when the block ends well.

    ``folder`` is made if need be. Files of an earlier run among ``names`` that this one did not
    write again are removed: they would speak of another run.

    Raises
    ------
    OutputError:
        Nothing can be written there.
    """
    made = [part for part in (folder, *folder.parents) if not part.exists()]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        staging = Path(tempfile.mkdtemp(prefix=".replay-", dir=folder))
    except OSError as error:
        raise OutputError(f"{str(folder)!r} cannot be written to: {error.strerror}") from error
    try:
        yield staging
        for name in names:
            written = staging / name
            if written.exists():
                written.replace(folder / name)
            else:
                (folder / name).unlink(missing_ok=True)
    finally:
        shutil.rmtree(staging, ignore_errors=True)
        for part in made:  # deepest first; only while empty
            if part.is_dir() and not any(part.iterdir()):
                part.rmdir()
