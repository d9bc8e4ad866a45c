"""A kernel is in one process's hands at a time, no longer than that lives, and others do not wait
for ever."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from experiments.environment import ROOT
from icage.kernels import background, claims
from icage.kernels.claims import Busy, alone_with

pytestmark = pytest.mark.skipif(background.fcntl is None, reason="no claims here")

HOLD = """
import sys
from icage.kernels.claims import alone_with
with alone_with("a.kernel"):
    print("held", flush=True)
    sys.stdin.read()
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A cache of its own."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(background, "_seen", background._Seen())
    background._folder.cache_clear()
    claims._claims.cache_clear()
    yield tmp_path
    background._folder.cache_clear()
    claims._claims.cache_clear()


@contextmanager
def another_process(folder: Path) -> Iterator[subprocess.Popen[str]]:
    """That holds a kernel until its standard input ends."""
    with subprocess.Popen(
        [sys.executable, "-c", HOLD], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        cwd=ROOT, env={**os.environ, "NUMBA_CACHE_DIR": str(folder)},
    ) as child:  # fmt: skip
        try:
            assert child.stdout is not None
            assert child.stdout.readline() == "held\n"
            yield child
        finally:
            child.kill()


def test_a_kernel_in_other_hands_is_busy_and_others_are_not(folder: Path) -> None:
    with another_process(folder):
        with pytest.raises(Busy), alone_with("a.kernel", patient=False):
            raise AssertionError("two at once")
        with alone_with("another.kernel", patient=False):
            pass


@pytest.mark.parametrize("end", ["by itself", "killed"])
def test_who_comes_second_waits_until_the_first_has_ended(folder: Path, end: str) -> None:
    with another_process(folder) as child:
        assert child.stdin is not None
        timer = threading.Timer(0.3, child.kill if end == "killed" else child.stdin.close)
        timer.start()
        with alone_with("a.kernel"):
            assert timer.finished.is_set()
        timer.join()


def test_a_kernel_that_is_ready_is_nobodys(folder: Path) -> None:
    with another_process(folder):
        background.write_list(["a.kernel"], complete=False)
        background._seen.looked = -1.0
        with alone_with("a.kernel", patient=False):
            pass


def test_a_process_that_was_stopped_is_not_waited_for_for_ever(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(claims, "HELD", 0.2)
    with another_process(folder), alone_with("a.kernel"):
        pass
    with alone_with("a.kernel", patient=False):  # and it gave back what it did not have
        pass


def test_one_process_does_not_wait_for_itself(folder: Path) -> None:
    with alone_with("a.kernel", patient=False), alone_with("a.kernel", patient=False):
        pass


def test_without_a_cache_everybody_compiles(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "file"))
    monkeypatch.setattr(background, "_seen", background._Seen())
    background._folder.cache_clear()
    claims._claims.cache_clear()
    with alone_with("a.kernel", patient=False):
        assert claims._claims() is None
    background._folder.cache_clear()
    claims._claims.cache_clear()
