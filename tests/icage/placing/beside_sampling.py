"""The best placement of a random target beside the best that sampling finds.

Sampling shares with the search the query and nothing else: starts drawn from the guaranteed set,
then the best of them moved at random, ever less far; distances are shapely's.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.random import Generator

from icage.arrays import FloatArray
from icage.cage import Cage
from icage.cells.membership import TARGET, query
from icage.outline import Outline
from icage.placing.best import BestPlacement, place
from icage.placing.misplaced import draw_misplaced
from icage.planner import plan
from icage.sampling import draw_starts
from tests.oracles.polygons import FAMILIES
from tests.oracles.targets import random_target

DRAWN = 100
KEPT = 30
MOVES = 20
ROUNDS = 25
FURTHEST = 0.05
"""[diameter] The first moves."""
SHORTER = 0.75

KINDS = ("free", "known", "errs")
"""The opening is chosen; is known; is chosen and may be off."""

ROUNDING = 1e-9
"""[diameter]"""


@dataclass(frozen=True)
class Compared:
    """What is claimed of the best placement, what sampling found, and promises that broke."""

    best: BestPlacement
    sampled: float
    clearance: float
    in_the_set: bool
    broken: int
    size: float

    @property
    def agrees(self) -> bool:
        """The best but for the gap, bounded, true, in the set, and good for what it promises."""
        best, slack = self.best, ROUNDING * self.size
        return (
            best.tolerance * (1.0 + 1e-3) >= self.sampled - slack
            and best.tolerance_upper >= self.sampled - slack
            and best.tolerance <= best.tolerance_upper <= best.tolerance * (1.0 + 1e-3)
            and self.clearance >= best.tolerance - slack
            and abs(self.clearance - best.clearance) <= slack
            and self.in_the_set
            and self.broken == 0
        )


def drawn(seed: int, radius: float = 0.0) -> Cage:
    """A cage on one of the families in turn, with discs of so many diameters."""
    rng = np.random.default_rng(seed)
    target = random_target(rng, sorted(FAMILIES)[seed % len(FAMILIES)], radius)
    return plan(Outline(target.vertices), target.contacts, target.radius)


def compared(cage: Cage, seed: int, mu: float = 0.0) -> Compared:
    """Free to open, at a known opening or with an error of it, as the seed has it."""
    rng = np.random.default_rng(seed)
    level = cage.sigma_guaranteed if mu == 0.0 else cage.friction(mu).sigma_first
    top = cage.sigma_largest if level is None else level
    assert top is not None
    kind = KINDS[seed % len(KINDS)]
    errs, opening = kind == "errs", None
    if kind == "known":
        opening = cage.sigma_0 + float(rng.uniform(0.2, 0.95)) * (top - cage.sigma_0)
    best = place(cage, mu, opening, errs)
    sampled = sampled_best(cage, rng, level, opening, errs, mu == 0.0)
    off = np.concatenate(
        [draw_misplaced(best, 100, rng), draw_misplaced(best, 100, rng, furthest=True)]
    )
    rounding = 1e-14 * float(np.abs(best.fingers).max() + cage.outline.diameter)
    assert furthest_off(cage, best, off) <= best.tolerance + rounding
    good = (clearances(cage, off) >= -ROUNDING * cage.outline.diameter) & in_set(cage, off, level)
    at = best.placement.as_array()[None]
    return Compared(
        best,
        sampled,
        float(clearances(cage, at)[0]),
        bool(in_set(cage, at, level)[0]),
        int((~good).sum()),
        cage.outline.diameter,
    )


def furthest_off(cage: Cage, best: BestPlacement, rows: FloatArray) -> float:
    """How far a finger of these placements is from where it should be, at most."""
    return float(np.linalg.norm(cage.hand.fingers(rows) - best.fingers, axis=2).max())


def clearances(cage: Cage, rows: FloatArray) -> FloatArray:
    """(n,) least distance of the fingers from the object; negative inside."""
    points = shapely.points(cage.hand.fingers(rows))
    away = shapely.distance(points, cage.outline.polygon.exterior)
    inside = shapely.contains_properly(cage.outline.polygon, points)
    away = np.where(inside, -away, away)
    return away.min(axis=1) - cage.finger_radius


def in_set(cage: Cage, rows: FloatArray, level: float | None) -> FloatArray:
    """(n,) whether the query has them in the guaranteed set, below the level."""
    below = np.inf if level is None else level
    return (query(cage, rows).verdict == TARGET) & (rows[:, 3] < below)


def sampled_best(
    cage: Cage, rng: Generator, level: float | None, opening: float | None, errs: bool, whole: bool
) -> float:
    """The largest tolerance sampled, -inf if no placement was."""
    drawn = draw_starts(cage, "guaranteed", DRAWN, rng).placements
    starts = [drawn, cage.target_placement.as_array()[None]]
    if opening is not None or not whole:
        size = opening if opening is not None else 0.5 * (cage.sigma_0 + (level or 0.0))
        starts = [_resized(cage, rows, size) for rows in starts]
    rows = np.concatenate(starts)
    values = _values(cage, rows, level, errs)
    far = FURTHEST * cage.outline.diameter
    for _ in range(ROUNDS):
        order = np.argsort(-values)[:KEPT]
        rows, values = rows[order], values[order]
        moved = _moved(cage, np.repeat(rows, MOVES, axis=0), far, opening is None, rng)
        rows = np.concatenate([rows, moved])
        values = np.concatenate([values, _values(cage, moved, level, errs)])
        far *= SHORTER
    return float(values.max())


def _values(cage: Cage, rows: FloatArray, level: float | None, errs: bool) -> FloatArray:
    """(n,) tolerances; -inf outside the set."""
    values = clearances(cage, rows)
    if errs and level is not None:
        around = shapely.minimum_bounding_radius(
            shapely.MultiPoint(np.column_stack([cage.hand.z.real, cage.hand.z.imag]))
        )
        values = np.minimum(values, around * (level - rows[:, 3]))
    good = values > 0.0  # the others need not be asked about
    good[good] = in_set(cage, rows[good], level)
    return np.where(good, values, -np.inf)


def _resized(cage: Cage, rows: FloatArray, size: float) -> FloatArray:
    """The same hands about their middles, all of one size."""
    w = rows[:, 3] * np.exp(1j * rows[:, 2])
    first = rows[:, 0] + 1j * rows[:, 1] + (w - size * w / np.abs(w)) * cage.hand.z.mean()
    return np.column_stack([first.real, first.imag, rows[:, 2], np.full(len(rows), size)])


def _moved(cage: Cage, rows: FloatArray, far: float, resize: bool, rng: Generator) -> FloatArray:
    """Hands moved, turned and (if allowed) resized at random."""
    n = len(rows)
    w = rows[:, 3] * np.exp(1j * rows[:, 2])
    middle = rows[:, 0] + 1j * rows[:, 1] + w * cage.hand.z.mean()
    middle += far * (rng.standard_normal(n) + 1j * rng.standard_normal(n))
    turned = w * np.exp(1j * far / rows[:, 3] * rng.standard_normal(n))
    if resize:
        turned *= np.exp(far / rows[:, 3] * rng.standard_normal(n))
    first = middle - turned * cage.hand.z.mean()
    sizes = np.abs(turned) if resize else rows[:, 3]
    return np.column_stack([first.real, first.imag, np.angle(turned), sizes])


def relative(one: float, other: float) -> float:
    """By how much they differ."""
    return math.inf if other == 0.0 else abs(one / other - 1.0)
