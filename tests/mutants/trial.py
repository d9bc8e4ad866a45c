"""A mutant in a process of its own, forked from one that has everything loaded."""

from __future__ import annotations

import ast
import os
import signal
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import pytest

from tests.mutants.place import put

QUIET: Final = ("-q", "-n", "0", "-x", "--tb=no", "-p", "no:cacheprovider")

SLOWER: Final = 4.0
"""A mutant is found out by a test that takes so many times its processor time and ``MORE``."""
MORE: Final = 2.0
"""[s]"""
FOREVER: Final = 1800.0
"""[s] On the clock: for what does not come to the next step of Python."""


@dataclass(slots=True)
class Running:
    """A process that tries a mutant."""

    process: int
    end: int
    until: float

    def result(self) -> str | None:
        """The test that killed it, ``time``, empty if it survives; None while it runs."""
        done, status = os.waitpid(self.process, os.WNOHANG)
        if not done and time.monotonic() < self.until:
            return None
        if not done:
            os.kill(self.process, signal.SIGKILL)
            os.waitpid(self.process, 0)
        told = os.read(self.end, 4000).decode("utf-8", "replace")
        os.close(self.end)
        if not done:
            return "time"
        code = os.waitstatus_to_exitcode(status)
        if not told and code > 1:
            raise RuntimeError(f"the tests could not be run: pytest ended with {code}")
        return told if told or not code else f"ended with {code}"


class _First:
    """Tells the first test that fails, or takes too long."""

    def __init__(self, end: int, tests: dict[str, float]) -> None:
        self.end = end
        self._tests = tests
        signal.signal(signal.SIGPROF, self._too_long)

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_logstart(self, nodeid: str) -> None:
        signal.setitimer(signal.ITIMER_PROF, MORE + SLOWER * self._tests.get(nodeid, 0.0))

    def _too_long(self, number: int, frame: object) -> None:
        os.write(self.end, b"time")
        os._exit(1)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.failed:
            os.write(self.end, report.nodeid.encode()[:3000])
            os._exit(1)


def start(
    path: Path, name: str, changed: ast.FunctionDef | None, tests: dict[str, float]
) -> Running:
    """Begin to try a mutant with tests and their seconds; None tries no change."""
    ours, theirs = os.pipe()
    child = os.fork()
    if child:
        os.close(theirs)
        return Running(child, ours, time.monotonic() + FOREVER)
    code = 3
    try:
        nowhere = os.open(os.devnull, os.O_RDWR)
        for stream in (0, 1, 2):
            os.dup2(nowhere, stream)
        if changed is not None:
            put(path, name, changed)
        code = int(pytest.main([*QUIET, *tests], plugins=[_First(theirs, tests)]))
    except BaseException as error:
        os.write(theirs, repr(error).encode()[:3000])
    finally:
        sys.stdout.flush()
        os._exit(code)
