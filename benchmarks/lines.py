"""Which lines of ``icage`` and ``sim`` do the tests run? Kernels are interpreted for that.

    pip install -e ".[test,lines]"
    python -m benchmarks.lines --json benchmarks/lines.json  # all fast tests: hours on one core
    python -m benchmarks.lines tests/icage/geometry --below 95

Prints every module below a share of its lines, least first, and the whole. Lines that only a
process of its own runs (``icage`` started by a test) are not seen.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

ROOMS = "icage,sim"
ALL = ("icage", "sim", "tests/icage", "tests/sim", "tests/zoo")


def measured(tests: list[str], data: Path) -> dict[str, Any]:
    """What coverage.py says of these tests, as its JSON report has it."""
    cover = [sys.executable, "-m", "coverage"]
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1", "COVERAGE_FILE": str(data / "data")}
    run = ["run", f"--source={ROOMS}", "-m", "pytest", "-q", "-n", "0", "-m", "not slow", *tests]
    subprocess.run([*cover, *run], env=environment, check=False)
    report = data / "report.json"
    subprocess.run([*cover, "json", "-q", "-o", str(report)], env=environment, check=True)
    return dict(json.loads(report.read_text()))


def main() -> None:
    """Measure and tell."""
    parser = argparse.ArgumentParser(description=__doc__, allow_abbrev=False)
    parser.add_argument("tests", nargs="*", default=list(ALL), help="default: all of both rooms")
    parser.add_argument("--below", type=float, default=95.0, metavar="PERCENT")
    parser.add_argument("--json", type=Path, help="write the share of every module")
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="icage-lines-") as folder:
        found = measured(chosen.tests, Path(folder))
    shares = {
        name: round(float(one["summary"]["percent_covered"]), 2)
        for name, one in found["files"].items()
        if one["summary"]["num_statements"]
    }
    for name, share in sorted(shares.items(), key=lambda one: one[1]):
        if share < chosen.below:
            print(f"{share:6.1f} %  {name}")
    whole = round(float(found["totals"]["percent_covered"]), 2)
    print(f"{whole:6.1f} %  of {found['totals']['num_statements']} lines")
    if chosen.json:
        told = {"format": "icage-lines/1", "tests": chosen.tests, "whole": whole, "modules": shares}
        chosen.json.write_text(json.dumps(told, indent=1) + "\n")


if __name__ == "__main__":
    main()
