"""What all kernels say together: the stamp of their machine code.

It is that of the sources as they were when the first kernel was imported. Sources may change while
a process runs (an update, a merge); what it compiles then is of the old ones, of the new ones or of
both, and must not be kept under anybody's stamp.
"""

from __future__ import annotations

import hashlib
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple


class _Read(NamedTuple):
    digest: str
    written: tuple[tuple[int, int], ...]
    """When each file was written, [ns], and its size: cheaper to ask again than the digest."""


def kernel_digest() -> str:
    """Digest of the sources of all kernels, and of the tolerances that they hold as constants."""
    return _as_first_read().digest


def sources_changed() -> bool:
    """Whether a source was written since the digest was taken."""
    return _written(_sources()) != _as_first_read().written


@lru_cache(maxsize=1)
def _as_first_read() -> _Read:
    package = Path(__file__).parents[1]
    files = _sources()
    written = _written(files)
    digest = hashlib.sha256()
    for path in files:
        digest.update(path.relative_to(package).as_posix().encode())
        digest.update(path.read_bytes())
    return _Read(digest.hexdigest(), written)


def _sources() -> list[Path]:
    package = Path(__file__).parents[1]
    return sorted([package / "tolerance.py", *package.glob("**/kernels/*.py")])


def _written(files: list[Path]) -> tuple[tuple[int, int], ...]:
    try:
        found = [file.stat() for file in files]
    except OSError:  # one has gone since it was listed
        return ()
    return tuple((one.st_mtime_ns, one.st_size) for one in found)
