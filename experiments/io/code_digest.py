"""Which code computes: a version number stays the same while its sources change."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from typing import Final

_ROOT: Final = Path(__file__).parents[2]

DECIDES: Final = {
    "icage": ("icage/**/*.py",),
    "sim": ("sim/**/*.py", "models/*.py", "models/hand/**/*.py", "models/hand/**/*.xml"),
    "experiments": (
        "experiments/cases/*.py",
        "experiments/collection/*.py",
        "experiments/grasps/*.py",
        "experiments/study/inputs/*.py",
        "experiments/study/run/*.py",
        "experiments/study/report/indices.py",
    ),
}
"""Room to the sources of it that decide a row of a table; ..."""

_NOT: Final = ("sim/camera", "sim/chipmunk")
"""... these draw, or are another engine. Reports, figures and the command line decide none."""

_LETTERS: Final = 10
"""Of a digest: enough to tell apart, short enough to be read."""


@lru_cache(maxsize=1)
def code_digest() -> str:
    """A word for each room, such as ``icage-1c5be2a9f0 sim-...``; read once in a process.

    Of names and contents, with line ends as they are on Unix: a checkout on Windows, a wheel and
    an editable installation of the same sources have the same one. Libraries are not in it, they
    have versions; nor are compiled kernels, which are stamped with their sources.
    """
    return " ".join(f"{room}-{digest_of(_ROOT, DECIDES[room])}" for room in DECIDES)


def digest_of(root: Path, patterns: tuple[str, ...]) -> str:
    """Digest of the sources below a folder; ``none`` where they are not there to be read."""
    digest, count = hashlib.sha256(), 0
    for name, path in sorted(_sources(root, patterns)):
        digest.update(f"{name}\0".encode())
        digest.update(path.read_bytes().replace(b"\r\n", b"\n"))
        digest.update(b"\0")
        count += 1
    return digest.hexdigest()[:_LETTERS] if count else "none"


def _sources(root: Path, patterns: tuple[str, ...]) -> Iterator[tuple[str, Path]]:
    for pattern in patterns:
        for path in root.glob(pattern):
            name = path.relative_to(root).as_posix()
            if not name.startswith(_NOT):
                yield name, path
