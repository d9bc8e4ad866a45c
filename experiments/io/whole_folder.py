"""Several files that appear in a folder together or not at all."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from contextlib import contextmanager
from pathlib import Path

from experiments.io.held_folder import folder_for_a_while, writable
from icage.staging import staging


@contextmanager
def whole_folder(folder: Path, names: Sequence[str]) -> Generator[Path]:
    """A place to write files to; they move into ``folder`` together when the block ends well.

    ``folder`` is made if need be. Files of an earlier run among ``names`` that this one did not
    write again are removed: they would speak of another run.

    Raises
    ------
    OutputError:
        Nothing can be written there, or not all of them can be moved: then none is.
    """
    with folder_for_a_while(folder), writable(folder), staging(folder) as place:
        yield place.new
        place.move(names)
