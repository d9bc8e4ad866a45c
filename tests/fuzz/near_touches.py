"""``python -m tests.fuzz.near_touches COUNT``: how thin may a slit or a neck be?

Of random polygons a vertex is moved towards an edge that is not its own; both methods plan two
grasps of each, without the rule of ``icage.near_touch``. What they differ by, gap after gap.
"""

from __future__ import annotations

import sys
from collections import Counter
from random import Random

import numpy as np
from shapely.errors import ShapelyError

from icage.agreement import AGREEMENT, difference
from icage.errors import IcageError
from icage.near_touch import near_touch
from icage.outline import Outline
from icage.planner import plan
from tests.fuzz.geometry import grasps_on
from tests.oracles.geometry import Floats
from tests.oracles.polygons import FAMILIES

GAPS = (1e-6, 1e-7, 3e-8, 1.6e-8, 9e-9, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 1e-15)
"""[diameter]"""


def pinched(number: int) -> tuple[Floats, int, Floats]:
    """A polygon, the number of a vertex, and the place on an edge that it is moved to."""
    random = Random(number)
    ring = FAMILIES[random.choice(sorted(FAMILIES))](np.random.default_rng(number))
    n = len(ring)
    k = random.randrange(n)
    j = (k + random.randrange(2, n - 1)) % n if n > 3 else (k + 1) % n
    p, q = ring[j], ring[(j + 1) % n]
    return ring, k, p + random.uniform(0.1, 0.9) * (q - p)


def main() -> None:
    """Print a row a gap."""
    count = int(sys.argv[1])
    print("| gap [diameter] | near touches | plans that agree | that differ | by at most |")
    print("|---|---|---|---|---|")
    for gap in GAPS:
        found: Counter[str] = Counter()
        worst = 0.0
        for number in range(count):
            ring, k, foot = pinched(number)
            way = ring[k] - foot
            size = Outline.computed(ring).diameter
            length = float(np.hypot(*way))
            if length < 1e-3 * size:
                continue
            ring[k] = foot + way / length * gap * size
            try:
                outline = Outline.computed(ring)
                found["near"] += near_touch(outline.vertices, outline.diameter) is not None
                for contacts in grasps_on(outline, 0.0):
                    one = plan(outline, contacts)
                    other = plan(outline, contacts, method="contact-space")
                    names = ("sigma_0", "sigma_first", "sigma_max")
                    off = max(difference(getattr(one, n), getattr(other, n)) for n in names)
                    found["differ" if off > AGREEMENT else "agree"] += 1
                    worst = max(worst, off)
            except (IcageError, ShapelyError):
                found["refused"] += 1
        print(f"| {gap:g} | {found['near']} | {found['agree']} | {found['differ']} | {worst:.2g} |")


if __name__ == "__main__":
    main()
