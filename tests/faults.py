"""A disk that fails when it is told to: faults of the system calls that Python makes of files.

Only under one folder, so that nothing else of the process notices. Files are opened through an
``io.FileIO`` of our own, so reads and writes fail as the system's would, below every buffer; what a
library opens by itself, in another language, is not reached.
"""

from __future__ import annotations

import builtins
import errno
import io
import os
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

import pytest

CALLS: Final = (
    "open", "read", "write", "fsync", "replace", "rename", "unlink", "mkdir", "rmdir", "stat",
    "scandir",
)  # fmt: skip

SHORT: Final = -1
"""Instead of an error number: a write that takes only half of what it is given, as it may."""


@dataclass
class Disk:
    """Counts system calls on files below ``folder``; the call number ``at`` fails.

    Attributes
    ----------
    error:
        Its number, or ``SHORT``.
    for_good:
        Whether all calls of its kind after it fail, too.
    only:
        Part of the path of files whose calls count.
    calls:
        Names of the calls so far, in order.
    """

    folder: Path
    at: int | None = None
    error: int = errno.EIO
    for_good: bool = False
    kinds: tuple[str, ...] = CALLS
    only: str = ""
    calls: list[str] = field(default_factory=list)
    failed: list[str] = field(default_factory=list)

    def step(self, name: str, path: Any) -> bool:
        """Whether a write is to be short; raises if the call is to fail."""
        if name not in self.kinds or not self._is_mine(path):
            return False
        number = len(self.calls)
        self.calls.append(name)
        if self.at is None or number < self.at or (number > self.at and not self.for_good):
            return False
        if number > self.at and name != self.calls[self.at]:
            return False
        if self.error == SHORT:
            return name == "write"
        self.failed.append(name)
        raise OSError(self.error, os.strerror(self.error), str(path))

    def _is_mine(self, path: Any) -> bool:
        try:
            if isinstance(path, int):
                path = Path(f"/proc/self/fd/{path}").readlink()
            text = os.fsdecode(path)
        except (OSError, TypeError):
            return False
        return str(Path(text).absolute()).startswith(str(self.folder)) and self.only in text

    def install(self, patch: pytest.MonkeyPatch) -> None:
        """Until ``patch`` is undone, the process has this disk."""
        disk = self

        class File(io.FileIO):
            def write(self, data: Any) -> int:
                if disk.step("write", self.name) and len(data) > 1:
                    data = memoryview(data).cast("B")[: len(data) // 2]
                return super().write(data)

            def readinto(self, buffer: Any) -> int:
                disk.step("read", self.name)
                return super().readinto(buffer)

            def readall(self) -> bytes:
                disk.step("read", self.name)
                return super().readall()

            def read(self, size: int | None = -1) -> Any:
                disk.step("read", self.name)
                return super().read(size)

        real_open = io.open

        def opened(
            file: Any, mode: str = "r", buffering: int = -1, encoding: Any = None,
            errors: Any = None, newline: Any = None, closefd: bool = True, opener: Any = None,
        ) -> Any:  # fmt: skip
            if not disk._is_mine(file):
                return real_open(file, mode, buffering, encoding, errors, newline, closefd, opener)
            if not isinstance(file, int):
                disk.step("open", file)
            raw = File(file, mode.replace("b", "").replace("t", ""), closefd, opener)
            if buffering == 0:
                return raw
            kind = io.BufferedRandom if "+" in mode else (
                io.BufferedReader if "r" in mode else io.BufferedWriter
            )  # fmt: skip
            buffered = kind(raw)
            return (
                buffered if "b" in mode else io.TextIOWrapper(buffered, encoding, errors, newline)
            )

        patch.setattr(builtins, "open", opened)
        patch.setattr(io, "open", opened)
        patch.setattr(os, "fdopen", lambda fd, *a, **k: opened(fd, *a, **k))
        for name in ("open", "write", "fsync", "replace", "rename", "unlink", "mkdir", "rmdir"):
            patch.setattr(os, name, self._failing(name, getattr(os, name)))
        for name in ("stat", "lstat", "scandir", "listdir"):
            kind = {"lstat": "stat", "listdir": "scandir"}.get(name, name)
            patch.setattr(os, name, self._failing(kind, getattr(os, name)))

    def _failing(self, name: str, real: Callable[..., Any]) -> Callable[..., Any]:
        def call(*given: Any, **named: Any) -> Any:
            if given and "dir_fd" not in named:
                self.step(name, given[0])
            return real(*given, **named)

        return call


def unreadable(patch: pytest.MonkeyPatch, part: str) -> None:
    """From now on the disk does not read files with this in their path."""
    disk = Disk(Path("/"), 0, errno.EIO, for_good=True, kinds=("read",), only=part)
    disk.install(patch)
