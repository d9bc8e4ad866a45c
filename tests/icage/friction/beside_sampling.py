"""sigma_first(mu) of a random target beside the least jam that sampling finds."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from icage.cage import Cage
from icage.cells.membership import CAGED, TARGET, Answers, query
from icage.errors import GraspError
from icage.friction.levels import FrictionLevel, friction_levels
from icage.outline import Outline
from icage.planner import plan
from tests.oracles import disc_jams
from tests.oracles.geometry import Floats, Ring
from tests.oracles.jams import (
    residual,
    sample_of,
    three_finger_jams,
    two_finger_jams,
)
from tests.oracles.polygons import FAMILIES
from tests.oracles.targets import Target, grasp_on, random_target

AN_EDGE = 31
"""Points on an edge."""

OFF = 1e-9
"""[diameter] A finger this near to an edge touches it."""


@dataclass(frozen=True)
class Compared:
    """A level, the least sigma sampled, and what is wrong with the jam that limits the level."""

    level: float
    sampled: float
    residual: float
    in_the_basin: bool

    @property
    def agrees(self) -> bool:
        """Never above a jam that sampling has found, within 1 % of the least, and a true jam."""
        exact = self.level <= self.sampled * (1.0 + 1e-9) or self.level == self.sampled
        near = self.sampled <= 1.01 * self.level
        return exact and near and self.residual <= 1e-7 and self.in_the_basin


def drawn(seed: int) -> tuple[Target, float]:
    """A target on one of the families in turn, and a coefficient from 0.02 to 1."""
    rng = np.random.default_rng(seed)
    target = random_target(rng, sorted(FAMILIES)[seed % len(FAMILIES)])
    return target, float(np.exp(rng.uniform(np.log(0.02), 0.0)))


def drawn_round(seed: int) -> tuple[Target, float]:
    """The same on an object with many short edges, even or not: lobes, flattened at random."""
    rng = np.random.default_rng(seed)
    mu = float(np.exp(rng.uniform(np.log(0.02), 0.0)))
    for _ in range(50):
        n = int(rng.integers(30, 70))
        even = np.arange(n) * 2.0 * math.pi / n
        angle = even if rng.random() < 0.5 else np.sort(rng.random(n)) * 2.0 * math.pi
        radius = 1.0 + 0.25 * np.cos(rng.integers(2, 5) * angle + 1.0)
        flat = rng.uniform(0.4, 1.0)
        ring = np.column_stack([radius * np.cos(angle), flat * radius * np.sin(angle)])
        contacts = grasp_on(Ring.of(ring), rng)
        if contacts is not None:
            return Target("round", ring, contacts, 0.0), mu
    raise RuntimeError("no grasp on 50 round outlines")


def drawn_disc(seed: int) -> tuple[Target, float]:
    """The same for disc fingers with a radius of 1 to 8 % of the diameter."""
    rng = np.random.default_rng([7, seed])
    radius = float(rng.uniform(0.01, 0.08))
    target = random_target(rng, sorted(FAMILIES)[seed % len(FAMILIES)], radius)
    return target, float(np.exp(rng.uniform(np.log(0.02), 0.0)))


def compared(seed: int) -> Compared:
    """Level and samples of one target."""
    target, mu = drawn(seed)
    return compared_on(target.vertices, target.contacts, mu)


def compared_on(vertices: Floats, contacts: Floats, mu: float, an_edge: int = AN_EDGE) -> Compared:
    """Level and samples of a grasp, with so many points on an edge."""
    cage = plan(Outline(vertices), contacts)
    (found,) = friction_levels(cage, [mu])
    sampled = _sampled(cage, found, an_edge)
    level = math.inf if found.sigma_first is None else found.sigma_first
    if found.jam is None:
        return Compared(level, sampled, 0.0, True)
    ring = Ring.of(cage.outline.vertices)
    left = residual(ring, found.jam.contacts, mu, OFF * ring.diameter)
    answer = query(cage, found.jam.placement.as_array()[None])
    return Compared(level, sampled, left, bool(_in_the_basin(answer)[0]))


def compared_disc(seed: int, an_element: int = 13) -> Compared | None:
    """Level and samples of one target of disc fingers; None where the plan finds no cage."""
    target, mu = drawn_disc(seed)
    try:
        cage = plan(Outline(target.vertices), target.contacts, target.radius)
    except GraspError:
        return None
    if cage.status == "not_a_cage":
        return None
    return compared_disc_on(cage, mu, an_element)


def compared_disc_on(cage: Cage, mu: float, an_element: int = 13) -> Compared:
    """The same for a cage, with so many contacts on an edge or an arc."""
    (found,) = friction_levels(cage, [mu])
    ring = Ring.of(cage.outline.vertices)
    curve = disc_jams.Curve.of(ring, cage.finger_radius)
    first = math.inf if cage.sigma_first is None else cage.sigma_first
    below = first if math.isfinite(first) else cage.sigma_largest or math.inf
    around = np.empty((0, 2)) if found.jam is None else found.jam.contacts
    every = curve.contacts(an_element, around)
    hand, phi = cage.hand.unit_fingers, math.atan(mu)
    hands = np.concatenate(
        [
            disc_jams.two_finger_jams(curve, hand, every, phi, below),
            disc_jams.three_finger_jams(curve, hand, every, phi, below),
        ]
    )
    allowed = found.tolerance
    sampled = min(first, _least_in_the_basin(cage, hands, allowed.position, allowed.angle))
    level = math.inf if found.sigma_first is None else found.sigma_first
    if found.jam is None:
        return Compared(level, sampled, 0.0, True)
    left = disc_jams.residual(curve, found.jam.contacts, mu)
    answer = query(cage, found.jam.placement.as_array()[None])
    return Compared(level, sampled, left, bool(_in_the_basin(answer)[0]))


def _sampled(cage: Cage, found: FrictionLevel, an_edge: int) -> float:
    """The least sigma of a sampled far jam in the basin, or the frictionless level (inf: none)."""
    first = math.inf if cage.sigma_first is None else cage.sigma_first
    below = first if math.isfinite(first) else cage.sigma_largest or math.inf
    ring, hand = Ring.of(cage.outline.vertices), cage.hand.unit_fingers
    around = None if found.jam is None else found.jam.contacts
    sample = sample_of(ring, found.mu, an_edge, around)
    hands = np.concatenate(
        [
            two_finger_jams(ring, hand, sample, below),
            three_finger_jams(ring, hand, sample, found.mu, below),
        ]
    )
    allowed = found.tolerance
    return min(first, _least_in_the_basin(cage, hands, allowed.position, allowed.angle))


def _least_in_the_basin(cage: Cage, hands: Floats, position: float, angle: float) -> float:
    """Least sigma of the hands (k, 3, 2) far from the target and, says the query, in its basin."""
    f, target = hands @ [1.0, 1.0j], cage.contacts @ [1.0, 1.0j]
    moved = np.abs(f.mean(axis=1) - target.mean()) / cage.outline.diameter
    turned = np.abs(np.angle((f[:, 1] - f[:, 0]) / (target[1] - target[0])))
    f = f[(moved > position) | (turned > angle)]
    w = f[:, 1] - f[:, 0]
    rows = np.column_stack([f[:, 0].real, f[:, 0].imag, np.angle(w), np.abs(w)])
    order = np.argsort(rows[:, 3])
    for chunk in np.split(order, 500 * (2 ** np.arange(1, 16) - 1)):  # twice as many each time
        if len(chunk):
            inside = np.flatnonzero(_in_the_basin(query(cage, rows[chunk])))
            if len(inside):
                return float(rows[chunk[inside[0]], 3])
    return math.inf


def _in_the_basin(answers: Answers) -> np.ndarray:
    """Which placements are in the target's component, of the guaranteed set or above a brink."""
    every = zip(answers.verdict.tolist(), range(len(answers)), strict=True)
    return np.array([v == TARGET or (v == CAGED and 0 in answers.grasps_of(k)) for v, k in every])
