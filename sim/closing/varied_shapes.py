"""Closings of a study: many trials, each in its own world, some each with a shape of its own.

Trials that share a scene run together on one model; the others, one model each, run together where
their models have the same layout. Every trial is looked at every ``LOOK_EVERY`` steps. Its result
depends on nothing but its own scene, world and start. Free travel is skipped
(``sim.closing.approach``) but on a tilted table, where the object slides meanwhile.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from icage.arrays import BoolArray, FloatArray, IntArray
from sim.closing.approach import approached
from sim.closing.outcome import ClosingOutcomes
from sim.closing.push import push
from sim.closing.step_check import RUNNING, SETTLED, StepCheck
from sim.closing.varied import Setting, Worlds, expand, own_model, settings
from sim.world.engine import Batch, MjModel, mj, no_log
from sim.world.machine_loops import counting
from sim.world.scene import Scene

LOOK_EVERY: Final = 5
"""[step] Between two looks at a closing: depth, force and stillness are seen this often."""

CREEP_SPEED: Final = 1e-3
"""[diameter / s, rad / s] Trials with friction, of fingers or table, slower than this for
``CREEP_STEPS`` are at rest. Sticking is regularized in the engine, so a jammed object creeps,
mostly at 1e-5 to 3e-4, at 1.4e-3 where the fingers press hardest (seen); sliding ones move at 1e-2
or more."""

CREEP_STEPS: Final = 100
"""[step] In this time a creeping object moves by less than 1e-4."""

DRIFT: Final = 1e-3
"""[diameter, rad] ... as are those whose mean positions over one span of ``DRIFT_STEPS`` and over
the next differ by less than this, times the closing speed if it is below 1, while they stay within
``SWING``. With friction a contact may be lost for a step and come back, for ever: such objects
swing by up to 6e-4 and 3e-3 rad about a mean that moves by 1e-5, at times 1e-4 (seen). Those that
creep fastest move by 7e-4, the slowest that still slid moved by 5e-3 in this time."""

DRIFT_STEPS: Final = 500
SWING: Final = 5e-3

TOGETHER: Final = 24
"""[trial] From this many trials on, a scene has a batch of its own."""


@dataclass(frozen=True, slots=True)
class VariedOutcomes:
    """Closings, and the largest normal force on any finger at any look, (N,) [closing force]."""

    closings: ClosingOutcomes
    peak_force: FloatArray


class _Rest:
    """Which trials of a batch creep, or swing about a mean that drifts less than ``drift`` (N,)."""

    def __init__(self, count: int, drift: FloatArray) -> None:
        self._drift = drift[:, None]
        self._creeping, self._seen = np.zeros((2, count), dtype=np.int64)
        self._sum = np.zeros((count, 6))
        self._mean = np.full((count, 6), np.inf)
        self._swing = np.zeros((count, 6))
        self.found = np.zeros(count, dtype=np.bool_)

    def look(self, ids: IntArray, positions: FloatArray, velocities: FloatArray) -> None:
        """Look at trials ``ids`` after ``LOOK_EVERY`` more steps."""
        slow = np.abs(velocities[ids]).max(axis=1) < CREEP_SPEED
        self._creeping[ids] = np.where(slow, self._creeping[ids] + LOOK_EVERY, 0)
        self.found[ids] = self._creeping[ids] >= CREEP_STEPS
        self._seen[ids] += LOOK_EVERY
        self._sum[ids] += positions[ids]
        self._swing[ids] = np.maximum(self._swing[ids], np.abs(positions[ids] - self._mean[ids]))
        self._end_span(ids[self._seen[ids] % DRIFT_STEPS == 0])

    def _end_span(self, ids: IntArray) -> None:
        mean = self._sum[ids] / (DRIFT_STEPS // LOOK_EVERY)
        still = np.abs(mean - self._mean[ids]) < self._drift[ids]
        self.found[ids] |= (still & (self._swing[ids] < SWING)).all(axis=1)
        self._mean[ids], self._sum[ids], self._swing[ids] = mean, 0.0, 0.0


@dataclass(frozen=True, slots=True)
class _Part:
    """Trials of one scene inside a batch: the first's place there, and the places among all."""

    scene: Scene
    first: int
    rows: IntArray
    check: StepCheck


