"""Closings with friction, from below sigma_first(mu) and from above, judged in the plan's measure.

That measure is how far the middle of the fingers is from its place at the target and how far the
hand is turned, both in the object's frame: not the centroid in the hand of replays and studies.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np

from experiments.cases.with_discs import PhysicalCase
from icage.arrays import BoolArray, FloatArray
from icage.friction.levels import FrictionLevel
from icage.friction.nearest import nearest_jam
from icage.sampling import Box, SamplingError, draw_starts, safe_level
from sim.closing.batch import close_many
from sim.closing.outcome import ClosingOutcomes
from sim.closing.step_check import DIVERGED, PINCHED, SETTLED, TIMED_OUT
from sim.grip.jam import held_by_engine, residual
from sim.grip.stick import RUBBING, moved, rubbing
from sim.world.config import SimConfig
from sim.world.scene import Scene

Side = Literal["below", "above"]
SIDES: Final[tuple[Side, ...]] = ("below", "above")

LONGEST: Final = 4.0
"""[s] Ten times what a closing takes; what still moves then is given ten times as long."""

OFF_BALANCE: Final = 1e-3
"""[drive_force] An end with a larger residual is not held by friction."""

DEEPEST_AT_REST: Final = 1e-5
"""[diameter] A finger deeper than this at the end is not where it is said to be."""

TRIES: Final = 40
"""Times more hands are drawn for the upper side than are wanted of it."""


MEASURED: Final = 3
"""Ends of a run whose nearest jam is looked for: a search each."""

GENTLER: Final = 0.1
"""[1] Of the drive force, for closings that did not come to rest, or whose hand may have been past
the level: fingers sink in by up to 5e-4 diameters when they strike, in proportion to it."""


@dataclass(frozen=True, slots=True)
class Ends:
    """Closings from one side of one level; ``starts`` and ``ends`` (N, 4) in the case's unit.

    Attributes
    ----------
    from_afar, in_target:
        (N,) starts outside the tolerance of the target, ends within it.
    settled:
        (N,) came to rest; the others swung or moved when time was up.
    position, angle:
        (N,) [diameter], [rad] of the ends from the target.
    residual:
        (N,) [drive_force] what is off balance at the end; nan in the target.
    to_jam:
        (N,) [diameter] the farthest finger's way to the nearest planned jam, for ``MEASURED`` of
        the ends at rest outside the target; nan for the others.
    repeated:
        How many closed again, for ten times as long or at ``GENTLER``; that is what counts of them.
    near_level:
        (N,) a finger sank in so deep that the hand may have been past the level. Fingers that are
        off by p are no wider apart than those of a hand of size sigma + 2 p.
    sunk:
        (N,) fingers that wedge themselves into a corner sink in: deeper than ``DEEPEST_AT_REST``.
    penetration:
        [diameter] of the deepest finger.
    """

    side: Side
    mu: float
    level: float
    starts: FloatArray
    ends: FloatArray
    from_afar: BoolArray
    in_target: BoolArray
    settled: BoolArray
    position: FloatArray
    angle: FloatArray
    residual: FloatArray
    to_jam: FloatArray
    repeated: int
    near_level: BoolArray
    sunk: BoolArray
    penetration: float

    def __len__(self) -> int:
        return len(self.starts)

    @property
    def kept(self) -> BoolArray:
        """(N,) those that count: below the level whatever fingers sank in."""
        return ~self.near_level

    @property
    def lost(self) -> int:
        """How many of those that count ended outside the target."""
        return int((self.kept & ~self.in_target).sum())

    @property
    def stray(self) -> BoolArray:
        """(N,) at rest neither in the target nor where friction holds."""
        return self.settled & ~self.in_target & ~(self.residual <= OFF_BALANCE)


def draw(
    physical: PhysicalCase, level: FrictionLevel, side: Side, count: int, rng: np.random.Generator
) -> FloatArray:
    """Placements (n, 4) of the guaranteed set on one side of a level; fewer or none if it is thin.

    Below, a little below it, as guaranteed sets are drawn.
    """
    cage = physical.cage
    if side == "above":
        if level.sigma_first is None or level.jam is None:
            return np.zeros((0, 4))
        try:
            rows = draw_starts(cage, "guaranteed", TRIES * count, rng).placements
        except SamplingError:
            return np.zeros((0, 4))
        return rows[rows[:, 3] >= level.sigma_first][:count]
    box = Box.around(cage, "guaranteed", safe_level(level.sigma_first, cage.sigma_0))
    try:
        return draw_starts(cage, "guaranteed", count, rng, box=box).placements
    except SamplingError:
        return np.zeros((0, 4))


def close_from(
    physical: PhysicalCase,
    level: FrictionLevel,
    side: Side,
    starts: FloatArray,
    config: SimConfig | None = None,
    threads: int = 1,
) -> Ends:
    """Close from placements (N, 4) at the level's coefficient, and look where each ends."""
    cage, mu, near = physical.cage, level.mu, level.tolerance
    top = np.inf if level.sigma_first is None or side == "above" else level.sigma_first
    usual = replace(RUBBING if config is None else config, max_time=LONGEST)
    scene = rubbing(physical.simulated.scene(), mu, usual)
    closed = close_many(scene, starts, threads)
    repeated = np.zeros(len(starts), dtype=np.bool_)
    longer = replace(usual, max_time=LONGEST / GENTLER)
    for patient in (longer, gentler(usual)):
        open_now = _near_level(scene, closed, top)
        late = closed.ending == TIMED_OUT
        deep = closed.penetration_rest > DEEPEST_AT_REST
        again = np.flatnonzero(late & ~open_now if patient is longer else late | open_now | deep)
        if len(again):
            repeated[again] = True
            later = close_many(rubbing(scene, mu, patient), starts[again], threads)
            places = np.arange(len(starts))
            places[again] = len(starts) + np.arange(len(again))
            closed = ClosingOutcomes.joined([closed, later]).picked(places)
    target = cage.target_placement.as_array()
    shift, turn = moved(scene, target, closed.end)
    began_off, began_turned = moved(scene, target, closed.start)
    lost = np.isin(closed.ending, (DIVERGED, PINCHED))
    there = (shift <= near.position) & (turn <= near.angle) & ~lost
    off, away = np.full((2, len(starts)), np.nan)
    for i in np.flatnonzero(~there & ~lost).tolist():
        off[i] = residual(held_by_engine(scene, closed.end[i]), mu)
    for i in np.flatnonzero(~there & (closed.ending == SETTLED))[:MEASURED].tolist():
        away[i] = nearest_jam(cage, mu, closed.end[i])[0] / cage.outline.diameter
    return Ends(
        side=side,
        mu=mu,
        level=np.inf if level.sigma_first is None else level.sigma_first,
        starts=closed.start,
        ends=closed.end,
        from_afar=(began_off > near.position) | (began_turned > near.angle),
        in_target=there,
        settled=closed.ending == SETTLED,
        position=shift,
        angle=turn,
        residual=off,
        to_jam=away,
        repeated=int(repeated.sum()),
        near_level=_near_level(scene, closed, top),
        sunk=closed.penetration_rest > DEEPEST_AT_REST,
        penetration=float(closed.penetration_max.max(initial=0.0)),
    )


def gentler(config: SimConfig) -> SimConfig:
    """The same at a tenth of the force, with the time that it takes."""
    return replace(
        config,
        drive_force=GENTLER * config.drive_force,
        still_speed=GENTLER * config.still_speed,
        max_time=config.max_time / GENTLER,
    )


def _near_level(scene: Scene, closed: ClosingOutcomes, top: float) -> BoolArray:
    """Which hands (N,) were at any step as wide as a level [unit], or might as well have been."""
    widest = closed.sigma_rise_max * closed.start[:, 3]
    return widest + 2.0 * closed.penetration_max * scene.object.diameter >= top
