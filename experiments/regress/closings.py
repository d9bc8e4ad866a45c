"""Closings from three sets of placements, and whether each ended where the query said it may.

The *guaranteed* set, the *rest* of the cage, and *outside*: clear placements near the object that
the query puts in another cage or in none. About what is outside and escapes nothing is claimed. But
no closing, from wherever, may end in a grasp of the plan that the query did not name for its start,
and none may let the object go if its start cannot escape.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from experiments.cases.with_discs import PhysicalCase
from experiments.replay.run import Run
from icage.arrays import BoolArray, FloatArray
from icage.cage import Cage
from icage.cells.membership import ESCAPES, OTHER, Answers, query
from icage.kernels.locate import depth_inside
from icage.sampling import SamplingError, Starts, draw_starts, has_rest
from sim.closing.judge import ESCAPED, OTHER_GRASP, TARGET, Tolerances, Verdicts, judge
from sim.closing.outcome import ClosingOutcomes
from sim.world.config import SimConfig
from sim.world.scene import Scene

StartsOf = Literal["guaranteed", "rest", "outside"]
SETS: Final[tuple[StartsOf, ...]] = ("guaranteed", "rest", "outside")

WITNESS: Final = SimConfig(computed_contacts=0, remains=0.0)
"""Every step by the engine, until nothing moves."""

Close = Callable[[Scene, FloatArray], ClosingOutcomes]
"""An engine's closings from starts (N, 4)."""

_CHUNK, _CHUNKS = 2000, 6
"""Placements tried at once, and how often, to find some outside: the first query in a part of space
outside the cage takes milliseconds, and there is a lot of it."""

_WIDE: Final = 1.5
"""[1] Hands outside are up to this times sigma_max, or the largest of the cage, wide."""


@dataclass(frozen=True, slots=True)
class Closed:
    """Closings from one set, judged.

    Attributes
    ----------
    misnamed:
        Ended in a grasp of the plan that the query had not named for the start.
    let_go:
        Ended with nothing in the hand although the query had said that the start is caged.
    """

    run: Run
    misnamed: int
    let_go: int

    @property
    def trials(self) -> int:
        """How many."""
        return len(self.run.closings)

    @property
    def position_error(self) -> float:
        """[diameter] Largest of those that ended in the target; 0 if none did."""
        return self._worst(self.run.verdicts.position_error)

    @property
    def angle_error(self) -> float:
        """[rad] Largest of those that ended in the target; 0 if none did."""
        return self._worst(self.run.verdicts.angle_error)

    @property
    def penetration(self) -> float:
        """[diameter] Deepest disc."""
        return float(self.run.closings.penetration_max.max())

    def _worst(self, errors: FloatArray) -> float:
        return float(errors[self.run.verdicts.outcome == TARGET].max(initial=0.0))


def close_set(
    physical: PhysicalCase,
    second: Cage,
    which: StartsOf,
    count: int,
    rng: np.random.Generator,
    close: Close,
    tolerances: Tolerances | None = None,
) -> Closed | None:
    """Draw, close, judge; None if the set is empty or too small to be drawn from.

    ``second`` is the cage by the other method, kept with the record.
    """
    cage, scene = physical.cage, physical.simulated.scene(WITNESS)
    starts = starts_of(cage, which, count, rng)
    if not len(starts):
        return None
    closings = close(scene, starts.placements)
    verdicts = judge(closings, cage.grasps, cage.outline, tolerances=tolerances)
    answers = query(cage, starts.placements)
    let_go = (answers.verdict < ESCAPES) & (verdicts.outcome == ESCAPED)
    run = Run(physical.case, cage, second, scene, which, starts, closings, verdicts)
    return Closed(run, _misnamed(answers, verdicts), int(let_go.sum()))


def starts_of(cage: Cage, which: StartsOf, count: int, rng: np.random.Generator) -> Starts:
    """Placements of a set, at most ``count``; none if there is none."""
    none = Starts(np.zeros((0, 4)), 0)
    if which == "outside":
        return _outside(cage, count, rng)
    if which == "rest" and not has_rest(cage):
        return none
    try:
        return draw_starts(cage, which, count, rng)
    except SamplingError:
        return none


def _outside(cage: Cage, count: int, rng: np.random.Generator) -> Starts:
    """Clear placements that the query calls ``other`` or ``escapes``, in equal parts if it can be.

    The middle of the hand is anywhere over the object's bounding box.
    """
    top = _WIDE * (cage.sigma_max or cage.sigma_largest or cage.sigma_0)
    low, high = cage.outline.vertices.min(axis=0), cage.outline.vertices.max(axis=0)
    middle = cage.hand.z.mean()
    found: dict[int, list[FloatArray]] = {OTHER: [], ESCAPES: []}
    have, tried = dict.fromkeys(found, 0), 0
    for _ in range(_CHUNKS):
        sigma = rng.uniform(0.3 * cage.sigma_0, top, _CHUNK)
        theta = rng.uniform(-np.pi, np.pi, _CHUNK)
        at = rng.uniform(low, high, (_CHUNK, 2))
        d = at[:, 0] + 1j * at[:, 1] - sigma * np.exp(1j * theta) * middle
        rows = np.column_stack([d.real, d.imag, theta, sigma])
        rows = rows[_clear(cage, rows)]
        verdicts = query(cage, rows).verdict
        tried += _CHUNK
        for verdict, parts in found.items():
            parts.append(rows[verdicts == verdict])
            have[verdict] += len(parts[-1])
        if min(have.values()) >= count:
            break
    others = np.concatenate(found[OTHER])[: (count + 1) // 2]
    free = np.concatenate(found[ESCAPES])[: count - len(others)]
    return Starts(np.concatenate([others, free]), tried)


def _clear(cage: Cage, rows: FloatArray) -> BoolArray:
    fingers = cage.hand.fingers(rows).reshape(-1, 2)
    depth = depth_inside(cage.outline.vertices, fingers, cage.finger_radius).reshape(-1, 3)
    return np.asarray((depth <= 0.0).all(axis=1))


def _misnamed(answers: Answers, verdicts: Verdicts) -> int:
    held = np.flatnonzero(np.isin(verdicts.outcome, [TARGET, OTHER_GRASP]))
    named = answers.verdict[held] < ESCAPES
    return sum(int(verdicts.grasp_id[i]) not in answers.grasps_of(i) for i in held[named].tolist())
