"""What all kernels say together: the stamp of their machine code."""

from __future__ import annotations

import hashlib
from functools import lru_cache
from pathlib import Path


@lru_cache(maxsize=1)
def kernel_digest() -> str:
    """Digest of the sources of all kernels, and of the tolerances that they hold as constants."""
    package = Path(__file__).parents[1]
    digest = hashlib.sha256()
    for path in sorted([package / "tolerance.py", *package.glob("**/kernels/*.py")]):
        digest.update(path.relative_to(package).as_posix().encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()
