"""Which lines each test runs, and how long it takes, with kernels as plain Python.

A plugin of pytest, on coverage.py. A test that takes longer than ``PATIENCE`` is left out, so is
one that fails interpreted: it looks after machine code, or is too long without it.
"""

from __future__ import annotations

import json
import signal
import time
from collections.abc import Generator
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import pytest

from experiments.environment import ROOT

if TYPE_CHECKING:
    import coverage

PATIENCE: Final = 3
"""[s] Of processor time, for one test."""


class Reached:
    """Writes {test: [seconds, {file: [lines]}]}, over what ``out`` had of other tests."""

    def __init__(self, out: Path) -> None:
        import coverage  # extra `lines`: only here, as this file is read with all tests

        self.out = out
        self._seconds: dict[str, float] = {}
        self._failed: set[str] = set()
        self._cover = coverage.Coverage(
            data_file=str(out.with_suffix(".coverage")), source=[str(ROOT / "icage")]
        )

    def pytest_sessionstart(self) -> None:
        self._cover.erase()
        self._cover.start()

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Generator[None, Any, Any]:
        self._cover.switch_context(item.nodeid)
        started = time.process_time()
        signal.signal(signal.SIGPROF, _too_long)
        signal.setitimer(signal.ITIMER_PROF, PATIENCE)
        try:
            return (yield)
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0.0)
            self._cover.switch_context("")
            self._seconds[item.nodeid] = round(time.process_time() - started, 3)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.outcome != "passed":
            self._failed.add(report.nodeid)

    def pytest_sessionfinish(self) -> None:
        self._cover.stop()
        self._cover.save()
        old = json.loads(self.out.read_text()) if self.out.exists() else {}
        kept = {test: one for test, one in old.items() if test not in self._seconds}
        lines = _lines_by_test(self._cover.get_data())
        good = {
            test: [seconds, lines.get(test, {})]
            for test, seconds in self._seconds.items()
            if test not in self._failed
        }
        self.out.write_text(json.dumps(kept | good))


def _lines_by_test(data: coverage.CoverageData) -> dict[str, dict[str, list[int]]]:
    found: dict[str, dict[str, list[int]]] = {}
    for path in data.measured_files():
        name = str(Path(path).relative_to(ROOT))
        for line, tests in data.contexts_by_lineno(path).items():
            for test in tests:
                if test:
                    found.setdefault(test, {}).setdefault(name, []).append(line)
    return found


def _too_long(number: int, frame: object) -> None:
    pytest.fail("too long for a mutant")
