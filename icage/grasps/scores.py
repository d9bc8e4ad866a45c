"""What a planned grasp is worth: the ratio that ranks it."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from icage.arrays import FloatArray
from icage.cage import Cage
from icage.errors import GeometryError, GraspError
from icage.grasps.findings import Findings
from icage.grasps.wanted import Wanted
from icage.placing.best import place

ROUGH: Final = 0.01
"""[1] Of a tolerance that is ranked: the search leaves a gap no larger than this."""


def level_of(cage: Cage, wanted: Wanted) -> float:
    """What is ranked, [unit]: a level, or the tolerance of the best placement.

    Where there is no such level, the largest sigma of the component.
    """
    if wanted.aim == "place":
        return _tolerance(cage, wanted)
    top = cage.sigma_max if cage.sigma_max is not None else cage.sigma_largest
    if top is None:
        raise GeometryError("a cage without sigma_max and without a largest sigma")
    if wanted.aim == "cage":
        return top
    if wanted.mu is None:
        return top if cage.sigma_guaranteed is None else cage.sigma_guaranteed
    first = cage.friction(wanted.mu).sigma_first
    return top if first is None else first


def depth_of(cage: Cage, wanted: Wanted, ranked: float) -> float:
    """How deep the cage is up to the level that is ranked, [unit]."""
    if wanted.aim == "place":
        ranked = level_of(cage, replace(wanted, aim="first"))
    return min(ranked, wanted.limits.sigma_most) - cage.sigma_0


def bound_of(found: Findings, wanted: Wanted) -> FloatArray:
    """(n,) what the scores of grasps cannot exceed, given their levels sigma_first (or less).

    A placement with the tolerance r can shrink about the middle of the least circle round its
    fingers, of radius q sigma, until they have moved by r, and is still in the guaranteed set, in
    which no hand is smaller than sigma_0: r <= q (sigma_first - sigma_0).
    """
    if wanted.aim != "place":
        return found.score
    side = np.linalg.norm(found.contacts - np.roll(found.contacts, -1, axis=1), axis=2)
    a, b, c = np.sort(side, axis=1).T
    around = a * b * c / np.sqrt(np.maximum((a + b + c) * (b + c - a) * (a + c - b), 0.0))
    around = np.where(a * a + b * b <= c * c, 0.5 * c, around / np.sqrt(np.maximum(a + b - c, 0.0)))
    return around / found.sigma_0 * (found.score - 1.0)


def _tolerance(cage: Cage, wanted: Wanted) -> float:
    """Of the best placement of a hand that opens no further than wanted; 0 where there is none."""
    if wanted.limits.sigma_most <= cage.sigma_0:
        return 0.0
    try:
        return place(cage, gap=ROUGH, largest=wanted.limits.sigma_most).tolerance
    except GraspError:
        return 0.0


def score(cage: Cage, wanted: Wanted) -> float:
    """Ratio that ranks: the level that is aimed at, or the tolerance, over sigma_0."""
    return level_of(cage, wanted) / cage.sigma_0
