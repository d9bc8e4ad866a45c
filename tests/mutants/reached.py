"""Which functions each test reaches, and how long it takes, with kernels as plain Python.

A plugin of pytest. A test that takes longer than ``PATIENCE`` is left out, so is one that fails
interpreted: it looks after machine code, or is too long without it.
"""

from __future__ import annotations

import json
import signal
import sys
import threading
import time
from collections.abc import Generator
from pathlib import Path
from types import CodeType, FrameType
from typing import Any, Final

import pytest

from experiments.environment import ROOT

PATIENCE: Final = 4
"""[s] Of processor time, for one test."""


class Reached:
    """Writes {test: [seconds, ["file:qualified name", ...]]}, as far as it has come."""

    def __init__(self, out: Path) -> None:
        self.out = out
        self.found: dict[str, tuple[float, list[str]]] = {}
        self._seen: set[CodeType] = set()
        self._written = 0.0

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Generator[None, Any, Any]:
        self._seen.clear()
        started = time.process_time()
        signal.signal(signal.SIGPROF, _too_long)
        signal.setitimer(signal.ITIMER_PROF, PATIENCE)
        threading.setprofile(self._profile)
        sys.setprofile(self._profile)
        try:
            return (yield)
        finally:
            sys.setprofile(None)
            threading.setprofile(None)
            signal.setitimer(signal.ITIMER_PROF, 0.0)
            self._keep(item.nodeid, time.process_time() - started)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.outcome != "passed":
            self.found[report.nodeid] = (-1.0, [])

    def pytest_sessionfinish(self) -> None:
        self._write()

    def _profile(self, frame: FrameType, event: str, _: object) -> None:
        if event == "call":
            self._seen.add(frame.f_code)

    def _keep(self, test: str, seconds: float) -> None:
        if test not in self.found:
            names = {name for code in self._seen if (name := name_of(code))}
            self.found[test] = (round(seconds, 3), sorted(names))
        if time.monotonic() - self._written > 20.0:
            self._write()

    def _write(self) -> None:
        self._written = time.monotonic()
        good = {test: one for test, one in self.found.items() if one[0] >= 0.0}
        self.out.write_text(json.dumps(good, indent=0))


def name_of(code: CodeType) -> str:
    """``icage/a/b.py:qualified.name`` of code of the planner, else empty."""
    path = Path(code.co_filename)
    if not path.is_relative_to(ROOT / "icage"):
        return ""
    return f"{path.relative_to(ROOT)}:{code.co_qualname.split('.<locals>')[0]}"


def _too_long(number: int, frame: object) -> None:
    pytest.fail("too long for a mutant")
