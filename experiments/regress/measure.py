"""One case, everything measured: both planners, closings, attacks, shake, the second engine."""

from __future__ import annotations

import importlib.util
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np

from experiments.cases.with_discs import DerivedCaseError, PhysicalCase, physical_case
from experiments.escape.run import Escape, at, attacked
from experiments.jams.closings import Ends
from experiments.jams.run import below_levels
from experiments.regress.cases import Effort, Entry
from experiments.regress.closings import SETS, Close, Closed, close_set
from experiments.shake.run import ShakeError, Shaken, shake_case
from icage.agreement import disagreements
from icage.arrays import FloatArray
from icage.cage import Cage
from icage.case import Case
from icage.contact_space.method import ContactSpace
from icage.formats.case_json import read_case
from icage.method import Method
from icage.planner import plan
from sim.attack.held import Attacks
from sim.attack.random import RandomPull
from sim.closing.batch import close_many
from sim.closing.judge import Tolerances
from sim.closing.outcome import ClosingOutcomes
from sim.closing.step_check import SETTLED, TIMED_OUT
from sim.world.scene import Scene

SEED: Final = 0

SECOND_TIME: Final = 8.0
"""[s] Longest closing in the second engine, which is ten times slower."""

SECOND_ATTACK: Final = 5.0
"""[s] Of one attack in the second engine, a third of the usual: its steps are taken in Python."""

SECOND_NEAR: Final = Tolerances(0.05, 0.1, 0.05, 0.1)
"""The second engine says which grasp it is, not how exactly: where the fingers wedge, its depth of
contact is felt a hundredfold."""


@dataclass(frozen=True, slots=True)
class Second:
    """What the second engine says: closings and random attacks below sigma_max."""

    closed: tuple[Closed, ...]
    attacks: Attacks | None


@dataclass(frozen=True, slots=True)
class Planned:
    """A case by both methods."""

    case: Case
    cells: Cage
    contact_space: Cage

    @property
    def differences(self) -> list[str]:
        """Where the methods disagree, in words."""
        return disagreements(self.cells, self.contact_space)


@dataclass(frozen=True, slots=True)
class Row:
    """Everything measured of one case.

    Attributes
    ----------
    physical:
        None if there is nothing to close into (not a cage), or no discs fit; ``why`` says which.
    seed, effort:
        With which it comes out again.
    rubbed:
        Closings with friction, from below sigma_first(mu).
    """

    name: str
    planned: Planned
    seed: int
    effort: Effort
    physical: PhysicalCase | None = None
    physical_plan: Planned | None = None
    why: str | None = None
    closed: tuple[Closed, ...] = field(default=())
    escape: Escape | None = None
    shaken: Shaken | None = None
    shake_error: str | None = None
    second: Second | None = None
    rubbed: tuple[Ends, ...] = field(default=())


def measure(entry: Entry, effort: Effort, seed: int = SEED) -> Row:
    """Read, plan by both methods, derive discs if the fingers are points, and test in physics."""
    case = read_case(entry.path)
    planned = plan_both(case)
    row = Row(entry.name, planned, seed, effort)
    if planned.cells.status == "not_a_cage":
        return replace(row, why=f"not_a_cage: {planned.cells.why}")
    try:
        physical = physical_case(case, cage=planned.cells)
    except DerivedCaseError as error:
        return replace(row, why=str(error))
    return in_physics(row, physical)


def plan_both(case: Case, second: Method | None = None, cells: Cage | None = None) -> Planned:
    """A case by the cells and by the paper's method, or by another in its place.

    ``cells`` is the cells' plan where it is known.
    """
    first = cells or plan(case.outline, case.contacts, case.finger_radius)
    other = plan(case.outline, case.contacts, case.finger_radius, second or ContactSpace())
    return Planned(case, first, other)


def in_physics(row: Row, physical: PhysicalCase) -> Row:
    """Close, attack and shake the physical case of a row."""
    effort, seed = row.effort, row.seed
    streams = np.random.default_rng([seed, 5]).spawn(len(SETS))
    both = plan_both(physical.case, cells=physical.cage) if physical.derived else row.planned
    row = replace(row, physical=physical, physical_plan=both)
    if effort.closings:
        closed = _closed(row, effort.closings, streams, lambda s, x: close_many(s, x, 1), None)
        row = replace(row, closed=closed)
        try:
            row = replace(row, shaken=shake_case(physical, seed))
        except ShakeError as error:
            row = replace(row, shake_error=str(error))
    if effort.closings and effort.mus:
        row = replace(row, rubbed=below_levels(physical, effort.mus, effort.closings, seed))
    if effort.attacks:
        escape = attacked(physical, effort.attacks, seed, 1, _silent, effort.measuring)
        row = replace(row, escape=escape)
    if effort.second and second_engine():
        row = replace(row, second=_second(row, effort.second, seed))
    return row


def second_engine() -> bool:
    """Whether the second engine is installed."""
    return importlib.util.find_spec("pymunk") is not None


def _closed(
    row: Row,
    count: int,
    streams: list[np.random.Generator],
    close: Close,
    near: Tolerances | None,
) -> tuple[Closed, ...]:
    assert row.physical is not None
    assert row.physical_plan is not None
    other = row.physical_plan.contact_space
    sets = zip(SETS, streams, strict=True)
    found = [close_set(row.physical, other, which, count, rng, close, near) for which, rng in sets]
    return tuple(one for one in found if one is not None)


def _second(row: Row, count: int, seed: int) -> Second:
    """The same sets and attacks, fewer of them: this engine has no batch."""
    from sim.chipmunk.attack import random_attack_second  # optional, and slow to load
    from sim.chipmunk.closing import close_many_second

    def close(scene: Scene, starts: FloatArray) -> ClosingOutcomes:
        brief = replace(scene.config, max_time=SECOND_TIME)
        found = close_many_second(replace(scene, config=brief), starts)
        # there some contacts never come to rest: such an end is judged by its pose alone
        ending = np.where(found.ending == TIMED_OUT, SETTLED, found.ending)
        return replace(found, ending=ending)

    streams = np.random.default_rng([seed, 6]).spawn(len(SETS) + 1)
    closed = _closed(row, count, streams[:-1], close, SECOND_NEAR)
    physical = row.physical
    assert physical is not None
    cage = physical.cage
    if cage.sigma_max is None:
        return Second(closed, None)
    scene = physical.simulated.scene()
    level = at(cage.sigma_max, cage.sigma_0, -1) / scene.object.diameter
    start = scene.start_positions(cage.target_placement.as_array())
    pull = RandomPull(duration=SECOND_ATTACK)
    attacks = random_attack_second(
        scene, np.repeat(start, count, axis=0), np.full(count, level), streams[-1], pull
    )
    return Second(closed, attacks)


def _silent(stage: str, done: int, total: int) -> None:
    """Attacks report to nobody here: cases do."""
