"""The same object elsewhere: turned, scaled, far from the origin, told from another vertex.

Every second target has disc fingers of 1 to 5 % of the diameter. Each is planned as drawn and moved
in ``MOVES`` ways: any rotation, scales from 1e-3 to 1e3, up to 20 diameters from the origin for one
half of the moves and up to a million for the other. Levels over the scale must agree to 1e-9 near
the origin. Beyond, the moved input itself is rounded by up to 1e-10 diameters: 1e-6 is asked for.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator

from icage.agreement import difference
from icage.cage import Cage
from icage.errors import GraspError
from icage.outline import Outline
from icage.planner import plan
from tests.oracles.against_itself.levels import Floats
from tests.oracles.against_itself.outcome import Outcome
from tests.oracles.polygons import rotated
from tests.oracles.targets import Target, random_target

MOVES = 4
RADII = (0.01, 0.05)
"""[diameter]"""

NEAR, FAR = 20.0, 1e6
"""[diameter] Distances from the origin."""

NEAR_TOLERANCE, FAR_TOLERANCE = 1e-9, 1e-6
"""[1]"""

LEVELS = ("sigma_0", "sigma_first", "sigma_max", "sigma_max_upper", "sigma_largest")


@dataclass(frozen=True, slots=True)
class Move:
    """Where a target is moved to; ``away`` [diameter] in ``direction`` after all the rest."""

    angle: float
    scale: float
    away: float
    direction: float
    start: int

    @classmethod
    def drawn(cls, rng: Generator, far: bool, vertices: int) -> Move:
        """A random move."""
        if far:
            away = NEAR * (FAR / NEAR) ** float(rng.random())
        else:
            away = NEAR * float(rng.random())
        return cls(
            float(rng.uniform(-math.pi, math.pi)), 10.0 ** float(rng.uniform(-3.0, 3.0)), away,
            float(rng.uniform(-math.pi, math.pi)), int(rng.integers(vertices)),
        )  # fmt: skip

    def of(self, points: Floats, diameter: float) -> Floats:
        """Points (n, 2) moved; ``diameter`` is the object's before."""
        shift = (
            self.away * diameter * np.array([math.cos(self.direction), math.sin(self.direction)])
        )
        return self.scale * (rotated(points, self.angle) + shift)

    @property
    def tolerance(self) -> float:
        """[1] How much the levels may differ."""
        return NEAR_TOLERANCE if self.away <= NEAR else FAR_TOLERANCE


def drawn(seed: int, number: int) -> tuple[Target, list[Move]]:
    """A target and where it is moved to; the numbers are the sweep's."""
    rng = np.random.default_rng([seed, number])
    target = random_target(rng, radius=float(rng.uniform(*RADII)) if number % 2 else 0.0)
    return target, [Move.drawn(rng, bool(k % 2), len(target.vertices)) for k in range(MOVES)]


def planned(target: Target, move: Move | None = None) -> Cage:
    """The target's cage, as drawn or moved."""
    if move is None:
        return plan(Outline(target.vertices), target.contacts, target.radius)
    size = Outline(target.vertices).diameter
    vertices = np.roll(move.of(target.vertices, size), move.start, axis=0)
    return plan(Outline(vertices), move.of(target.contacts, size), move.scale * target.radius)


def off(base: Cage, moved: Cage, scale: float) -> float:
    """Largest relative difference of a level; inf for another verdict or number of grasps."""
    if base.status != moved.status:
        return math.inf
    worst = 0.0
    for name in LEVELS:
        level = getattr(moved, name)
        at = None if level is None else level / scale
        worst = max(worst, difference(getattr(base, name), at))
    return worst


def judge(seed: int, number: int) -> Outcome:
    """One target, as drawn and in all its moves."""
    target, moves = drawn(seed, number)
    outcome = Outcome(number, f"{target.family}, {'discs' if target.radius else 'points'}")
    try:
        base = planned(target)
    except GraspError:  # in a pocket that the discs close: there is no such grasp anywhere
        outcome.verdict = "refused"
        _refused_everywhere(target, moves, outcome)
        return outcome
    except Exception as error:  # the sweep's business is to find them all
        outcome.exceptions.append(f"as drawn: {type(error).__name__}: {error}")
        return outcome
    outcome.verdict = base.status
    outcome.opening = base.sigma_max / base.sigma_0 if base.sigma_max else None
    for move in moves:
        try:
            outcome.add(str(move), off(base, planned(target, move), move.scale), move.tolerance)
        except Exception as error:
            outcome.exceptions.append(f"{move}: {type(error).__name__}: {error}")
    return outcome


def _refused_everywhere(target: Target, moves: list[Move], outcome: Outcome) -> None:
    for move in moves:
        try:
            cage = planned(target, move)
            outcome.disagreements.append(f"{move}: {cage.status}, refused as drawn")
        except GraspError:
            outcome.add(str(move), 0.0, move.tolerance)
        except Exception as error:
            outcome.exceptions.append(f"{move}: {type(error).__name__}: {error}")
