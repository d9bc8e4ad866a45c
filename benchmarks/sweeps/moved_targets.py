r"""The same object elsewhere: turned, scaled, far from the origin, told from another vertex.

    python -m benchmarks.sweeps.moved_targets --json benchmarks/sweeps/moved_targets.json

What is asked of each of 5,000 targets in 4 places stands in
``tests.oracles.against_itself.moved_targets``.
"""

from __future__ import annotations

import sys
import time

from benchmarks.sweeps.runner import options, report, run
from tests.oracles.against_itself.moved_targets import FAR_TOLERANCE, NEAR_TOLERANCE, judge


def main() -> int:
    """Command line."""
    chosen = options(__doc__ or "", 5000).parse_args()
    began = time.perf_counter()
    tolerances = {"within 20 diameters": NEAR_TOLERANCE, "beyond": FAR_TOLERANCE}
    return report("moved_targets", run(judge, chosen), chosen, began, tolerances)


if __name__ == "__main__":
    sys.exit(main())
