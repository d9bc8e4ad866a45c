"""How long do friction's answers take? Point fingers and discs on the three tools, machine code.

    python -m benchmarks.friction

Best of five on a fresh cage each, after one round that is not counted.
"""

from __future__ import annotations

from time import perf_counter

import numpy as np

import icage
from icage.cage import Cage
from tests.icage.friction.test_against_sampling import TOOLS

ROUNDS = 5
MUS = [0.05 * k for k in range(21)]


def fresh(name: str, discs: bool) -> Cage:
    """The first grasp of a tool by discs of 6 mm, or the best one by points, planned anew."""
    case = icage.load(name)
    return icage.plan(case) if discs else icage.plan(case.outline, np.array(TOOLS[name]))


def times(name: str, discs: bool) -> list[float]:
    """[ms] Plan, curve, 21 levels, the ends at 0.1 and the jam nearest to the target."""
    taken: list[list[float]] = []
    for _ in range(ROUNDS + 1):
        stamps = [perf_counter()]
        cage = fresh(name, discs)
        stamps.append(perf_counter())
        icage.friction_curve(cage)
        cage = fresh(name, discs)
        again = perf_counter()
        icage.friction_levels(cage, MUS)
        levels = perf_counter() - again
        again = perf_counter()
        _ = cage.friction(0.1).ends
        ends = perf_counter() - again
        again = perf_counter()
        icage.nearest_jam(cage, 0.1, cage.target_placement)
        nearest = perf_counter() - again
        cage = fresh(name, discs)
        again = perf_counter()
        icage.friction_curve(cage)
        curve = perf_counter() - again
        taken.append([stamps[1] - stamps[0], curve, levels, ends, nearest])
    return (1e3 * np.array(taken[1:]).min(axis=0)).tolist()


def main() -> None:
    """Print the table."""
    print("| tool | fingers | plan | curve | 21 levels | ends | nearest jam |  [ms]")
    print("|---|---|---|---|---|---|---|")
    for name in TOOLS:
        for discs in (False, True):
            row = " | ".join(f"{t:.1f}" for t in times(name, discs))
            print(f"| {name} | {'discs' if discs else 'points'} | {row} |")


if __name__ == "__main__":
    main()
