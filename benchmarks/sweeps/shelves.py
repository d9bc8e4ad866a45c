"""Closings on rectilinear objects, whose parallel edges make shelves and wedges, in physics.

    python -m benchmarks.sweeps.shelves --objects 60 --trials 40

Unions of boxes with whole coordinates, disc fingers of 0.1 to 0.3, the five best grasps of each.
Every closing from the guaranteed set has to end in the target; those that do not are printed with
the cage, and so is every cage with a shelf or a wedge. MuJoCo with the usual settings, no friction.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter

import numpy as np
import shapely

import icage
from icage import Case, Outline
from icage.arrays import FloatArray
from icage.kernels.compiled import machine_code_at_once
from sim import replay

TOP = 5


def boxes(rng: np.random.Generator) -> FloatArray:
    """The ring of a union of three to five boxes."""
    shape = shapely.box(0, 0, rng.integers(2, 8), rng.integers(1, 4))
    for _ in range(rng.integers(2, 5)):
        x0, y0, x1, y1 = shape.bounds
        wide, tall = rng.integers(1, 5), rng.integers(1, 5)
        x = rng.integers(int(x0) - wide + 1, int(x1))
        y = rng.integers(int(y0) - tall + 1, int(y1))
        union = shape.union(shapely.box(x, y, x + wide, y + tall))
        if isinstance(union, shapely.Polygon):
            shape = shapely.Polygon(union.exterior)
    return shapely.get_coordinates(shape)[:-1]


def main() -> int:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--objects", type=int, default=60)
    parser.add_argument("--trials", type=int, default=40)
    parser.add_argument("--seed", type=int, default=0, help="of the first object")
    options = parser.parse_args()
    machine_code_at_once()
    total: Counter[str] = Counter()
    for seed in range(options.seed, options.seed + options.objects):
        rng = np.random.default_rng(seed)
        case = Case(f"boxes {seed}", "m", Outline(boxes(rng)), 0.1 + 0.2 * rng.random())
        try:
            grasps = case.grasps(top=TOP)
        except icage.IcageError:
            total["objects without a grasp"] += 1
            continue
        for grasp in grasps:
            cage = icage.plan(case.outline, grasp.contacts, case.finger_radius)
            counts = replay(cage, trials=options.trials, seed=1).counts
            total["cages"] += 1
            total["closings"] += options.trials
            total["in the target"] += counts["target"]
            total["cages with a shelf"] += cage.shelf is not None
            total["cages with a wedge"] += cage.wedge is not None
            limited = cage.shelf is not None or cage.wedge is not None
            if limited or counts["target"] < options.trials:
                ends = {name: count for name, count in counts.items() if count}
                limits = f"shelf {cage.shelf and cage.shelf.sigma}, wedge {cage.wedge}"
                print(f"{case.name}: {cage}, {limits}: {ends}")
    print(dict(total))
    return int(total["in the target"] < total["closings"])


if __name__ == "__main__":
    sys.exit(main())
