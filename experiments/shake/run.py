"""``icage shake``: close into the target, lock the fingers, push, and look at the contacts.

Put together from ``sim``: what a grasp rests on (``contact_types``), the contacts of the engine
(``form_closure``), the pushes (``shake``) and the play of a hand a little larger (``play``).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from experiments.cases.with_discs import PhysicalCase
from icage.arrays import FloatArray
from icage.cage import Cage
from icage.cells.membership import TARGET, query
from icage.errors import IcageError
from icage.geometry.contact_types import Supports, supports
from icage.hand import Placement
from icage.kernels.locate import depth_inside
from icage.sampling import SamplingError, draw_starts
from sim.closing.batch import close_many
from sim.closing.judge import OUTCOMES, Verdicts, judge
from sim.closing.outcome import ClosingOutcomes
from sim.grip.form_closure import FormClosure, Touches, form_closure, touches, wrench_matrix
from sim.grip.play import Play, measure_play, opened
from sim.grip.shake import Shake, shake
from sim.world.config import SimConfig
from sim.world.scene import Scene

DELTAS: Final = (1e-4, 1e-3, 1e-2)
"""[1] Openings above sigma_0 at which the play of a three-edge grasp is measured."""

PLAY_TOLERANCE: Final = 0.15
"""[1] Play against acos(1 / (1 + delta)), while all fingers stand over their edges."""

_WIDEST: Final = 0.05
"""[1] The start is opened by up to this share of sigma_0, or nine tenths of the guaranteed set."""

_TRIES, _ROUNDS = 2000, 20
"""Starts tried at once, and how often, each time half as far from the target."""


class ShakeError(IcageError):
    """No start next to the target was found from which closing can end only in it."""


@dataclass(frozen=True, slots=True)
class Shaken:
    """Everything ``icage shake`` measured.

    Attributes
    ----------
    supports:
        What the planner's target rests on.
    qpos:
        (6,) where the closing ended, in the engine.
    form_closure, shake:
        Of the closed hand; None if it did not close into the target.
    plays:
        One per delta for a three-edge target, else empty.
    """

    physical: PhysicalCase
    seed: int
    scene: Scene
    supports: Supports
    closings: ClosingOutcomes
    verdicts: Verdicts
    qpos: FloatArray
    touches: Touches | None
    form_closure: FormClosure | None
    shake: Shake | None
    plays: tuple[Play, ...]

    @property
    def outcome(self) -> str:
        """Where the closing ended."""
        return OUTCOMES[int(self.verdicts.outcome[0])]

    @property
    def held(self) -> bool:
        """Closed into the target and held in the shake (``sim.grip.shake``)."""
        return self.outcome == "target" and self.shake is not None and self.shake.held

    @property
    def failures(self) -> tuple[str, ...]:
        """What did not hold, a sentence each."""
        return tuple(_failures(self))


def shake_case(physical: PhysicalCase, seed: int, config: SimConfig | None = None) -> Shaken:
    """Close, lock, push and measure.

    Raises
    ------
    ShakeError:
        No start was found.
    """
    case, cage = physical.case, physical.cage
    rng = np.random.default_rng(seed)
    scene = physical.simulated.scene(config or SimConfig(remains=0.0))
    held = supports(case.outline, cage.contacts, case.finger_radius)
    start = start_near_target(cage, held, rng)
    closings = close_many(scene, start.as_array()[None, :], threads=1)
    verdicts = judge(closings, cage.grasps, case.outline)
    qpos = scene.start_positions(closings.end)[0]
    there = OUTCOMES[int(verdicts.outcome[0])] == "target"
    found = touches(scene, qpos) if there else None
    return Shaken(
        physical, seed, scene, held, closings, verdicts, qpos, found,
        None if found is None else form_closure(_wrenches(found, qpos)),
        shake(scene, qpos, rng) if there else None,
        tuple(measure_play(scene, held, cage.contacts, delta) for delta in DELTAS)
        if held.three_edges else (),
    )  # fmt: skip


def _wrenches(found: Touches, qpos: FloatArray) -> FloatArray:
    return wrench_matrix(found.points, found.normals, qpos[3:5])


def start_near_target(cage: Cage, held: Supports, rng: np.random.Generator) -> Placement:
    """A random placement of the guaranteed set, clear of the object; next to the target if one is
    found there, else anywhere in the set.

    Raises
    ------
    ShakeError:
        None was found in a bounded number of tries.
    """
    top = np.inf if cage.sigma_first is None else cage.sigma_first / cage.sigma_0 - 1.0
    wide = min(_WIDEST, 0.9 * top)
    for _ in range(_ROUNDS):
        rows = _candidates(cage, held, rng, wide)
        fingers = cage.hand.fingers(rows).reshape(-1, 2)
        depth = depth_inside(cage.outline.vertices, fingers, cage.finger_radius).reshape(-1, 3)
        rows = rows[(depth <= 0.0).all(axis=1)]
        if len(rows):
            rows = rows[query(cage, rows).verdict == TARGET]
        if len(rows):
            return Placement(*rows[0].tolist())
        wide *= 0.5
    try:
        return Placement(*draw_starts(cage, "guaranteed", 1, rng).placements[0].tolist())
    except SamplingError as error:
        raise ShakeError(f"no start closes into the target alone: {error}") from error


def _candidates(cage: Cage, held: Supports, rng: np.random.Generator, wide: float) -> FloatArray:
    """Hands (n, 4) opened by up to ``wide``, turned and shifted about as far as there is room."""
    scale = 1.0 + wide * rng.uniform(0.5, 1.0, _TRIES)
    turn = np.sqrt(2.0 * wide) * rng.uniform(-0.5, 0.5, _TRIES) * rng.random(_TRIES)
    shift = 0.5 * wide * cage.sigma_0 * (rng.uniform(-1.0, 1.0, (2, _TRIES)) * rng.random(_TRIES))
    middle = opened(held, cage.contacts, 1.0 + wide)
    z = cage.hand.z
    at = complex(middle.x, middle.y) + middle.sigma * np.exp(1j * middle.theta) * z.mean()
    theta, sigma = middle.theta + turn, cage.sigma_0 * scale
    d = at + shift[0] + 1j * shift[1] - sigma * np.exp(1j * theta) * z.mean()
    return np.column_stack([d.real, d.imag, theta, sigma])


def _failures(done: Shaken) -> Iterator[str]:
    if done.outcome != "target":
        yield f"closing from next to the target ended as {done.outcome.replace('_', ' ')}"
        return
    if done.shake is not None and not done.shake.held:
        word = "the engine diverged" if done.shake.diverged else "the object is not held"
        moved, turned = done.shake.shift, done.shake.turn
        yield f"{word}: it moved {moved:.3g} diameters and turned {turned:.3g} rad"
    if done.form_closure is not None and not done.form_closure.agrees_with(done.supports):
        yield (
            f"form closure {done.form_closure.closed} and rank {done.form_closure.rank} do not go "
            f"with {done.supports.concave_corners} contacts at concave corners"
        )
    for play in done.plays:
        worst = max(abs(turn / play.law - 1.0) for turn in play.measured)
        if play.on_edges and worst > PLAY_TOLERANCE:
            yield f"play at delta = {play.delta:g} is {worst:.0%} off acos(1 / (1 + delta))"
