"""Attacks on the jams that limit the levels, and the friction at which each begins to hold.

A jam holds from a coefficient of its own on, the least at which forces within the cones balance
there (``sim.grip.jam``, nothing of the planner). At 1.1 times that a hand that starts beside it
has to stop beside it; at 0.9 times, only where the jams of that coefficient are.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from experiments.cases.with_discs import PhysicalCase
from experiments.jams.closings import OFF_BALANCE
from icage.arrays import FloatArray
from icage.friction.levels import Jam
from icage.kernels.locate import depth_inside
from sim.closing.batch import close_many
from sim.closing.step_check import SETTLED
from sim.grip.jam import held_at, held_by_engine, least_mu, residual
from sim.grip.stick import Threshold, moved, opened, released_at, rubbing, threshold
from sim.world.config import SimConfig
from sim.world.scene import Scene

WEAKER, STRONGER = 0.9, 1.1
"""[1] Of the coefficient at which a jam begins to hold."""

BESIDE: Final = 1e-3
"""[diameter, rad] How far starts are moved from a jam, at most; in each of x, y and turn."""

OPENED: Final = (1e-3, 5e-3)
"""[1] ... and how much they are opened."""

STAYS: Final = 3.0 * BESIDE
"""[diameter, rad] A hand that ends this near to the jam has stuck beside it."""

NEAR: Final = 0.05
"""[1] A coefficient this near to the one foretold is the same."""

DECIDED: Final = 1e-4
"""[1] A jam of a level holds at that level's coefficient, to this."""

LEAST: Final = 1e-3
"""[1] Less friction than this is none to an engine."""

_TRIES: Final = 200


@dataclass(frozen=True, slots=True)
class Attacked:
    """Closings from beside a jam at one coefficient: of ``trials`` so many stuck beside it.

    ``residual`` [drive_force] is the largest at an end, ``stray`` came to rest where it is more
    than ``OFF_BALANCE``; ``moved`` is the median and the largest distance of the ends from the jam
    [diameter or rad].
    """

    mu: float
    trials: int
    stuck: int
    stray: int
    residual: float
    moved: tuple[float, float]
    penetration: float


@dataclass(frozen=True, slots=True)
class JamTested:
    """One jam: from which coefficient on it is foretold to hold, and from which it was seen to.

    ``found_at`` are the coefficients at which it limited the level, ``touching`` counts its
    contacts (a finger in a concave corner has two), ``measured`` is of hands put
    down there, ``released`` of those that let go; see ``sim.grip.stick``.
    """

    jam: Jam
    found_at: tuple[float, ...]
    touching: int
    foretold: float
    measured: Threshold
    released: float
    weaker: Attacked
    stronger: Attacked

    @property
    def off(self) -> float:
        """[1] Friction at which it was seen to hold, over what was foretold, less 1.

        Where it is put down; if it slides there up to more than ``NEAR`` above, where it lets go.
        """
        put_down = self.measured.sticks / self.foretold - 1.0
        return put_down if put_down <= NEAR else min(put_down, self.released / self.foretold - 1.0)


def beside(scene: Scene, jam: FloatArray, count: int, rng: np.random.Generator) -> FloatArray:
    """Placements (n, 4) near a jam (4,), opened, moved and turned a little, clear of the object."""
    found: list[FloatArray] = []
    middle = complex(scene.hand.z.mean())
    for _ in range(_TRIES):
        rows = np.repeat(jam[None, :], count, axis=0)
        for i, share in enumerate(rng.uniform(*OPENED, count).tolist()):
            rows[i] = opened(scene, rows[i], share)[0]
        turn = rng.uniform(-BESIDE, BESIDE, count)
        arm = rows[:, 3] * np.exp(1j * rows[:, 2]) * middle * (1.0 - np.exp(1j * turn))
        rows[:, 2] += turn
        rows[:, :2] += np.column_stack([arm.real, arm.imag])
        rows[:, :2] += rng.uniform(-BESIDE, BESIDE, (count, 2)) * scene.object.diameter
        fingers = scene.hand.fingers(rows).reshape(-1, 2)
        depth = depth_inside(scene.outline.vertices, fingers, scene.finger_radius)
        found += list(rows[(depth.reshape(count, -1) <= 0.0).all(axis=1)])
        if len(found) >= count:
            break
    return np.array(found[:count]).reshape(-1, 4)


def attacked(scene: Scene, jam: FloatArray, starts: FloatArray, mu: float) -> Attacked:
    """Close from starts (N, 4) beside a jam (4,) at one coefficient."""
    there = rubbing(scene, mu)
    closed = close_many(there, starts, 1)
    shift, turn = moved(there, jam, closed.end)
    away = np.maximum(shift, turn)
    rest = closed.ending == SETTLED
    off = np.array([residual(held_by_engine(there, end), mu) for end in closed.end[rest]])
    return Attacked(
        mu, len(starts), int((away < STAYS).sum()), int((off > OFF_BALANCE).sum()),
        float(off.max(initial=0.0)),
        (float(np.median(away)) if len(away) else 0.0, float(away.max(initial=0.0))),
        float(closed.penetration_max.max(initial=0.0)),
    )  # fmt: skip


def judge_jam(
    physical: PhysicalCase,
    jam: Jam,
    found_at: tuple[float, ...],
    attacks: int,
    rng: np.random.Generator,
    config: SimConfig | None = None,
) -> JamTested | None:
    """Threshold and attacks of one jam; None if no friction holds there up to what it limits.

    A level for discs may be lower than its least jam: what the search has not decided in time
    counts as one, and is none.
    """
    scene = physical.simulated.scene()
    place = jam.placement.as_array()
    held = held_at(scene, place)
    foretold = least_mu(held)
    if foretold > found_at[0] * (1.0 + DECIDED) or foretold < LEAST:
        return None
    starts = beside(scene, place, attacks, rng)
    return JamTested(
        jam,
        found_at,
        len(held.finger),
        foretold,
        threshold(scene, place, foretold, config),
        released_at(scene, place, foretold, config),
        attacked(scene, place, starts, WEAKER * foretold),
        attacked(scene, place, starts, STRONGER * foretold),
    )
