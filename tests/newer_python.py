"""Pythons on this machine that are newer than this one: on PATH, pyenv's, uv's."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Final

NEWEST: Final = 20
"""Minor version of the newest Python that is looked for."""

_VERSION: Final = "import sys; print(*sys.version_info[:2], sys.version_info.releaselevel)"


def newer_pythons() -> list[Path]:
    """One of each newer minor version, the newest first; none that is no release."""
    found: dict[tuple[int, int], Path] = {}
    for python in candidates():
        version = version_of(python)
        if version is not None and version > sys.version_info[:2]:
            found.setdefault(version, python)
    return [found[version] for version in sorted(found, reverse=True)]


def candidates() -> Iterator[Path]:
    """Programs that may be a Python."""
    for minor in range(NEWEST, sys.version_info.minor, -1):
        path = shutil.which(f"python3.{minor}")
        if path is not None:
            yield Path(path)
    for name in _told("pyenv", "versions", "--bare"):
        if re.fullmatch(r"3\.\d+(\.\d+)?", name):
            yield from (Path(folder) / "bin/python" for folder in _told("pyenv", "prefix", name))
    for minor in range(NEWEST, sys.version_info.minor, -1) if shutil.which("uv") else ():
        yield from map(Path, _told("uv", "python", "find", "--no-python-downloads", f"3.{minor}"))


def version_of(python: Path) -> tuple[int, int] | None:
    """Major and minor version of a released Python; None of anything else.

    >>> version_of(Path(sys.executable)) == sys.version_info[:2]
    True
    >>> version_of(Path("no such program")) is None
    True
    """
    match [line.split() for line in _told(str(python), "-I", "-c", _VERSION)]:
        case [[major, minor, "final"]]:
            return int(major), int(minor)
        case _:
            return None


def _told(*command: str) -> Iterable[str]:
    """Lines of what a command prints; none if there is no such command, or it fails.

    pyenv puts a ``python3.13`` on PATH that only says that another version is chosen.
    """
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    except (OSError, subprocess.TimeoutExpired):
        return []
    return [] if done.returncode else done.stdout.splitlines()
