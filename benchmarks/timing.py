"""Clocks that every benchmark shares: interleaved repeats, a yardstick, the memory of a child.

Processor seconds, not wall seconds, because other processes share the machine; and things that are
compared are run in turns, so that a busy neighbour strikes both. Absolute times of two runs cannot
be compared, ratios inside one run can.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any, TypedDict

import numpy as np

REPEATS = 5


class Spread(TypedDict):
    """Least, median and largest of repeats."""

    min: float
    median: float
    max: float


def spread(values: Iterable[float]) -> Spread:
    """Least, median and largest.

    >>> spread([3.0, 1.0, 2.0])
    {'min': 1.0, 'median': 2.0, 'max': 3.0}
    """
    numbers = sorted(values)
    return {"min": numbers[0], "median": statistics.median(numbers), "max": numbers[-1]}


def timed(work: Callable[[], Any]) -> tuple[float, Any]:
    """Processor seconds of all threads of one call, and what it returned."""
    began = time.process_time()
    done = work()
    return time.process_time() - began, done


def seconds_of(work: Callable[..., object], *arguments: object) -> float:
    """Processor seconds of all threads of one call."""
    return timed(lambda: work(*arguments))[0]


def interleaved(
    tasks: Mapping[str, Callable[[int], Any]], repeats: int = REPEATS
) -> dict[str, list[tuple[float, Any]]]:
    """Every task in turn, ``repeats`` times; a task is told the number of the repeat.

    >>> found = interleaved({"a": lambda k: k, "b": lambda k: -k}, 2)
    >>> [answer for _, answer in found["b"]]
    [0, -1]
    """
    found: dict[str, list[tuple[float, Any]]] = {name: [] for name in tasks}
    for repeat in range(repeats):
        for name, task in tasks.items():
            found[name].append(timed(lambda task=task, repeat=repeat: task(repeat)))
    return found


def yardstick(repeats: int = REPEATS) -> float:
    """Processor seconds of sorting two million doubles, the median: what this machine is worth."""
    sample = np.random.default_rng(1).random(2_000_000)
    return statistics.median(timed(lambda: np.sort(sample))[0] for _ in range(repeats))


def peak_memory(code: str) -> float:
    """[MB] Most memory that a fresh Python had which ran this code.

    Raises subprocess.CalledProcessError if the code failed.
    """
    # a process starts with the memory of the one that made it on its record: a small one between
    call = [sys.executable, "-c", _BETWEEN, code]
    done = subprocess.run(call, check=True, stdout=subprocess.PIPE, text=True)
    return int(done.stdout.splitlines()[-1]) / 1024.0


_BETWEEN = """
import resource, subprocess, sys
subprocess.run([sys.executable, "-c", sys.argv[1]], check=True)
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
"""


def peak_of_this_program() -> float:
    """Peak memory, [MB]; ``ru_maxrss`` would hold what the parent had before the program began."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(float(line.split()[1]) / 1024.0 for line in lines if line.startswith("VmHWM"))
