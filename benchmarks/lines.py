"""Which lines of ``icage`` and ``sim`` do the quick tests run?

Machine code tells no lines, so kernels are looked at in a run of their own, interpreted: by the
recorded answers and by the tests of single kernels. All other tests run as they always do, and
both are put together.

    pip install -e ".[test,lines]"
    python -m icage.compile_kernels
    python -m benchmarks.lines --json benchmarks/lines.json
    python -m benchmarks.lines tests/icage/geometry --below 95    only these, kernels interpreted

Prints every module below a share of its lines, least first, then every room and the whole. Lines
that only a process of its own runs (``icage`` started by a test, a worker) are not seen.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from collections import defaultdict
from pathlib import Path
from typing import Any

ROOMS = "icage,sim"

WHOLE = (
    "icage", "sim", "tests/icage", "tests/sim", "tests/zoo", "tests/experiments/commands",
    "tests/experiments/explore/test_tables.py", "tests/experiments/shake",
)  # fmt: skip
"""With machine code."""

RECORDED = "tests/icage/kernels/test_recorded_answers.py"

SEARCHES = f"{RECORDED}::test_an_answer_is_the_recorded_one[search-"
"""Minutes each where kernels are interpreted; what they run is tested by itself."""


def of_kernels() -> tuple[str, ...]:
    """What runs interpreted: recorded answers, and what asks for the fixture ``plain``."""
    files = sorted(Path("tests/icage").rglob("test_*.py"))
    asks = [str(file) for file in files if 'usefixtures("plain")' in file.read_text()]
    return (RECORDED, *asks, "--deselect", SEARCHES)


def run(tests: tuple[str, ...], folder: Path, number: int, *, plain: bool) -> None:
    """Run tests and leave what coverage.py has seen in a file of the folder."""
    environment = {**os.environ, "COVERAGE_FILE": str(folder / f"data.{number}")}
    if plain:
        environment["NUMBA_DISABLE_JIT"] = "1"
    begin = [sys.executable, "-m", "coverage", "run", f"--source={ROOMS}", "-m", "pytest"]
    subprocess.run(
        [*begin, "-q", "-n", "0", "-m", "not slow", *tests], env=environment, check=False
    )


def measured(folder: Path) -> dict[str, Any]:
    """All runs of a folder together, as coverage.py's JSON report has them."""
    environment = {**os.environ, "COVERAGE_FILE": str(folder / "data")}
    report = folder / "report.json"
    for command in (["combine", "-q", str(folder)], ["json", "-q", "-o", str(report)]):
        subprocess.run([sys.executable, "-m", "coverage", *command], env=environment, check=True)
    return dict(json.loads(report.read_text()))


def rooms(files: dict[str, Any]) -> dict[str, list[int]]:
    """By room (``icage/cells``; kernels by themselves) how many lines were run, and are there."""
    found: dict[str, list[int]] = defaultdict(lambda: [0, 0])
    for name, one in files.items():
        parts = Path(name).parts
        room = "/".join(parts[:2]) if len(parts) > 2 else parts[0]
        kernels = "kernels" in parts
        for key in (room + ("/kernels" if kernels and parts[1] != "kernels" else ""), parts[0]):
            found[key][0] += one["summary"]["covered_lines"]
            found[key][1] += one["summary"]["num_statements"]
    return found


def main() -> None:
    """Measure and tell."""
    parser = argparse.ArgumentParser(description=__doc__, allow_abbrev=False)
    parser.add_argument("tests", nargs="*", help="default: all of both rooms, in two runs")
    parser.add_argument("--below", type=float, default=95.0, metavar="PERCENT")
    parser.add_argument("--json", type=Path, help="write the share of every module")
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="icage-lines-") as name:
        folder = Path(name)
        run(tuple(chosen.tests) or of_kernels(), folder, 1, plain=True)
        if not chosen.tests:
            run(WHOLE, folder, 2, plain=False)
        found = measured(folder)
    shares = {
        name: round(float(one["summary"]["percent_covered"]), 2)
        for name, one in found["files"].items()
        if one["summary"]["num_statements"]
    }
    for name, share in sorted(shares.items(), key=lambda one: one[1]):
        if share < chosen.below:
            print(f"{share:6.1f} %  {name}")
    by_room = rooms(found["files"])
    for name, (seen, total) in sorted(by_room.items()):
        print(f"{100.0 * seen / total:6.1f} %  of {total:6d} lines of {name}")
    whole = round(float(found["totals"]["percent_covered"]), 2)
    print(f"{whole:6.1f} %  of {found['totals']['num_statements']} lines")
    if chosen.json:
        shared = {name: round(100.0 * seen / total, 2) for name, (seen, total) in by_room.items()}
        told = {
            "format": "icage-lines/2", "tests": chosen.tests, "whole": whole, "rooms": shared,
            "modules": shares,
        }  # fmt: skip
        chosen.json.write_text(json.dumps(told, indent=1) + "\n")


if __name__ == "__main__":
    main()
