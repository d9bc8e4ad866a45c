"""sigma_first(mu) of a random target beside the least jam that sampling finds."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from icage.cage import Cage
from icage.cells.membership import TARGET, query
from icage.friction.levels import FrictionLevel, friction_levels
from icage.outline import Outline
from icage.planner import plan
from tests.oracles.geometry import Ring
from tests.oracles.jams import (
    least_in_the_basin,
    residual,
    sample_of,
    three_finger_jams,
    two_finger_jams,
)
from tests.oracles.polygons import FAMILIES
from tests.oracles.targets import Target, random_target

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


def compared(seed: int) -> Compared:
    """Level and samples of one target."""
    target, mu = drawn(seed)
    cage = plan(Outline(target.vertices), target.contacts)
    (found,) = friction_levels(cage, [mu])
    sampled = _sampled(cage, found)
    level = math.inf if found.sigma_first is None else found.sigma_first
    if found.jam is None:
        return Compared(level, sampled, 0.0, True)
    ring = Ring.of(cage.outline.vertices)
    left = residual(ring, found.jam.contacts, mu, OFF * ring.diameter)
    answer = query(cage, found.jam.placement.as_array()[None])
    return Compared(level, sampled, left, bool(answer.verdict[0] == TARGET))


def _sampled(cage: Cage, found: FrictionLevel) -> float:
    """The least sigma of a sampled far jam in the basin, or the frictionless level (inf: none)."""
    first = math.inf if cage.sigma_first is None else cage.sigma_first
    below = first if math.isfinite(first) else cage.sigma_largest or math.inf
    ring, hand = Ring.of(cage.outline.vertices), cage.hand.unit_fingers
    around = None if found.jam is None else found.jam.contacts
    sample = sample_of(ring, found.mu, AN_EDGE, around)
    hands = np.concatenate(
        [
            two_finger_jams(ring, hand, sample, below),
            three_finger_jams(ring, hand, sample, found.mu, below),
        ]
    )
    allowed = found.tolerance
    return min(first, least_in_the_basin(cage, hands, allowed.position, allowed.angle)[0])