def close_varied(
    scenes: Sequence[Scene], which: IntArray, starts: FloatArray, worlds: Worlds, threads: int = 1
) -> VariedOutcomes:
    """Close from every start (N, 4), trial i in ``scenes[which[i]]`` and in world i.

    Parameters
    ----------
    scenes:
        Instrumented; with friction if any of the worlds has.
    worlds:
        A closing slower than usual has as much longer before it has timed out.
    threads:
        0 for one per core; the result is the same for any number.
    """
    count = len(starts)
    order: list[IntArray] = []
    parts: list[VariedOutcomes] = []
    with no_log():
        for lot in _lots(scenes, which):
            parts.append(_close_lot(lot, starts, worlds, threads))
            order += [rows for _, rows in lot]
    if not count:
        return _nothing()
    closings = ClosingOutcomes.joined([part.closings for part in parts])
    back = np.argsort(np.concatenate(order))
    return VariedOutcomes(
        closings.picked(back), np.concatenate([part.peak_force for part in parts])[back]
    )


_Lot = list[tuple[Scene, IntArray]]


def _lots(scenes: Sequence[Scene], which: IntArray) -> Iterator[_Lot]:
    """Trials that run in one batch: those of one scene, or all of rare scenes of one layout."""
    rare: dict[tuple[int, ...], _Lot] = {}
    for number, scene in enumerate(scenes):
        rows = np.flatnonzero(which == number)
        if len(rows) >= TOGETHER:
            yield [(scene, rows)]
        elif len(rows):
            rare.setdefault(_layout(scene.model), []).append((scene, rows))
    yield from rare.values()


def _layout(model: MjModel) -> tuple[int, ...]:
    """What must agree between the models of one batch: the sizes of MjData."""
    names = ("ngeom", "nbody", "njnt", "nv", "neq", "ntendon", "nsensordata", "nbvh")
    return tuple(int(getattr(model, name)) for name in names)


@counting
def _pressed(
    ids: IntArray, force: FloatArray, warning: IntArray, peak: FloatArray
) -> BoolArray:  # pragma: no cover - compiled
    """Raise ``peak`` (N,) of trials ``ids`` to the largest of their ``force`` (N, 3).

    Which of them the engine has warned of, by its counters ``warning`` (N, kinds, 2). A force that
    is no number is kept.
    """
    warned = np.zeros(len(ids), dtype=np.bool_)
    for n in range(len(ids)):
        i = ids[n]
        most = peak[i]
        for k in range(force.shape[1]):
            if force[i, k] > most or np.isnan(force[i, k]):
                most = force[i, k]
        peak[i] = most
        for kind in range(warning.shape[1]):
            if warning[i, kind, 1] != 0:
                warned[n] = True
    return warned


def _close_lot(lot: _Lot, starts: FloatArray, worlds: Worlds, threads: int) -> VariedOutcomes:
    batch, parts, peak = _opened(lot, starts, worlds, threads)
    positions, velocities = batch.bind("qpos"), batch.bind("qvel")
    force, warning = batch.bind("sensordata"), batch.warning
    batch.bind("ncon")  # read at the end: a field bound after the last step would be 0
    held_up = (worlds.friction > 0.0) | (worlds.table_friction > 0.0)
    rough = np.concatenate([held_up[rows] for _, rows in lot])
    pace = np.concatenate([worlds.speed[rows] for _, rows in lot])
    rest = _Rest(len(rough), DRIFT * np.minimum(pace, 1.0)) if rough.any() else None
    left = [part.check.running + part.first for part in parts]
    while len(running := np.concatenate(left) if len(left) > 1 else left[0]):
        lost: Any = ()
        try:
            batch.step(running.astype(np.int32), nstep=LOOK_EVERY)
        except mj.batch.SimulationError as error:
            lost = np.asarray(error.ids)
        bad = running[_pressed(running, force, warning, peak)]
        if len(lost):
            bad = np.union1d(bad, lost).astype(np.int64)
        if rest is not None:
            rest.look(running[rough[running]], positions, velocities)
        left = [
            _look(part, mine, positions, velocities, rest, bad)
            for part, mine in zip(parts, left, strict=True)
        ]
    return _read_off(parts, starts, batch, peak)


