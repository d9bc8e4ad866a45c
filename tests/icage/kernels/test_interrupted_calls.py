"""A signal that comes during a call is raised as it ends: the process does not die of it."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from icage.kernels import background

KERNELS = """
from enum import IntEnum
from typing import NamedTuple
import numpy as np

class How(IntEnum):
    WELL = 3
    BADLY = 5

WELL, BADLY = How

class Part(NamedTuple):
    number: float
    array: np.ndarray

class Whole(NamedTuple):
    how: How
    part: Part
    array: np.ndarray

def work(n, array):
    total = 0.0
    for k in range(n):
        total += np.sin(k) * np.cos(total)
    array[:] = total
    return WELL if total > -1e9 else BADLY

def member(n, array):
    return inner(n, array)

def tuples(n, array):
    how = inner(n, array)
    return (array.copy(), 1.0), how, (array.copy(), array.copy())

def named(n, array):
    how = inner(n, array)
    return Whole(how, Part(1.0, array.copy()), array.copy())
"""

SCRIPT = """
import signal, sys, time
import numpy as np
from icage.kernels.machine import dispatcher_of
from tests_of_calls import kernels
kernels.inner = dispatcher_of(kernels.work)
call = dispatcher_of(getattr(kernels, sys.argv[1]))
array = np.zeros(3)
first = call(10, array)
assert repr(first) == repr(getattr(kernels, sys.argv[1])(10, array)), first
began = time.perf_counter()
call(1_000_000, array)
took = time.perf_counter() - began

class Stop(BaseException):
    pass

def stop(*_):
    raise Stop

signal.signal(signal.SIGALRM, stop)
stopped = 0
for _ in range(10):
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.3 * took)
        call(1_000_000, array)
        time.sleep(10.0)
    except Stop:
        stopped += 1
assert repr(call(10, array)) == repr(first)
print(stopped)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="timers of signals")
@pytest.mark.parametrize("name", ["member", "tuples", "named"])
def test_a_signal_during_a_call_is_raised_as_it_ends(name: str, tmp_path: Path) -> None:
    """numba makes objects of an answer without asking whether that went well."""
    package = tmp_path / "tests_of_calls"
    package.mkdir()
    (package / "__init__.py").write_text("")
    (package / "kernels.py").write_text(KERNELS)
    root = str(Path(__file__).parents[3])
    own = {
        "PYTHONPATH": os.pathsep.join([root, str(tmp_path)]),
        "NUMBA_CACHE_DIR": str(tmp_path), background.SWITCH: "0",
    }  # fmt: skip
    for _ in range(2):  # compiled, and from the cache
        done = subprocess.run(
            [sys.executable, "-c", SCRIPT, name], check=False, capture_output=True, text=True,
            cwd=tmp_path, env={**os.environ, **own},
        )  # fmt: skip
        assert done.returncode == 0, done.stderr[-1000:]
        assert done.stdout == "10\n"
