"""Processes that work for another end with it, and hold nobody's standard output."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from experiments.environment import ROOT
from experiments.io.workers import in_processes
from icage.errors import InputError

pytestmark = pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="asks /proc")

_ASKS_FOR_WORK = """
import sys
from tests.experiments.io.test_workers import deaf, print_pid
from experiments.io.workers import in_processes
if __name__ == "__main__":
    print("begun", flush=True)
    for piece, done in in_processes({work}, [sys.argv[1] + "/" + k for k in "ab"], 2):
        pass
"""


def print_pid(place: str) -> int:
    """Say who works, also where standard output goes, and work for ever."""
    print("this is no place for words", flush=True)
    Path(place).write_text(str(os.getpid()))
    while True:
        time.sleep(1.0)


def deaf(place: str) -> int:
    """For ever in machine code that lets no other thread of Python run."""
    Path(place).write_text(str(os.getpid()))
    import re

    re.match("(a*)*b", "a" * 60)
    return 0


def twice(number: int) -> int:
    if number == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    return 2 * number


def is_gone(pid: int) -> bool:
    place = Path("/proc", str(pid), "stat")
    return not place.exists() or place.read_text().rpartition(")")[2].split()[0] in "ZX"


@pytest.mark.parametrize("work", ["print_pid", "deaf"])
@pytest.mark.parametrize("sent", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
def test_workers_end_with_whom_they_work_for(tmp_path: Path, work: str, sent: signal.Signals):
    if work == "deaf" and sys.platform != "linux":
        pytest.skip("only Linux kills what does not listen")
    command = subprocess.Popen(
        [sys.executable, "-c", _ASKS_FOR_WORK.format(work=work), str(tmp_path)],
        cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )  # fmt: skip
    places = [tmp_path / name for name in "ab"]
    end = time.monotonic() + 60
    while not all(p.exists() and p.read_text() for p in places) and time.monotonic() < end:
        time.sleep(0.05)
    pids = [int(place.read_text()) for place in places]
    if work == "deaf" and sent == signal.SIGINT:
        command.kill()  # an interrupt waits for them to be told; they do not listen
    command.send_signal(sent)
    out, _ = command.communicate(timeout=60)  # returns when nobody holds standard output any more
    assert out == "begun\n"
    while not all(is_gone(pid) for pid in pids) and time.monotonic() < end:
        time.sleep(0.05)
    assert all(is_gone(pid) for pid in pids)


def test_a_worker_that_is_killed_is_one_line():
    with pytest.raises(InputError, match="was killed"):
        list(in_processes(twice, range(6), 2))


def test_every_piece_once():
    assert sorted(in_processes(twice, range(3), 2)) == [(0, 0), (1, 2), (2, 4)]
