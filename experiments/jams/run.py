"""One case: closings on both sides of every level, and each jam that limits one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from experiments.cases.with_discs import PhysicalCase
from experiments.jams.beside import NEAR, JamTested, judge_jam
from experiments.jams.closings import SIDES, Ends, close_from, draw
from icage.friction.levels import FrictionLevel, Jam, friction_levels
from sim.grip.stick import moved
from sim.world.config import SimConfig

MUS: Final = (0.05, 0.1, 0.2, 0.3, 0.5, 0.8)
"""[1] From greased metal to rubber."""

SOFT: Final = (1e-4, 1e-3)
"""[diameter], [rad] An end may be so much farther from the target than the level's ``ends``: what
counts as the target in a replay."""

SAME: Final = 1e-6
"""[diameter, rad] Jams nearer to one another are one."""


@dataclass(frozen=True, slots=True)
class Judged:
    """A case: its levels, closings from both sides of each, and the jams that limit them."""

    name: str
    physical: PhysicalCase
    seed: int
    levels: tuple[FrictionLevel, ...]
    ends: tuple[Ends, ...]
    jams: tuple[JamTested, ...]
    untested: int
    """Jams that limit a level and hold at no friction up to its own, or at next to none."""

    @property
    def failures(self) -> tuple[str, ...]:
        """What did not hold, a plain sentence each."""
        return tuple(_failures(self))


def judge(
    name: str,
    physical: PhysicalCase,
    trials: int,
    attacks: int,
    seed: int = 0,
    mus: Sequence[float] = MUS,
    config: SimConfig | None = None,
) -> Judged:
    """Close ``trials`` hands from below and from above every level; attack every limiting jam."""
    levels = friction_levels(physical.cage, mus)
    streams = np.random.default_rng([seed, 7]).spawn(3 * len(levels))
    ends: list[Ends] = []
    for k, level in enumerate(levels):
        for side, rng in zip(SIDES, streams[3 * k :], strict=False):
            starts = draw(physical, level, side, trials, rng)
            if len(starts):
                ends.append(close_from(physical, level, side, starts, config))
    found = limiting(physical, levels)
    jams = [
        judge_jam(physical, jam, found_at, attacks, streams[3 * k + 2], config)
        for k, (jam, found_at) in enumerate(found)
    ]
    known = tuple(jam for jam in jams if jam is not None)
    return Judged(name, physical, seed, levels, tuple(ends), known, len(jams) - len(known))


def _farther(done: Judged, one: Ends) -> Iterator[str]:
    """Ends in the target that are farther from it than they may stop."""
    most = next(level.ends for level in done.levels if level.mu == one.mu)
    assert most is not None
    where = one.in_target & one.settled & one.kept & ~one.sunk
    position = float(one.position[where].max(initial=0.0))
    angle = float(one.angle[where].max(initial=0.0))
    if position > most.position_max + SOFT[0] or angle > most.angle_max + SOFT[1]:
        yield (
            f"{done.name}: closings from below sigma_first({one.mu:g}) ended up to {position:.3g} "
            f"diameters and {angle:.3g} rad from the target; {most.position_max:.3g} and "
            f"{most.angle_max:.3g} are foretold"
        )


def below_levels(
    physical: PhysicalCase, mus: Sequence[float], trials: int, seed: int = 0
) -> tuple[Ends, ...]:
    """Closings from below every level only; levels without room to draw from are left out."""
    levels = friction_levels(physical.cage, mus)
    streams = np.random.default_rng([seed, 8]).spawn(len(levels))
    found: list[Ends] = []
    for level, rng in zip(levels, streams, strict=True):
        starts = draw(physical, level, "below", trials, rng)
        if len(starts):
            found.append(close_from(physical, level, "below", starts))
    return tuple(found)


def limiting(
    physical: PhysicalCase, levels: Sequence[FrictionLevel]
) -> list[tuple[Jam, tuple[float, ...]]]:
    """The jams that limit the levels, each once, and at which coefficients."""
    scene = physical.simulated.scene()
    found: list[tuple[Jam, tuple[float, ...]]] = []
    for level in levels:
        if level.jam is None:
            continue
        place = level.jam.placement.as_array()
        for k, (jam, mus) in enumerate(found):
            if max(map(float, moved(scene, place, jam.placement.as_array()))) < SAME:
                found[k] = (jam, (*mus, level.mu))
                break
        else:
            found.append((level.jam, (level.mu,)))
    return found


def _failures(done: Judged) -> Iterator[str]:
    for one in done.ends:
        if one.side == "below" and one.lost:
            yield (
                f"{done.name}: all but {one.lost} of {int(one.kept.sum())} closings from below "
                f"sigma_first({one.mu:g}) ended in the target (seed {done.seed})"
            )
        if one.side == "below":
            yield from _farther(done, one)
        if one.stray.any():
            yield (
                f"{done.name}: {int(one.stray.sum())} of {len(one)} closings from {one.side} "
                f"sigma_first({one.mu:g}) ended where nothing holds (seed {done.seed})"
            )
    for jam in done.jams:
        if jam.measured.sticks < (1.0 - NEAR) * jam.foretold:
            yield (
                f"{done.name}: the jam of {jam.found_at[0]:g} is foretold to hold from "
                f"{jam.foretold:.5g} on and holds at {jam.measured.sticks:.5g}"
            )
        for run in (jam.weaker, jam.stronger):
            if run.stray:
                yield (
                    f"{done.name}: beside the jam of {jam.found_at[0]:g}, {run.stray} of "
                    f"{run.trials} came to rest at {run.mu:.5g} where nothing holds"
                )
