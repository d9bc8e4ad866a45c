"""What friction leaves of the guarantee: where a three-edge grasp jams.

The planner's statement is about frictionless closing. With Coulomb friction mu a closing into a
three-edge grasp can stop wherever the three forces, each within atan(mu) of its normal, still
balance. In a hand that touches all three edges of the target and is turned by theta against it,
the lines from the fingers to the common point make the angle theta with the normals (Miquel), so

    |theta| <= atan(mu)

at every such end. [docs/physics.md, Friction]
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from icage.arrays import BoolArray, FloatArray
from icage.errors import InputError
from icage.geometry.contact_types import Supports, feet, supports
from icage.hand import Placement
from sim.closing.batch import close_many
from sim.closing.step_check import DIVERGED, SETTLED
from sim.world.scene import Scene

TOUCHES: Final = 1e-4
"""[diameter] A disc this near its target edge touches it: friction is regularized, so an end may
still creep while it is that near."""

SLACK: Final = 0.01
"""[rad] Allowed above atan(mu)."""


@dataclass(frozen=True, slots=True)
class FrictionRow:
    """Closings of one grasp at one coefficient.

    Attributes
    ----------
    on_edges, settled:
        How many ended on the target's three edges, and how many of all came to rest in time.
    worst, mean:
        [rad] |theta| against the target over the ends on its edges; 0 if there is none.
    drift:
        [rad] Largest change of theta if the same closings go on for twice as long: sticking is
        regularized in the engine, so a jammed object creeps, most of them too fast to count as
        settled.
    """

    mu: float
    trials: int
    on_edges: int
    settled: int
    worst: float
    mean: float
    drift: float

    @property
    def bound(self) -> float:
        """[rad] atan(mu)."""
        return math.atan(self.mu)

    @property
    def holds(self) -> bool:
        """Whether every end on the target's edges is within the bound and its slack."""
        return self.worst <= self.bound + SLACK

    @property
    def elsewhere(self) -> int:
        """Closings that ended off the target's edges."""
        return self.trials - self.on_edges


def friction_row(
    scene: Scene, contacts: FloatArray, starts: FloatArray, mu: float, threads: int = 0
) -> FrictionRow:
    """Close from the starts (N, 4) at coefficient ``mu`` for the scene's ``max_time`` and look at
    the ends.

    Parameters
    ----------
    contacts:
        (3, 2), finger centres of a three-edge target.

    Raises
    ------
    InputError:
        The target does not rest on three edges.
    """
    held = supports(scene.outline, contacts, scene.finger_radius)
    if not held.three_edges:
        raise InputError(f"the bound is for three edges; this target rests on {held.types}")
    here = replace(scene.config, friction=mu, remains=0.0)  # at a time, not when little is left
    longer = replace(here, max_time=2.0 * here.max_time)
    first, second = (
        close_many(Scene(scene.outline, scene.hand, scene.finger_radius, config), starts, threads)
        for config in (here, longer)
    )
    on = on_target_edges(scene, held, first.end) & (first.ending != DIVERGED)
    turn = np.abs(_wrapped(first.end[on, 2] - Placement.from_contacts(contacts).theta))
    drift = np.abs(_wrapped(second.end[on, 2] - first.end[on, 2]))
    return FrictionRow(
        mu,
        len(starts),
        int(on.sum()),
        int((first.ending == SETTLED).sum()),
        float(turn.max(initial=0.0)),
        float(turn.mean()) if len(turn) else 0.0,
        float(drift.max(initial=0.0)),
    )


def _wrapped(angle: FloatArray) -> FloatArray:
    """Angles brought to [-pi, pi)."""
    return (angle + np.pi) % (2.0 * np.pi) - np.pi


def friction_table(
    scene: Scene,
    contacts: FloatArray,
    starts: FloatArray,
    mus: tuple[float, ...] = (0.0, 0.05, 0.1, 0.2),
    threads: int = 0,
) -> tuple[FrictionRow, ...]:
    """A row per coefficient, from the same starts."""
    return tuple(friction_row(scene, contacts, starts, mu, threads) for mu in mus)


def on_target_edges(scene: Scene, held: Supports, placements: FloatArray) -> BoolArray:
    """Which placements (N, 4) touch every target edge with the finger that rests on it; (N,)."""
    answer = np.zeros(len(placements), dtype=np.bool_)
    near = TOUCHES * scene.outline.diameter
    pairs = list(zip(held.finger.tolist(), held.edge.tolist(), strict=True))
    for i, fingers in enumerate(scene.hand.fingers(placements)):
        answer[i] = all(_touches(scene, fingers[k], j, near) for k, j in pairs)
    return answer


def _touches(scene: Scene, point: FloatArray, edge: int, near: float) -> bool:
    foot, share = feet(scene.outline, point)
    gap = float(np.hypot(*(point - foot[edge])))
    return 0.0 < share[edge] < 1.0 and abs(gap - scene.finger_radius) <= near
