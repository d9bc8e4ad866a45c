"""One process that compiles the kernels while others interpret them, and what it has done so far.

The first process that meets kernels without machine code starts it and goes on: the answer does
not wait. It is one at a time (a lock on a file, gone with its process), of low priority, has no
terminal and nobody's standard output, ends by itself, and writes a list of the kernels whose
machine code lies in numba's cache; nothing is wrong if it is killed. It works on behind a process
that has ended well; one that was killed or interrupted takes it along. ``ICAGE_COMPILE_BEHIND=0``
starts none. [docs/decisions/0009-cold-start.md]
"""

from __future__ import annotations

import atexit
import json
import os
import sys
from contextlib import suppress
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path
from threading import Thread
from time import monotonic, sleep
from typing import IO, TYPE_CHECKING, Any, Final

from icage.kernels.digest import kernel_sources

if TYPE_CHECKING:
    import subprocess

try:
    import fcntl
except ImportError:  # not on Windows: there every process compiles for itself
    fcntl = None

SWITCH: Final = "ICAGE_COMPILE_BEHIND"
"""Environment variable: "0" keeps this process and its children from starting another one."""

PLAIN: Final = os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0")
"""Whether numba was told to compile nothing."""

MODULE: Final = "icage.compile_kernels"
"""What the other process runs."""

SECONDS: Final = 900
"""[s] After which it is ended, whatever it does."""

LOW_PRIORITY: Final = 15
"""Niceness for which whoever else is at work hardly notices: a thirtieth of a core."""

_GO_ON: Final = b"go on"
"""What a process that ends well tells the one behind it."""

_LOOK: Final = 0.1
"""[s] What was known of the other process is taken as true for so long."""


class _Seen:
    """What this process knows of the list and of the other process."""

    started: bool = False
    child: subprocess.Popen[bytes] | None = None
    looked: float = -1.0
    ready: frozenset[str] = frozenset()
    complete: bool = False
    at_work: bool = False


_seen = _Seen()


def start(*, awaited: bool = False) -> None:
    """Start the other process, once, unless there is nothing to do or somebody does it.

    ``awaited``: somebody will wait for it, so it has no low priority.
    """
    if _seen.started:
        return
    _seen.started = True
    if not _allowed():
        return
    _look()
    if _seen.complete or _seen.at_work:
        return
    import subprocess  # only now: seldom needed

    environment = {**os.environ, SWITCH: "0"}
    path = [str(Path(__file__).parents[2]), environment.get("PYTHONPATH", "")]
    environment["PYTHONPATH"] = os.pathsep.join(part for part in path if part)
    try:
        _seen.child = subprocess.Popen(
            [sys.executable, "-P", "-m", MODULE, "--awaited" if awaited else "--behind"],
            stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
            start_new_session=True, env=environment, cwd=Path(__file__).parent,
        )  # fmt: skip
    except OSError:  # no room for another process: this one compiles
        return
    _seen.at_work = True
    atexit.register(_leave, _seen.child)


def _leave(child: subprocess.Popen[bytes]) -> None:
    """It is meant to outlive us, of which Python would warn; told so, or it ends with us."""
    if child.stdin is not None:
        with suppress(OSError, ValueError):  # it has ended, or was abandoned
            child.stdin.write(_GO_ON)
            child.stdin.close()
    if child.returncode is None:
        child.returncode = 0


def abandon() -> None:
    """The other process, if this one has started it, ends now: this one was told to end."""
    child = _seen.child
    if child is not None and child.stdin is not None:
        with suppress(OSError):
            child.stdin.close()


def no_longer_awaited() -> None:
    """Nobody waits for the other process now, if this one has started it: it gets low priority."""
    child = _seen.child
    if child is not None and hasattr(os, "setpriority"):
        with suppress(OSError):  # it has ended
            os.setpriority(os.PRIO_PROCESS, child.pid, LOW_PRIORITY)


def follow() -> None:
    """In the other process: it ends with the one that started it, unless that lets it go on."""

    def wait() -> None:
        if os.read(0, len(_GO_ON)) != _GO_ON:
            os._exit(1)

    Thread(target=wait, daemon=True).start()


