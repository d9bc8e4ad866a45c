"""Closings with fingers a hair thinner and thicker: what ``icage.wedge`` says, judged from outside.

    python -m benchmarks.sweeps.wedges --objects 8 --starts 12

Objects of ten families, half of them with edges in two or three directions only, the best grasps of
each, points and discs. From placements of the guaranteed set an exact closing without friction that
knows no cells (``tests.oracles.planar_closing``) is made with fingers 1e-5 to 1e-8 of the diameter
thinner and thicker; each has to end next to the target. Of a wedge some should not, from the set
that would be guaranteed without it. On a brink some of those from beside it should stop (of points
few do: this closing lets a finger that has come to a vertex go on to either side). For points the
outline shrinks or grows: a closing rests on the tip of a vertex that is round with so small a
radius.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Callable
from typing import Final

import numpy as np
import shapely
from numpy.random import Generator

import icage
from benchmarks.sweeps.shelves import boxes
from icage import Brink, Cage, Case, JamTolerance, Outline
from icage.arrays import FloatArray
from icage.grasps.planned import planned_or_why
from icage.grasps.search import best_grasps
from icage.kernels.compiled import machine_code_at_once
from icage.sampling import SamplingError, draw_starts
from tests.oracles.geometry import Ring
from tests.oracles.planar_closing import ClosingError, close_hand
from tests.oracles.polygons import (
    comb_polygon,
    lattice_polygon,
    random_polygon,
    rectilinear_polygon,
    spiral_polygon,
    star_polygon,
    tool_polygon,
)

CHANGES: Final = tuple(sign * 10.0**-k for k in (5, 6, 7, 8) for sign in (1.0, -1.0))
"""[diameter] Changes of the fingers' radius."""

TOP: Final = 3
BESIDE: Final = 100
"""Closings from beside a brink."""

EAGERNESS: Final = (0.3, 100.0)


def letters(rng: Generator) -> FloatArray:
    """A T, L, U or E of boxes with drawn widths, some of them equal."""
    a, b, c = (0.25 * rng.integers(1, 5, 3)).tolist()
    tall = a + b + c + 1.0
    bars = {
        "T": [(0, tall, 3, tall + a), (1, 0, 1 + b, tall)],
        "L": [(0, 0, a, tall), (0, 0, 2, b)],
        "U": [(0, 0, a, tall), (0, 0, 2 + a, b), (1 + a, 0, 2 + a, tall)],
        "E": [(0, 0, a, tall), (0, 0, 2, b), (0, tall - c, 2, tall), (0, b + 0.5, 2, b + 1.0)],
    }
    shape = shapely.union_all([shapely.box(*bar) for bar in bars[str(rng.choice(list(bars)))]])
    return shapely.get_coordinates(shape.simplify(0.0))[:-1]


def sheared(rng: Generator) -> FloatArray:
    """A union of boxes whose right angles have become others: a parallelogram of parts."""
    return boxes(rng) @ np.array([[1.0, 0.0], [rng.uniform(-0.8, 0.8), 1.0]])


FAMILIES: Final[tuple[Callable[[Generator], FloatArray], ...]] = (
    boxes, letters, sheared, rectilinear_polygon, lattice_polygon, comb_polygon, tool_polygon,
    random_polygon, star_polygon, spiral_polygon,
)  # fmt: skip


def cages_of(case: Case, rng: Generator) -> list[Cage]:
    """The best cages of the search, wedges among them."""
    radius = case.finger_radius
    found = best_grasps(case.outline, finger_radius=radius, top=3 * TOP, rng=rng)
    planned = (planned_or_why(case.outline, radius, one.contacts) for one in found)
    return [one for one in planned if isinstance(one, Cage)][:TOP]


def unlimited(cage: Cage) -> float:
    """[unit] The level that would be guaranteed if there were no wedge."""
    stops = (cage.shelf, cage.brink)
    levels = (cage.sigma_first, *(None if one is None else one.sigma for one in stops))
    return min((one for one in levels if one is not None), default=np.inf)


def starts_below(cage: Cage, level: float, count: int, rng: Generator) -> FloatArray:
    """Placements of the target's component below a level, at most ``count``."""
    rows = draw_starts(cage, "cage", 8 * count, rng).placements
    answers = cage.query(rows)
    known = np.array([0 in one.grasps for one in answers])
    return rows[known & (rows[:, 3] < level - 1e-3 * cage.outline.diameter)][:count]


