"""The process that compiles behind a command: it holds nothing, it is one, and it may be killed."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest

from experiments.environment import ROOT
from icage.kernels import background
from models import CASES

pytestmark = pytest.mark.skipif(background.fcntl is None, reason="nothing is started here")

PLAN = [
    sys.executable, "-c", "import sys; from experiments.cli import main; sys.exit(main())",
    "plan", str(CASES / "T_best.json"), "--json", "-",
]  # fmt: skip


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A cache without machine code; who works on it is ended with the test."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    background._folder.cache_clear()
    yield tmp_path
    background._folder.cache_clear()
    for pid in workers(tmp_path):
        with suppress(ProcessLookupError):
            os.kill(pid, signal.SIGKILL)


def workers(folder: Path) -> list[int]:
    """Who else holds the lock, or held it last."""
    found = [int(file.read_text() or 0) for file in folder.glob("*.lock")]
    return [pid for pid in found if pid not in (0, os.getpid())]


def planned(switch: str = "1", **more: str) -> dict[str, Any]:
    """A plan, whose standard output and error are pipes that must close."""
    done = subprocess.run(
        PLAN, check=True, capture_output=True, text=True, cwd=ROOT,
        env={**os.environ, background.SWITCH: switch, **more},
    )  # fmt: skip
    assert done.stderr == ""
    document: dict[str, Any] = json.loads(done.stdout)
    return document


def until_locked(folder: Path) -> Path:
    """The lock, once the other process has taken it."""
    lock = background._lock_file(folder)
    for _ in range(600):
        if workers(folder):
            return lock
        background.sleep(0.1)
    raise AssertionError("no process has started")


@pytest.mark.slow
def test_the_answer_does_not_wait_and_a_killed_compiler_breaks_nothing(folder: Path) -> None:
    first = planned()
    lock = until_locked(folder)
    assert background._is_locked(lock)  # the pipes have closed, and the compiler is still at work
    (pid,) = workers(folder)
    assert os.getsid(pid) == pid  # no terminal
    assert background.take_lock() is None  # one at a time
    os.kill(pid, signal.SIGKILL)
    while background._is_locked(lock):
        background.sleep(0.1)
    assert planned(switch="0") == first
    assert planned(switch="0", NUMBA_DISABLE_JIT="1") == first


def test_the_switch_starts_none(folder: Path) -> None:
    assert planned(switch="0")["verdict"] == "cage"
    assert not any(folder.iterdir())


def test_plain_python_starts_none(folder: Path) -> None:
    assert planned(NUMBA_DISABLE_JIT="1")["verdict"] == "cage"
    assert not any(folder.iterdir())


def test_no_folder_for_a_cache_starts_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "file"))
    monkeypatch.setenv(background.SWITCH, "1")
    background._folder.cache_clear()
    assert not background._allowed()
    background._folder.cache_clear()


def test_the_list_is_of_these_kernels_only(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(background, "_seen", background._Seen())
    background.write_list(["a.kernel"], complete=True)
    assert background.is_ready("a.kernel")
    assert not background.is_ready("another")
    assert not background.at_work()
    (file,) = folder.glob("*.json")
    file.write_text(file.read_text().replace('"digest": "', '"digest": "0'))
    monkeypatch.setattr(background, "_seen", background._Seen())
    assert not background.is_ready("a.kernel")
    file.write_text("{")
    monkeypatch.setattr(background, "_seen", background._Seen())
    assert not background.is_ready("a.kernel")


def test_one_at_a_time(folder: Path) -> None:
    lock = background.take_lock()
    assert lock is not None
    assert background._is_locked(background._lock_file(folder))
    assert background.take_lock() is None
    lock.close()
    again = background.take_lock()
    assert again is not None
    again.close()
    assert not background._is_locked(background._lock_file(folder))


@pytest.mark.skipif(not hasattr(os, "setpriority"), reason="no priorities here")
def test_what_is_no_longer_awaited_makes_room(monkeypatch: pytest.MonkeyPatch):
    with subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE) as child:
        monkeypatch.setattr(background._seen, "child", child)
        background.no_longer_awaited()
        assert os.getpriority(os.PRIO_PROCESS, child.pid) == background.LOW_PRIORITY
        child.kill()
    background.no_longer_awaited()  # it has ended: nothing to do
