"""What compiled functions that call one another say together: the stamp of their machine code.

It is that of the sources as they were when the first of them was imported. Sources may change while
a process runs (an update, a merge); what it compiles then is of the old ones, of the new ones or of
both, and must not be kept under anybody's stamp.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Final


class Sources:
    """Files of one folder, as they are when this is made.

    Examples
    --------
    >>> here = Sources(Path(__file__).parent, lambda: [Path(__file__)])
    >>> len(here.digest), here.changed()
    (64, False)
    """

    def __init__(self, folder: Path, files: Callable[[], list[Path]]) -> None:
        self._files = files
        found = files()
        self._written = _written(found)
        digest = hashlib.sha256()
        for path in found:
            digest.update(path.relative_to(folder).as_posix().encode())
            digest.update(path.read_bytes())
        self.digest: Final = digest.hexdigest()
        """Of their names and contents."""

    def changed(self) -> bool:
        """Whether one was written since, came or went."""
        return _written(self._files()) != self._written


@lru_cache(maxsize=1)
def kernel_sources() -> Sources:
    """The sources of all kernels, and the tolerances that they hold as constants."""
    package = Path(__file__).parents[1]
    return Sources(
        package, lambda: sorted([package / "tolerance.py", *package.glob("**/kernels/*.py")])
    )


def _written(files: list[Path]) -> tuple[tuple[int, int], ...]:
    """When each was written, [ns], and its size: cheaper to ask than the digest."""
    try:
        found = [file.stat() for file in files]
    except OSError:  # one has gone since it was listed
        return ()
    return tuple((one.st_mtime_ns, one.st_size) for one in found)