def is_ready(name: str) -> bool:
    """Whether the machine code of a kernel is on disk."""
    _look()
    return name in _seen.ready


def at_work() -> bool:
    """Whether another process is compiling."""
    _look()
    return _seen.at_work


def _allowed() -> bool:
    return (
        fcntl is not None
        and bool(sys.executable)
        and os.environ.get(SWITCH, "1") != "0"
        and not PLAIN
        and _folder() is not None
    )


def _look() -> None:
    """Read the list again, and see who is at work, if that was a while ago."""
    now = monotonic()
    if now < _seen.looked + _LOOK:
        return
    _seen.looked = now
    folder = _folder()
    if folder is None:
        return
    if not _seen.complete:
        _seen.ready, _seen.complete = _read(folder / _file_name())
    if _seen.child is not None:
        _seen.at_work = _seen.child.poll() is None
    else:
        _seen.at_work = not _seen.complete and _is_locked(_lock_file(folder))


def _read(file: Path) -> tuple[frozenset[str], bool]:
    try:
        found: Any = json.loads(file.read_bytes())
        if found["digest"] == kernel_sources().digest:
            return frozenset(found["ready"]), bool(found["complete"])
    except (OSError, ValueError, KeyError, TypeError):
        pass
    return frozenset(), False


def write_list(ready: list[str], complete: bool) -> None:
    """Say which kernels are ready; the file appears whole."""
    folder = _folder()
    if folder is None or kernel_sources().changed():  # nothing was kept then
        return
    file = folder / _file_name()
    part = file.with_suffix(f".{os.getpid()}")
    content = {"digest": kernel_sources().digest, "ready": sorted(ready), "complete": complete}
    part.write_text(json.dumps(content), encoding="utf-8")
    part.replace(file)


def add(name: str) -> None:
    """A kernel was compiled by this process: say so, unless the other process keeps the list."""
    if is_ready(name) or at_work():
        return
    _seen.ready |= {name}
    with suppress(OSError):
        write_list(list(_seen.ready), complete=False)


def take_lock() -> IO[bytes] | None:
    """The lock, held until it is closed or the process ends; None if another process has it."""
    folder = _folder()
    if folder is None or fcntl is None:
        return None
    lock = _lock_file(folder).open("a+b")
    for _ in range(20):  # a look at the lock holds it for a moment
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            sleep(0.02)
        else:
            lock.truncate(0)
            lock.write(b"%d\n" % os.getpid())  # for whoever wonders which process it is
            lock.flush()
            return lock
    lock.close()
    return None


def _is_locked(file: Path) -> bool:
    if fcntl is None:
        return False
    try:
        with file.open("rb") as lock:
            fcntl.flock(lock, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except FileNotFoundError:
        return False
    except OSError:
        return True
    return False


@lru_cache(maxsize=1)
def _folder() -> Path | None:
    """Where the list lies: numba's own folder, if there is one, as far as we can tell unasked."""
    if chosen := os.environ.get("NUMBA_CACHE_DIR"):
        folders = [Path(chosen)]
    else:
        users = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
        folders = [Path(__file__).parent / "__pycache__", Path(users) / "icage"]
    for folder in folders:
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError:
            continue
        if os.access(folder, os.W_OK):
            return folder
    return None


@lru_cache(maxsize=1)
def _file_name() -> str:
    """A list for each Python with its own numba: known by their files, without loading numba."""
    import hashlib

    tools = [sys.implementation.cache_tag]
    for name in ("numba", "llvmlite"):
        spec = find_spec(name)
        file = Path(spec.origin if spec is not None and spec.origin else name)
        version = file.with_name("_version.py")
        tools += [str(file), str(version.stat().st_mtime_ns if version.exists() else 0)]
    return f"icage-kernels-{hashlib.sha256(repr(tools).encode()).hexdigest()[:16]}.json"


def _lock_file(folder: Path) -> Path:
    return folder / _file_name().replace(".json", ".lock")


def claims_file() -> Path | None:
    """Where who compiles what is written down, if there is a cache at all."""
    folder = _folder()
    return None if folder is None else folder / _file_name().replace(".json", ".claims")
