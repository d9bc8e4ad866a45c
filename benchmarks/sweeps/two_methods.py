"""Contact space against cells: levels, numbers of grasps and punctures, whole merge trees.

    python -m benchmarks.sweeps.two_methods points --json benchmarks/sweeps/two_methods_points.json
    python -m benchmarks.sweeps.two_methods large --json benchmarks/sweeps/two_methods_large.json
    python -m benchmarks.sweeps.two_methods discs --json benchmarks/sweeps/two_methods_discs.json
    python -m benchmarks.sweeps.two_methods trees --json benchmarks/sweeps/two_methods_trees.json

points: 20,000 targets on random, star, comb, spiral, rectilinear, integer-grid and tool-like
polygons of 8 to 24 corners; large: 200 on 40 to 80 corners; discs: 500 with radius 1 to 8 % of the
diameter, the whole answer with its brackets; trees: births and merges of all minima of 300 hands.
"""

from __future__ import annotations

import argparse
import sys
import time

from benchmarks.sweeps.runner import options, report, run
from tests.oracles.against_itself.outcome import Judge
from tests.oracles.against_itself.two_methods import (
    judge_discs,
    judge_large,
    judge_points,
    judge_trees,
)

PARTS: dict[str, tuple[Judge, int]] = {
    "points": (judge_points, 20_000),
    "large": (judge_large, 200),
    "discs": (judge_discs, 500),
    "trees": (judge_trees, 300),
}


def main() -> int:
    """Command line."""
    parser = options(__doc__ or "", -1)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("part", choices=PARTS)
    chosen = parser.parse_args()
    judge, count = PARTS[chosen.part]
    chosen.count = count if chosen.count < 0 else chosen.count
    began = time.perf_counter()
    return report(f"two_methods {chosen.part}", run(judge, chosen), chosen, began)


if __name__ == "__main__":
    sys.exit(main())
