"""A random target by both methods: levels, numbers of grasps and punctures, whole merge trees."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.random import Generator

from icage.agreement import difference
from icage.cage import Cage
from icage.cells.sublevels import sublevels_of
from icage.contact_space.exploration import Plane
from icage.contact_space.method import CONTACT_SPACE
from icage.contact_space.sublevel import sublevels
from icage.hand import HandShape
from icage.outline import Outline
from icage.planner import plan
from tests.oracles.against_itself.outcome import Outcome
from tests.oracles.geometry import Ring
from tests.oracles.polygons import random_polygon
from tests.oracles.targets import Target, grasp_on, random_target

CORNERS = (8, 24)
LARGE = (40, 80)
RADII = (0.01, 0.08)
"""[diameter]"""

LEVELS = ("sigma_0", "sigma_first", "sigma_max", "sigma_max_upper")


def point_target(rng: Generator) -> Target:
    """A target on a polygon of 8 to 24 corners."""
    for _ in range(200):
        target = random_target(rng)
        if CORNERS[0] <= len(target.vertices) <= CORNERS[1]:
            return target
    raise RuntimeError("no polygon of the wanted size in 200 draws")


def large_target(rng: Generator) -> Target:
    """A target on a random polygon, or a star, of 40 to 80 corners."""
    for _ in range(50):
        n = int(rng.integers(LARGE[0], LARGE[1] + 1))
        star = rng.random() < 0.5
        vertices = _star(rng, n) if star else random_polygon(rng, n)
        contacts = grasp_on(Ring.of(vertices), rng)
        if contacts is not None:
            return Target("star" if star else "random", vertices, contacts, 0.0)
    raise RuntimeError("no target on 50 large polygons")


def _star(rng: Generator, n: int) -> np.ndarray:
    angles = np.sort((np.arange(n) + rng.uniform(0.1, 0.9, n)) * 2.0 * np.pi / n)
    reach = rng.uniform(0.4, 1.0, n)
    return np.column_stack([reach * np.cos(angles), reach * np.sin(angles)])


def compare(a: Cage, b: Cage, outcome: Outcome) -> None:
    """Note in what two cages differ."""
    same = a.status == b.status
    outcome.add("verdict", 0.0 if same else float("inf"))
    outcome.verdict = a.status
    for name in LEVELS:
        outcome.add(name, difference(getattr(a, name), getattr(b, name)))
    outcome.add("number of grasps", abs(len(a.grasps) - len(b.grasps)))
    outcome.add("number of punctures", abs(len(a.punctures) - len(b.punctures)))
    if a.sigma_max is not None and a.status == "cage":
        outcome.opening = a.sigma_max / a.sigma_0


def judge_with(draw: Callable[[Generator], Target], seed: int, number: int) -> Outcome:
    """One target by both methods."""
    target = draw(np.random.default_rng([seed, number]))
    outcome = Outcome(number, target.family)
    try:
        outline = Outline(target.vertices)
        compare(
            plan(outline, target.contacts, target.radius),
            plan(outline, target.contacts, target.radius, CONTACT_SPACE),
            outcome,
        )
    except Exception as error:  # the sweep's business is to find them all
        outcome.exceptions.append(f"{type(error).__name__}: {error}")
    return outcome


def judge_points(seed: int, number: int) -> Outcome:
    """A point-finger target."""
    return judge_with(point_target, seed, number)


def judge_large(seed: int, number: int) -> Outcome:
    """A target on a large polygon."""
    return judge_with(large_target, seed, number)


def judge_discs(seed: int, number: int) -> Outcome:
    """A disc target; contacts in a pocket that the disc cannot reach are not counted."""
    outcome = judge_with(
        lambda rng: random_target(rng, radius=float(rng.uniform(*RADII))), seed, number
    )
    if any("pocket" in e for e in outcome.exceptions):
        outcome.exceptions, outcome.verdict = [], "refused"
    return outcome


def judge_trees(seed: int, number: int) -> Outcome:
    """All minima of a target's hand: births, and levels at which they merge."""
    target = point_target(np.random.default_rng([seed, number]))
    outcome = Outcome(number, target.family)
    try:
        outline, hand = Outline(target.vertices), HandShape.from_contacts(target.contacts)
        cells = sublevels_of(outline, hand)
        found = sublevels(Plane.around(outline, hand))
        outcome.verdict = "tree"
        compare_trees(
            np.column_stack([cells.births, cells.merges]),
            np.column_stack([found.births, found.merges]),
            outcome,
        )
    except Exception as error:
        outcome.exceptions.append(f"{type(error).__name__}: {error}")
    return outcome


def compare_trees(a: np.ndarray, b: np.ndarray, outcome: Outcome) -> None:
    """Two diagrams (m, 2) of births and merges as sets, ties in any order; 1e-8 relative."""
    outcome.add("number of minima", abs(len(a) - len(b)))
    if len(a) != len(b):
        return
    first, second = (_sorted(rows) for rows in (a, b))
    finite = np.isfinite(first)
    outcome.add("which never merge", float((finite != np.isfinite(second)).sum()))
    if (finite == np.isfinite(second)).all() and finite.any():
        # stated at the sweep's tolerance of 1e-7; trees are held to 1e-8
        off = float(np.abs(first[finite] / second[finite] - 1.0).max())
        outcome.add("births and merges", 10.0 * off)
        outcome.runs += len(a) - 1


def _sorted(rows: np.ndarray) -> np.ndarray:
    rough = np.round(rows, 9)
    return rows[np.lexsort((rough[:, 1], rough[:, 0]))]
