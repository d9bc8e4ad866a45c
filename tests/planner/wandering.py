"""Placements all over a set of verdicts, and cases ready for the oracles."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from icage.cage import Cage
from icage.hand import Placement
from icage.membership import VERDICTS, query
from icage.outline import Outline
from icage.planner import plan
from tests.oracles.geometry import Floats, Ring, load_case, unit_hand


@dataclass(frozen=True, slots=True)
class Solved:
    """A case planned by icage, beside the same object as the oracles see it."""

    name: str
    cage: Cage
    ring: Ring
    hand: NDArray[np.complex128]


@cache
def solved(name: str) -> Solved:
    """Plan a case once for all tests."""
    data = load_case(name)
    vertices = np.array(data["outline"]["vertices"], dtype=np.float64)
    contacts = np.array(data["grasp"]["contacts"], dtype=np.float64)
    cage = plan(Outline(vertices), contacts, data["finger_radius"])
    return Solved(name, cage, Ring.of(vertices), unit_hand(contacts))


def wander(
    cage: Cage, wanted: tuple[str, ...], rng: Generator, count: int, steps: int = 120
) -> Floats:
    """``count`` placements (count, 4) whose verdicts are wanted, spread over the whole set.

    Many walkers start on the plan's grasps and punctures; a step is taken if the query gives a
    wanted verdict there. Half of the steps are differences of two other walkers, which fits them
    to thin sets. Walkers may jump through the object: the query alone decides what belongs to
    the set.
    """
    codes = [VERDICTS.index(v) for v in wanted]
    levels = [x for x in (cage.sigma_first, cage.sigma_max, cage.sigma_largest) if x is not None]
    spread = max(levels, default=cage.sigma_0) - cage.sigma_0
    from_contacts = [e.contacts for e in (*cage.grasps, *cage.punctures)]
    starts = np.array([Placement.from_contacts(c).as_array() for c in from_contacts])
    n = 3 * count
    at = starts[rng.integers(len(starts), size=n)]
    taken = np.isin(query(cage, at).verdict, codes)
    for _ in range(steps):
        if taken.any():  # walkers that have not found the set yet start from those that have
            lost = np.flatnonzero(~taken)
            at[lost] = at[rng.choice(np.flatnonzero(taken), len(lost))]
        size = 10.0 ** rng.uniform(-5.0, 0.2, (n, 1))
        scale = np.array([cage.sigma_0, cage.sigma_0, 1.0, spread])
        step = size * scale * rng.normal(size=at.shape)
        between = rng.permutation(at) - rng.permutation(at)
        step = np.where(rng.random((n, 1)) < 0.5, step, between * rng.uniform(0.3, 1.2, (n, 1)))
        tried = at + step
        tried[:, 3] = np.abs(tried[:, 3])
        good = np.isin(query(cage, tried).verdict, codes)
        at[good], taken = tried[good], taken | good
    found = at[taken][:count]
    if len(found) < count:
        raise RuntimeError(f"{len(found)} of {count} walkers found a placement that is {wanted}")
    return found


def as_configurations(placements: Floats) -> Floats:
    """(n, 4) = Re d, Im d, Re w, Im w of placements x, y, theta, sigma."""
    x, y, theta, sigma = placements.T
    return np.column_stack([x, y, sigma * np.cos(theta), sigma * np.sin(theta)])


def grasp_at(cage: Cage, contacts: Floats, within: float) -> int | None:
    """Id of the plan's grasp whose fingers are within ``within`` [unit] of these, or None."""
    for grasp in cage.grasps:
        if _distance(grasp.contacts, contacts) <= within:
            return grasp.id
        if grasp.plateau is not None:
            a, b = (np.asarray(end) for end in grasp.plateau)
            side = (b - a).ravel()
            t = float(np.clip((contacts - a).ravel() @ side / (side @ side), 0.0, 1.0))
            if _distance(a + t * (b - a), contacts) <= within:
                return grasp.id
    return None


def _distance(a: Floats, b: Floats) -> float:
    return float(np.linalg.norm(a - b, axis=1).max())
