"""Point fingers have no body to simulate: the same hand with small discs, closed on the object.

A derived case has the same outline and phi, discs of 2 % of the diameter (1 % if that fails) and
as target the grasp in which that hand ends when it is closed from the original pose. The original
pose with discs touches nothing only once the hand is opened a little: the nearest clear pose found
by sampling is taken. The closing comes to rest within 1e-6 of the diameter of a grasp; ``plan`` has
the last word on where exactly it is, and physics is compared with that plan only.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from icage.arrays import FloatArray
from icage.errors import GeometryError, IcageError, InputError
from icage.formats.case_json import Case
from icage.hand import HandShape, Placement
from icage.kernels.locate import depth_inside
from sim.closing import close
from sim.config import SimConfig
from sim.scene import Scene

RADII: Final = (0.02, 0.01, 0.03)
"""[diameter] Radii tried in turn."""

_NEAR: Final = 5.0
"""[radius] A grasp farther from the original one than this is another grasp."""

_TRIES: Final = 20_000
"""Poses sampled at every reach."""


class DerivedError(IcageError):
    """No derived case: the target is gone with discs of every radius tried."""


def derived_case(case: Case, rng: np.random.Generator) -> Case:
    """The disc case that stands for a point-finger case.

    Raises
    ------
    DerivedError:
        Says for every radius tried why there is none.
    """
    if case.finger_radius > 0.0:
        raise InputError(f"{case.name} has disc fingers already")
    reasons: list[str] = []
    for share in RADII:
        radius = share * case.outline.diameter
        try:
            contacts = _target(case, radius, rng)
            return Case(
                f"{case.name}, discs of {100.0 * share:g} %", case.unit, case.outline, radius,
                contacts, case.sources,
            )  # fmt: skip
        except (InputError, GeometryError, DerivedError) as error:
            reasons.append(f"radius {100.0 * share:g} %: {error}")
    raise DerivedError(f"{case.name} has no derived case: {'; '.join(reasons)}")


def _target(case: Case, radius: float, rng: np.random.Generator) -> FloatArray:
    """Contacts (3, 2) of the grasp the closing ends in."""
    hand = HandShape.from_contacts(case.contacts)
    start = _clear_start(case, hand, radius, rng)
    scene = Scene(case.outline, hand, radius, SimConfig())
    closed = close(scene, start)
    if closed.ending != "settled":
        raise DerivedError(f"closing from the original pose ended {closed.ending}")
    end = closed.end
    moved = np.abs(hand.fingers(end.as_array()) - case.contacts)
    if np.hypot(moved[:, 0], moved[:, 1]).max() > _NEAR * radius:
        raise DerivedError("closing from the original pose leads to another grasp")
    return hand.fingers(end.as_array())


def _clear_start(case: Case, hand: HandShape, radius: float, rng: np.random.Generator) -> Placement:
    """The clear pose nearest to the original one (fingers' largest way), of those sampled."""
    pose = Placement.from_contacts(case.contacts)
    fingers = hand.fingers(pose.as_array())
    for reach in radius * np.array([1.5, 2.0, 3.0, 4.0]):
        d = complex(pose.x, pose.y) + reach * rng.uniform(-1.5, 1.5, (_TRIES, 2)) @ [1.0, 1j]
        w = pose.sigma * np.exp(1j * pose.theta)
        w = w + reach * rng.uniform(-3.0, 3.0, (_TRIES, 2)) @ [1.0, 1j]
        rows = np.column_stack([d.real, d.imag, np.angle(w), np.abs(w)])
        placed = hand.fingers(rows)
        deep = depth_inside(case.outline.vertices, placed.reshape(-1, 2), radius)
        clear = (deep.reshape(-1, 3) < -1e-3 * radius).all(axis=1)
        way = np.hypot(*np.moveaxis(placed - fingers, -1, 0)).max(axis=1)
        way = np.where(clear & (way < reach * 2.0), way, np.inf)
        if np.isfinite(way).any():
            return Placement(*rows[int(way.argmin())].tolist())
    raise DerivedError("no clear pose of the hand near the original one")
