r"""Disc fingers: 4, 8, 32, 64 segments a quadrant, raw = merged, at 4 rotations, random targets.

    python -m benchmarks.sweeps.disc_targets --every-resolution --log discs.jsonl \
        --json benchmarks/sweeps/disc_targets.json

takes an hour and a half on one core (the log lets it go on after a kill). Without
``--every-resolution`` target k takes the (k mod 4)-th of these resolutions only.

The outline is turned and grown anew each time, so that the offset is part of what is compared.
Inner (chords) and outer (tangents) polygons; sigma_max(inner) <= sigma_max(outer) at equal and at
different resolutions. Radius 1 to 8 % of the diameter.
"""

from __future__ import annotations

import sys
import time

from benchmarks.sweeps.runner import options, report, run
from tests.oracles.against_itself.disc_targets import judge, judge_one


def main() -> int:
    """Command line."""
    parser = options(__doc__ or "", 2000)
    parser.add_argument("--every-resolution", action="store_true")
    chosen = parser.parse_args()
    began = time.perf_counter()
    outcomes = run(judge if chosen.every_resolution else judge_one, chosen)
    return report("disc_targets", outcomes, chosen, began)


if __name__ == "__main__":
    sys.exit(main())