def _look(
    part: _Part, running: IntArray, positions: FloatArray, velocities: FloatArray,
    rest: _Rest | None, bad: IntArray,
) -> IntArray:  # fmt: skip
    """Observe the trials of one scene that are running, and tell which still are."""
    check, first, last = part.check, part.first, part.first + len(part.rows)
    if not len(running):
        return running
    left = check.observe(running - first, positions[first:last], velocities[first:last])
    if rest is None and not len(bad):
        return left + first
    if rest is not None:
        still = rest.found[first:last] & (check.ending == RUNNING) & (check.touches >= 1)
        check.ending[still] = SETTLED
    if len(bad):
        check.diverged(bad[(bad >= first) & (bad < last)] - first)
    return check.running + first


def _opened(
    lot: _Lot, starts: FloatArray, worlds: Worlds, threads: int
) -> tuple[Any, list[_Part], FloatArray]:
    """The batch where the engine takes over, the hands closing, and the largest forces so far."""
    total = sum(len(rows) for _, rows in lot)
    batch = Batch(lot[0][0].model, nsim=total, nthread=threads)
    models: list[MjModel] = []
    parts: list[_Part] = []
    begin, speed, push_on = np.zeros((3, total, 6))
    pull, peak = np.zeros((total, 1)), np.zeros(total)
    usual = worlds.are_usual
    first = 0
    for scene, rows in lot:
        here = slice(first, first + len(rows))
        qpos = scene.start_positions(starts[rows])
        level = (worlds.gravity_x[rows] == 0.0) & (worlds.gravity_y[rows] == 0.0)
        free = np.where(level[:, None], approached(scene, qpos), qpos)
        pull[here, 0] = scene.closing_force * worlds.force[rows]
        changes: list[Setting] = list(settings(scene, worlds[rows]))
        if len(lot) == 1 and len(rows) >= TOGETHER:
            expand(batch, changes)
        else:
            models += [own_model(scene.model, changes, i) for i in range(len(rows))]
        patience = 1.0 / np.minimum(worlds.speed[rows], 1.0)
        held_up = (worlds.friction[rows] > 0.0) | (worlds.table_friction[rows] > 0.0)
        remains = np.where(held_up, 0.0, scene.config.remains)
        check = StepCheck.over(scene, qpos, LOOK_EVERY, patience, remains)
        pushed = push(scene, free, check, usual[rows])
        begin[here], speed[here] = pushed.positions, pushed.velocities
        push_on[here], peak[here] = pushed.accelerations, pushed.peak_force
        parts.append(_Part(scene, first, rows, check))
        first += len(rows)
    if models:
        batch.set_models(models)
    batch.qpos, batch.qvel, batch.qacc_warmstart = begin, speed, push_on
    batch.ctrl = pull
    return batch, parts, peak


def _read_off(
    parts: list[_Part], starts: FloatArray, batch: Any, peak: FloatArray
) -> VariedOutcomes:
    found: list[ClosingOutcomes] = []
    forces_now, positions, touching = batch.sensordata, batch.qpos, batch.ncon
    drive: list[FloatArray] = []
    first = 0
    for part in parts:
        here = slice(first, first + len(part.rows))
        force = part.scene.config.drive_force
        ends = part.scene.placements(np.array(positions[here]))
        forces, contacts = np.array(forces_now[here]) / force, np.array(touching[here], np.int64)
        found.append(ClosingOutcomes.seen(part.check, starts[part.rows], ends, forces, contacts))
        drive.append(np.full(len(part.rows), force))
        first += len(part.rows)
    return VariedOutcomes(ClosingOutcomes.joined(found), peak / np.concatenate(drive))


def _nothing() -> VariedOutcomes:
    none, whole = np.zeros(0), np.zeros(0, dtype=np.int64)
    rows = np.zeros((0, 4))
    closings = ClosingOutcomes(
        rows, rows.copy(), whole, whole.copy(), none, none.copy(), none.copy(), none.copy(),
        np.zeros((0, 3)), whole.copy(),
    )  # fmt: skip
    return VariedOutcomes(closings, none.copy())
