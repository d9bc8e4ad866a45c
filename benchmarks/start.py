"""How long a command takes to start: ``python -m benchmarks.start [--runs 5] [--json FILE]``.

Whole commands, wall and processor seconds (of the command and its children), least, median and
most. "cold" runs have an empty cache for machine code, each its own, and start the process that
compiles behind them; it is ended after each. "warm" runs find everything compiled: in the folder
that numba uses by itself, filled before. Wall seconds mean something on a quiet machine only.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from experiments.environment import ROOT

COMMAND = [sys.executable, "-c", "import sys; from experiments.cli import main; sys.exit(main())"]
SMALL = "models/cases/pliers_best.json"
"""Point fingers, 21 vertices."""

COLD = {"cold plan, point fingers": ["plan", SMALL]}
WARM = {
    "plan, point fingers": ["plan", SMALL],
    "plan, disc fingers": ["plan", "pliers"],
    "--help": ["--help"],
    "plan --help": ["plan", "--help"],
}


def main() -> int:
    """Measure, print, write."""
    parser = argparse.ArgumentParser(description=__doc__, allow_abbrev=False)
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--json", type=Path, help="write the figures")
    options = parser.parse_args()
    figures: dict[str, dict[str, list[float]]] = {}
    for name, arguments in COLD.items():
        figures[name] = repeated(lambda a=arguments: cold(a), options.runs)
    subprocess.run([sys.executable, "-m", "icage.compile_kernels"], cwd=ROOT, check=True)
    for name, arguments in WARM.items():
        figures[name] = repeated(lambda a=arguments: run(a, {}), options.runs)
    print(f"{'seconds: least, median, most':<28} {'wall':>20} {'processor':>20}")
    for name, one in figures.items():
        cells = ("/".join(f"{value:.2f}" for value in one[kind]) for kind in ("wall", "processor"))
        print(f"{name:<28} " + " ".join(f"{cell:>20}" for cell in cells))
    if options.json is not None:
        document = {"format": "icage-start/1", "runs": options.runs, "seconds": figures}
        options.json.write_text(json.dumps(document, indent=1) + "\n")
    return 0


def repeated(once: Callable[[], tuple[float, float]], runs: int) -> dict[str, list[float]]:
    """Least, median and most of wall and processor seconds."""
    columns = zip(*(once() for _ in range(runs)), strict=True)
    return {
        name: [round(f(values), 3) for f in (min, statistics.median, max)]
        for name, values in zip(("wall", "processor"), columns, strict=True)
    }


def cold(arguments: list[str]) -> tuple[float, float]:
    """One run that finds nothing compiled."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        seconds = run(arguments, {"NUMBA_CACHE_DIR": folder, "ICAGE_COMPILE_BEHIND": "1"})
        end_compiler(Path(folder))
    return seconds


def end_compiler(folder: Path) -> None:
    """End the process that compiles into a folder; it may still be on its way there."""
    for _ in range(300):
        for lock in folder.glob("icage-kernels-*.lock"):
            if pid := lock.read_text().strip():
                with suppress(ProcessLookupError):
                    os.kill(int(pid), signal.SIGKILL)
                return
        time.sleep(0.1)


def run(arguments: list[str], environment: dict[str, str]) -> tuple[float, float]:
    """Wall and processor seconds of one command."""
    before, started = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run(
        [*COMMAND, *arguments], check=True, cwd=ROOT, capture_output=True,
        env={**os.environ, **environment},
    )  # fmt: skip
    wall, after = time.perf_counter() - started, resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, sum(after[:2]) - sum(before[:2])


if __name__ == "__main__":
    sys.exit(main())