def end_of(cage: Cage, row: FloatArray, change: float, eagerness: float) -> FloatArray | None:
    """Where a hand closes to (3, 2) with fingers ``change`` [diameter] thicker; None: nowhere."""
    outline, by = cage.outline, change * cage.outline.diameter
    ring, radius = outline.vertices, cage.finger_radius + by
    if cage.finger_radius == 0.0:
        other = outline.polygon.buffer(by, join_style="mitre", mitre_limit=20.0)
        ring, radius = shapely.get_coordinates(other.exterior)[:-1], 0.0
    w = row[3] * np.exp(1j * row[2])
    q = np.array([row[0], row[1], w.real, w.imag])
    try:
        return close_hand(Ring.of(ring), cage.hand.z, q, radius, eagerness).contacts
    except ClosingError:
        return None  # the start is less than a hair clear


def is_target(cage: Cage, contacts: FloatArray) -> bool:
    """Whether a hand counts as the target, as jams do."""
    near = JamTolerance()
    off = np.hypot(*(contacts.mean(axis=0) - cage.contacts.mean(axis=0)))
    side, own = contacts[1] - contacts[0], cage.contacts[1] - cage.contacts[0]
    turn = np.angle(complex(*side) / complex(*own)) if np.hypot(*side) > 0.0 else np.pi
    return bool(off <= near.position * cage.outline.diameter and abs(turn) <= near.angle)


def stops_on(cage: Cage, brink: Brink, rng: Generator) -> bool:
    """Whether any closing from beside a brink stops on it: those from one side should."""
    size = cage.outline.diameter
    for _ in range(BESIDE):
        off = rng.normal(size=4) * [1e-3 * size, 1e-3 * size, 2e-3, 2e-3 * size]
        row = icage.Placement.from_contacts(brink.contacts).as_array() + np.array(
            [*off[:3], abs(off[3])]
        )
        end = end_of(cage, row, 0.0, float(rng.choice(EAGERNESS)))
        if end is not None and np.abs(end - brink.contacts).max() < 3e-4 * size:
            return True
    return False


def judged(cage: Cage, count: int, rng: Generator) -> Counter[str]:
    """Closings from the guaranteed set and, of a wedge, from what it limits."""
    total: Counter[str] = Counter()
    level = cage.sigma_guaranteed
    for name, top in (
        ("guaranteed", np.inf if level is None else level),
        ("limited", unlimited(cage)),
    ):
        if name == "limited" and cage.wedge is None:
            continue
        try:
            rows = starts_below(cage, top, count, rng)
        except SamplingError:
            continue
        for row in rows:
            for change in CHANGES:
                end = end_of(cage, row, change, float(rng.choice(EAGERNESS)))
                if end is not None:
                    total[name] += 1
                    total[f"{name}, ended elsewhere"] += not is_target(cage, end)
    return total


def main() -> int:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--objects", type=int, default=8, help="of each family, points and discs")
    parser.add_argument("--starts", type=int, default=12, help="of each cage and of each set")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    machine_code_at_once()
    wrong = 0
    for number, family in enumerate(FAMILIES):
        total: Counter[str] = Counter()
        for k in range(options.objects):
            rng = np.random.default_rng([options.seed, number, k])
            outline = Outline(family(rng))
            radius = 0.0 if k % 2 else rng.uniform(0.01, 0.03) * outline.diameter
            try:
                cages = cages_of(Case(family.__name__, "m", outline, radius), rng)
            except icage.IcageError:
                continue
            for cage in cages:
                found = judged(cage, options.starts, rng)
                total += found
                total["cages"] += 1
                wedge, brink = cage.wedge, cage.brink
                if brink is not None:
                    total["brinks"] += 1
                    total["brinks seen"] += stops_on(cage, brink, rng)
                if wedge is not None:
                    total[f"wedges ({wedge.kind})"] += 1
                    seen = found["limited, ended elsewhere"] > 0
                    total["wedges seen"] += seen
                    if not seen:
                        print(f"  {family.__name__} {k}: not seen: {cage}, {wedge}")
                if found["guaranteed, ended elsewhere"]:
                    print(f"  {family.__name__} {k}: {cage}, {wedge}: {dict(found)}")
        wrong += total["guaranteed, ended elsewhere"]
        print(f"{family.__name__}: {dict(total)}", flush=True)
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
