"""Placements all over a set of verdicts, and cases ready for the oracles."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from icage.cage import Cage
from icage.cells.membership import VERDICTS, query
from icage.hand import Placement
from icage.outline import Outline
from icage.planner import plan
from tests.oracles.geometry import Floats, Ring, load_case, unit_hand
from tests.oracles.statics import moved, opening_direction

LEVEL = 1e-8
"""[1] Placements this close to a grasp's or a puncture's sigma are left out: either answer goes."""


_LOOKS = 16


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
    cage: Cage, wanted: tuple[str, ...], rng: Generator, count: int, steps: int = 80
) -> Floats:
    """About ``count`` placements (n, 4) whose verdicts are wanted, spread over the whole set.

    Hit and run: walkers start where the grasps open to, look along a random line at points from
    1e-5 of the grasp's size to all of it away, and go to one that is wanted (or in the cage at
    least). Half of the lines run along the difference of two other walkers, which fits them to
    thin sets. They may jump through the object: the query alone decides what belongs to the set.
    """
    codes = [VERDICTS.index(v) for v in wanted]
    also = [VERDICTS.index(v) for v in ("target", "caged")]
    scale = np.array([cage.sigma_0, cage.sigma_0, 1.0, cage.sigma_0])
    seeds = _opened(cage)
    at = seeds[rng.integers(len(seeds), size=2 * count)]
    for _ in range(steps):
        n = len(at)
        random = rng.normal(size=(n, 4)) * scale
        between = at[rng.integers(n, size=n)] - at[rng.integers(n, size=n)]
        use = (rng.random(n) < 0.5) & (np.abs(between) > 0.0).any(axis=1)
        line = np.where(use[:, None], between, random)
        far = 10.0 ** rng.uniform(-5.0, 0.2, (n, _LOOKS)) * rng.choice([-1.0, 1.0], (n, _LOOKS))
        tried = at[:, None] + far[..., None] * line[:, None]
        tried[..., 3] = np.abs(tried[..., 3])
        verdict = query(cage, tried.reshape(-1, 4)).verdict.reshape(n, _LOOKS)
        liking = np.where(np.isin(verdict, codes), 8.0, 0.0) + np.isin(verdict, also)
        chosen = np.argmax(liking * rng.random(liking.shape), axis=1)
        good = liking[np.arange(n), chosen] > 0.0
        at = np.where(good[:, None], tried[np.arange(n), chosen], at)
    settled = [e.sigma for e in (*cage.grasps, *cage.punctures)]
    near = np.abs(at[:, 3:] / np.array(settled) - 1.0).min(axis=1) < LEVEL
    right = np.isin(query(cage, at).verdict, codes) & ~near
    found = np.unique(at[right], axis=0)
    if len(found) < count // 2:
        raise RuntimeError(f"{len(found)} of {count} walkers found a placement that is {wanted}")
    return rng.permutation(found)[:count]


def _opened(cage: Cage) -> Floats:
    """Placements a little more open than each grasp, clear of the object."""
    ring = Ring.of(cage.outline.vertices)
    seeds: list[Floats] = []
    for grasp in cage.grasps:
        contacts = np.asarray(grasp.contacts)
        way = opening_direction(ring, contacts, cage.finger_radius)
        if way is None:
            continue
        steps = cage.outline.diameter * 10.0 ** np.linspace(-8.0, -2.0, 13)
        opened = [moved(contacts, step * way) for step in steps]
        rows = np.array([Placement.from_contacts(c).as_array() for c in opened])
        seeds.append(rows[query(cage, rows).in_cage])
    return np.vstack(seeds)


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
