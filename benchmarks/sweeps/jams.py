r"""Levels with friction, and placements, beside brute force: more targets than the tests take.

    python -m benchmarks.sweeps.jams --json benchmarks/sweeps/jams.json

The comparisons are those of ``tests/icage/friction`` and ``tests/icage/placing``: points, discs,
and the best placement of point fingers, each with the seeds that disagree.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from icage.kernels.compiled import machine_code_at_once
from tests.icage.friction import beside_sampling as friction
from tests.icage.placing import test_against_sampling as placing


def _of(compared: Callable[[int], Any]) -> Callable[[range], tuple[int, list[int]]]:
    def sweep(seeds: range) -> tuple[int, list[int]]:
        found = {seed: one for seed in seeds if (one := compared(seed)) is not None}
        return len(found), [seed for seed, one in found.items() if not one.agrees]

    return sweep


def _placements(seeds: range) -> tuple[int, list[int]]:
    found = placing.results(seeds)
    return len(found), sorted(placing.wrong(found))


SWEEPS = {
    "points": (range(700), _of(friction.compared)),
    "discs": (range(240), _of(friction.compared_disc)),
    "placements": (range(400), _placements),
}


def main() -> int:
    """Compare, print, write; 1 if any disagrees."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.sweeps.jams")
    parser.add_argument("--json", type=Path)
    asked = parser.parse_args()
    machine_code_at_once()
    document: dict[str, Any] = {}
    for name, (seeds, sweep) in SWEEPS.items():
        compared, wrong = sweep(seeds)
        document[name] = {"seeds": len(seeds), "compared": compared, "wrong": wrong}
        print(f"{name}: {compared} of {len(seeds)} compared, {len(wrong)} disagree {wrong}")
    if asked.json is not None:
        asked.json.write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
    return int(any(one["wrong"] for one in document.values()))


if __name__ == "__main__":
    sys.exit(main())
