"""Does a hand stick where it stands, and at which coefficient of friction does it begin to?

Two measurements. *Put down*: at rest at a placement, the motor pulls. *Let go*: the hand sticks at
much more friction than it takes, and the friction falls until it slips. Two contacts carry forces
that statics knows, and both give the same coefficient. With three there are more forces than
equations: which of them act depends on how the hand came there, and a hand that is put down may
slide where one that has been pressed there holds. Statics says where a hand can stick.

The hand is put down at a placement, a hair smaller so that no finger strikes, and closes. It
*sticks* if after ``WATCHED`` seconds its middle is less than ``SLIPS`` from where it was in the
object, and it is turned by less than that. Ten per cent less friction than it takes to stick moves
it by ``SLIPS`` in some milliseconds; creep (``SimConfig.impratio``) by a hundredth of that in all
the time.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from icage.arrays import BoolArray, FloatArray
from sim.closing.batch import close_many
from sim.closing.outcome import ClosingOutcomes
from sim.closing.step_check import DIVERGED
from sim.world.config import SimConfig
from sim.world.engine import mj
from sim.world.scene import Scene

SLIPS: Final = 1e-4
"""[diameter, rad] A fiftieth of what counts as the target with friction. Less is penetration, more
would let a hand slide to where less friction holds it."""

WATCHED: Final = 0.5
"""[s] At a motor force that moves a free finger by half a diameter a second."""

OPENED: Final = -1e-6
"""[1] Of sigma: the fingers are pressed in by a penetration at rest. From any distance off they
would take a step to the outline, strike it, and slide up to 2e-4 in that step."""

STIFF: Final = 1e4
"""[1] ``SimConfig.impratio`` of closings with friction. Fingers that wedge themselves into a corner
press there with 35 times the drive force and creep at 2e-4 diameters / s with 100 (the pliers at
0.5); with 1e4 they come to rest."""

RUBBING: Final = SimConfig(impratio=STIFF, contact_damping=6.0)
"""Settings of closings with friction. Three contacts with nearly one normal rattle at 0.5 (a finger
is lost for a step and comes back, for ever): of 40 closings of ``pliers_best`` 16 came to rest with
the damping ratio of 2, 35 with 6, 30 with 10, 8 with 20."""

AT_REST: Final = SimConfig(impratio=STIFF)
"""Settings for hands that are put down. Damped as above a contact takes its load up more slowly,
and on a wedge of 3 degrees a hand that sticks first slides by 1.7e-4."""

AROUND: Final = 0.5
"""[1] A threshold is looked for between 1 - this and 1 + this times the one foretold."""

FALLS_FROM: Final = (1.5, 2.0, 3.0, 5.0)
"""[1] Friction falls from these times the coefficient foretold ..."""

FALLS_TO: Final = 0.8
"""[1] ... to this, ..."""

FALLS: Final = 2.0
"""[s] ... in this time, by equal shares; the hand slips by ``SLIPS`` within 2 % of it."""

PRESSED: Final = 0.3
"""[s] Before it falls."""

NEAR_BY: Final = 3.0 * SLIPS
"""[diameter, rad] A hand that sticks this near to a placement sticks there: it may move a little
before its forces have found one another."""

_LOOK: Final = 10
"""[step] Between two looks while friction falls."""

NARROW: Final = 0.002
"""[1] An interval is halved until it is narrower than this, relative."""


@dataclass(frozen=True, slots=True)
class Threshold:
    """Where a hand begins to stick, [1]: it slips at ``slips``, sticks at ``sticks``.

    0 and inf for an end that was not seen between the coefficients that were tried. ``penetration``
    [diameter] is the deepest any finger was, ``tried`` how many closings it took.
    """

    slips: float
    sticks: float
    penetration: float
    tried: int


def rubbing(scene: Scene, mu: float, config: SimConfig | None = None) -> Scene:
    """The same hand and object with a coefficient of friction between them, and little creep."""
    rubbed = replace(RUBBING if config is None else config, friction=mu)
    return Scene(scene.outline, scene.hand, scene.finger_radius, rubbed)


def moved(scene: Scene, one: FloatArray, other: FloatArray) -> tuple[FloatArray, FloatArray]:
    """How far hands (N, 4) are apart in the object's frame: middle [diameter], turn [rad]; (N,)."""
    first, second = (scene.hand.fingers(p).mean(axis=-2) for p in (one, other))
    turn = other[..., 2] - one[..., 2]
    gap = (second - first) / scene.object.diameter
    return np.hypot(gap[..., 0], gap[..., 1]), np.abs((turn + np.pi) % (2.0 * np.pi) - np.pi)


