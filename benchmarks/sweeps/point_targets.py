"""Point fingers: raw triangles = merged convex pieces, at 4 rotations, on random targets.

    python -m benchmarks.sweeps.point_targets --json benchmarks/sweeps/point_targets.json

Random, star, comb, spiral, integer-grid, lattice and tool-like polygons; grasps on edges and in
concave corners. Every target is also planned from end to end, so that no part may raise.
"""

from __future__ import annotations

import sys
import time

from benchmarks.sweeps.runner import options, report, run
from tests.oracles.against_itself.point_targets import judge


def main() -> int:
    """Command line."""
    chosen = options(__doc__ or "", 2100).parse_args()
    began = time.perf_counter()
    return report("point_targets", run(judge, chosen), chosen, began)


if __name__ == "__main__":
    sys.exit(main())
