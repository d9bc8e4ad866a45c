"""From which friction on is there a far jam, of two fingers and of three? Grasps of the studies.

    python -m benchmarks.jam_onsets

The grasps are those that `icage replay pliers` and the others run first, with discs of 6 mm, and
the shipped case `disc_hammer`. For each, with jams of two fingers and of three apart: the least mu
with a far jam anywhere in the target's basin, the least with one below 1.1 sigma_0, and what is
limiting there. Bracketed to 1e-6 in mu.
"""

from __future__ import annotations

import math

import numpy as np

import icage
from icage.cage import Cage
from icage.cells.work import work_of
from icage.friction.jam import Jam, JamTolerance
from icage.friction.jam_search import JamSearch, touching_subsets

GRASPS = ("saw", "wrench", "pliers", "models/cases/disc_hammer.json")
NEAR = 1.1
"""[sigma_0] Jams below count as near the target."""


def onset(search: JamSearch, below: float) -> tuple[float, Jam] | None:
    """The least coefficient up to 1 with a far jam under a level, and the jam just above it."""
    near = search.near(JamTolerance())
    if not math.isfinite(search.least(1.0, near, below).sigma):
        return None
    low, high = 0.0, 1.0
    while high - low > 1e-6:
        middle = 0.5 * (low + high)
        if math.isfinite(search.least(middle, near, below).sigma):
            high = middle
        else:
            low = middle
    return high, search.jam(search.least(high, near, below))


def row(name: str, cage: Cage, count: int, most: float) -> str:
    """One line of the table."""
    work = work_of(cage)
    assert work is not None
    every = touching_subsets(len(cage.hand.z))
    search = JamSearch(cage, work, np.ascontiguousarray(every[every.sum(axis=1) == count]))
    found = onset(search, min(search.known, most * cage.sigma_0))
    head = f"| {name} | {count} | {'any' if math.isinf(most) else f'below {most:g} sigma_0'} |"
    if found is None:
        return f"{head} none up to 1 | | | |"
    mu, jam = found
    moved = np.hypot(*(jam.contacts.mean(axis=0) - cage.contacts.mean(axis=0)))
    turn = jam.placement.theta - cage.target_placement.theta
    turn = math.remainder(turn, 2.0 * math.pi)
    return (
        f"{head} {mu:.6f} | {jam.sigma / cage.sigma_0:.5f} | "
        f"{moved / cage.outline.diameter:.4f} | {turn:.4f} |"
    )


def main() -> None:
    """Print the table."""
    print(
        "| grasp | fingers | jams | from mu | sigma / sigma_0 | moved [diameter] | turned [rad] |"
    )
    print("|---|---|---|---|---|---|---|")
    for name in GRASPS:
        cage = icage.plan(icage.load(name))
        for count in (3, 2):
            for most in (math.inf, NEAR):
                print(row(name.rpartition("/")[2].removesuffix(".json"), cage, count, most))


if __name__ == "__main__":
    main()
