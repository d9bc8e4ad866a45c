"""Folders for output that is not finished yet. What a killed process left of them is swept.

A staging folder is hidden, stands in the folder that its content is meant for, and holds a record
with its own name, which its process keeps locked. So nobody has to guess by a name whose it is:
what has the record and no lock is of a process that is gone, and everything else stays. Files that
belong together move into their places together: a list of the moves is on the disk before the first
of them, and whoever sweeps ends what was begun. [docs/decisions/0018-nothing-lost.md]
"""

from __future__ import annotations

import errno
import json
import os
import secrets
import shutil
import stat
from collections.abc import Generator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

try:
    import fcntl
except ImportError:  # Windows: nothing is swept there
    fcntl = None

PREFIX: Final = ".icage-"
"""How the name of every staging folder begins."""

_RECORD, _NEW, _OLD, _MOVES = "owner", "new", "old", "moves"

_TRIES: Final = 10


@dataclass(frozen=True, slots=True)
class Staging:
    """A staging folder that this process owns; files are written to ``new``."""

    path: Path

    @property
    def new(self) -> Path:
        """Where to write."""
        return self.path / _NEW

    def move(self, names: Sequence[str]) -> None:
        """All files of these names move beside this folder, or none does.

        One that was not written is removed there: it would speak of an earlier run.

        Raises
        ------
        OSError:
            A move failed. All that were made before are undone or, where the disk lets nothing be
            undone, the next ``sweep`` ends them.
        """
        folder = self.path.parent
        for name in names:
            if (folder / name).is_dir():
                raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(folder / name))
        written = [name for name in names if (self.new / name).exists()]
        others = [n for n in names if n not in written and os.path.lexists(folder / n)]
        (self.path / _OLD).mkdir()
        part = self.path / f"{_MOVES}.part"
        part.write_text(json.dumps({"new": written, "gone": others}), encoding="utf-8")
        part.replace(self.path / _MOVES)
        aside: list[str] = []
        there: list[str] = []
        try:
            for name in (*written, *others):
                if os.path.lexists(folder / name):
                    (folder / name).rename(self.path / _OLD / name)
                    aside.append(name)
            for name in written:
                (self.new / name).rename(folder / name)
                there.append(name)
        except BaseException:
            for name in reversed(there):
                (folder / name).rename(self.new / name)
            for name in reversed(aside):
                (self.path / _OLD / name).rename(folder / name)
            (self.path / _MOVES).unlink()
            raise


@contextmanager
def staging(folder: Path) -> Generator[Staging]:
    """A staging folder in ``folder``, which is there; gone when the block ends, however it ends.

    Raises
    ------
    OSError:
        It cannot be made.
    """
    sweep(folder)
    place, handle = _made(folder)
    try:
        (place / _NEW).mkdir()
        yield Staging(place)
        (place / _MOVES).unlink(missing_ok=True)
    finally:
        try:
            with suppress(OSError):  # the next one sweeps
                _remove(place)
        finally:
            os.close(handle)


def sweep(folder: Path) -> None:
    """Remove what killed processes left in a folder, having ended the moves that they had begun.

    Nothing is touched that a living process, another user or anybody's own files may be.
    """
    if fcntl is None:
        return
    try:
        with os.scandir(folder) as entries:
            places = [Path(entry.path) for entry in entries if entry.name.startswith(PREFIX)]
    except OSError:  # not there, or not to be looked into
        return
    for place in places:
        with suppress(OSError):
            _sweep_one(place)


def _made(folder: Path) -> tuple[Path, int]:
    """A new staging folder and the handle that holds its record."""
    for _ in range(_TRIES):
        place = folder / f"{PREFIX}{secrets.token_hex(4)}"
        try:
            place.mkdir(0o700)
        except FileExistsError:
            continue
        try:
            handle = os.open(place / _RECORD, os.O_CREAT | os.O_EXCL | os.O_RDWR, 0o600)
        except FileNotFoundError:  # somebody swept it: it was empty
            continue
        except BaseException:
            with suppress(OSError):
                place.rmdir()
            raise
        try:
            _lock(handle)
            os.write(handle, _record(place).encode() + b"of process %d\n" % os.getpid())
            if os.path.samestat(os.fstat(handle), (place / _RECORD).stat()):
                return place, handle
        except FileNotFoundError:
            pass
        except BaseException:
            os.close(handle)
            with suppress(OSError):
                _remove(place)
            raise
        os.close(handle)
    raise FileExistsError(f"{str(folder)!r}: others make and remove files there all the time")


def _lock(handle: int) -> None:
    """Hold the record; on a file system without locks nothing is ever swept."""
    if fcntl is not None:
        with suppress(OSError):
            fcntl.flock(handle, fcntl.LOCK_EX)


def _record(place: Path) -> str:
    return f"icage staging folder {place.name}\n"


def _sweep_one(place: Path) -> None:
    found = place.lstat()
    if fcntl is None or not stat.S_ISDIR(found.st_mode) or found.st_uid != os.getuid():
        return
    try:
        handle = os.open(place / _RECORD, os.O_RDWR | os.O_NOFOLLOW | os.O_NONBLOCK)
    except FileNotFoundError:
        place.rmdir()  # only if it is empty
        return
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)  # raises if its process lives
        if _is_ours(place, handle):
            _end_moves(place)
            _remove(place)
    finally:
        os.close(handle)


def _is_ours(place: Path, handle: int) -> bool:
    words = os.read(handle, 4096).decode("utf-8", "replace")
    if words.startswith(_record(place)):
        return True
    return not words and [path.name for path in place.iterdir()] == [
        _RECORD
    ]  # killed before it could say so


def _end_moves(place: Path) -> None:
    """Make the moves that were listed and not all made."""
    try:
        moves: Any = json.loads((place / _MOVES).read_text(encoding="utf-8"))
    except FileNotFoundError:
        return
    for name in moves["new"]:
        if (place / _NEW / name).exists():
            (place / _NEW / name).replace(place.parent / name)
    for name in moves["gone"]:
        if not os.path.lexists(place / _OLD / name) and os.path.lexists(place.parent / name):
            (place.parent / name).rename(place / _OLD / name)
    (place / _MOVES).unlink()


def _remove(place: Path) -> None:
    """The record goes last: without it nobody would know whose the rest is."""
    if (place / _MOVES).exists():  # moves were neither made nor undone: the sweep ends them
        return
    (place / f"{_MOVES}.part").unlink(missing_ok=True)
    if (place / _NEW).exists():
        shutil.rmtree(place / _NEW)
    if (place / _OLD).exists():
        for path in (place / _OLD).iterdir():
            path.unlink()
        (place / _OLD).rmdir()
    (place / _RECORD).unlink(missing_ok=True)
    place.rmdir()