def put_down(scene: Scene, placements: FloatArray, threads: int = 1) -> ClosingOutcomes:
    """Close for ``WATCHED`` from placements (N, 4) opened about the middle of the fingers."""
    brief = replace(scene.config, max_time=WATCHED, still_speed=1e-9)
    watched = replace(scene, config=brief)
    return close_many(watched, opened(scene, placements, OPENED), threads)


def opened(scene: Scene, placements: FloatArray, share: float) -> FloatArray:
    """Placements (N, 4) opened by a share of sigma, the middle of the fingers where it was."""
    rows = np.array(np.atleast_2d(placements), dtype=np.float64)
    middle = complex(scene.hand.z.mean())
    off = share * rows[:, 3] * np.exp(1j * rows[:, 2]) * middle
    rows[:, 0] -= off.real
    rows[:, 1] -= off.imag
    rows[:, 3] *= 1.0 + share
    return rows


def stuck(scene: Scene, closed: ClosingOutcomes, slips: float = SLIPS) -> BoolArray:
    """Which closings (N,) ended where they began."""
    shift, turn = moved(scene, closed.start, closed.end)
    return (np.maximum(shift, turn) < slips) & (closed.ending != DIVERGED)


def threshold(
    scene: Scene, placement: FloatArray, foretold: float, config: SimConfig | None = None
) -> Threshold:
    """Bisect the coefficient at which a placement (4,) begins to stick, around one foretold."""
    slips, sticks = (1.0 - AROUND) * foretold, (1.0 + AROUND) * foretold
    deepest, tried = 0.0, 0

    def holds(mu: float) -> bool:
        nonlocal deepest, tried
        there = rubbing(scene, mu, AT_REST if config is None else config)
        closed = put_down(there, placement)
        deepest, tried = max(deepest, float(closed.penetration_max[0])), tried + 1
        return bool(stuck(there, closed)[0])

    if holds(slips):
        return Threshold(0.0, slips, deepest, tried)
    if not holds(sticks):
        return Threshold(sticks, np.inf, deepest, tried)
    while sticks - slips > NARROW * foretold:
        middle = 0.5 * (slips + sticks)
        slips, sticks = (slips, middle) if holds(middle) else (middle, sticks)
    return Threshold(slips, sticks, deepest, tried)


def released_at(
    scene: Scene, placement: FloatArray, foretold: float, config: SimConfig | None = None
) -> float:
    """The least coefficient at which a hand that stuck near a placement (4,) lets go. [1]

    Over falls from each of ``FALLS_FROM``; inf if it never stuck near it, 0 if it never let go.
    """
    found = [_fall(scene, placement, foretold, high, config) for high in FALLS_FROM]
    return foretold * min(found)


def _fall(
    scene: Scene, placement: FloatArray, foretold: float, high: float, config: SimConfig | None
) -> float:
    there = rubbing(scene, high * foretold, AT_REST if config is None else config)
    model, step = there.model, there.config.time_step
    rubbed = np.flatnonzero(model.geom_contype != 0)
    data = mj.MjData(model)
    data.qpos[:] = there.start_positions(opened(there, placement, OPENED))[0]
    data.ctrl[:] = there.closing_force
    mj.mj_step(model, data, nstep=round(PRESSED / step))
    held = there.placements(data.qpos)[0]
    if _apart(there, placement, held) > NEAR_BY:
        return np.inf
    falls = round(FALLS / (_LOOK * step))
    for share in high * (FALLS_TO / high) ** (np.arange(falls) / falls):
        model.geom_friction[rubbed, 0] = share * foretold
        mj.mj_step(model, data, nstep=_LOOK)
        if _apart(there, held, there.placements(data.qpos)[0]) > SLIPS:
            return float(share)
    return 0.0


def _apart(scene: Scene, one: FloatArray, other: FloatArray) -> float:
    return max(float(far) for far in moved(scene, one, other))
