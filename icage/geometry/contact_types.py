"""What each finger of a grasp rests on: an edge, a convex vertex, a concave corner, or nothing.

From the outline alone, without the engine. A finger in a concave corner touches two edges; then
three fingers give four contacts or more and can hold the object to first order. Three fingers on
three edges never can: their force lines meet in one point, about which nothing resists a small
turn but the second order. [Bunis2018, Sec. IV-C]
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal, TypeAlias

import numpy as np

from icage.arrays import FloatArray, IntArray
from icage.outline import Outline

ContactType: TypeAlias = Literal["edge", "vertex", "concave_corner", "free"]

REACH: Final = 1e-5
"""[diameter] A finger this close to an edge rests on it."""

ONE_NORMAL: Final = 0.03
"""[rad] Normals nearer than this are one: a disc that rests 1e-6 deep on a seam between two convex
pieces feels the neighbour's corner under sqrt(2 depth / radius), a hundredth."""


@dataclass(frozen=True, slots=True)
class Supports:
    """The half planes in which the fingers of a grasp move while they keep to their contacts.

    Attributes
    ----------
    types:
        Of fingers 1, 2, 3.
    finger, edge:
        (m,) finger 0..2 and edge (from vertex ``edge``) of each support.
    normals:
        (m, 2) unit vectors out of the object, at the finger's centre.
    """

    types: tuple[ContactType, ContactType, ContactType]
    finger: IntArray
    edge: IntArray
    normals: FloatArray

    @property
    def concave_corners(self) -> int:
        """Fingers in concave corners."""
        return sum(kind == "concave_corner" for kind in self.types)

    @property
    def three_edges(self) -> bool:
        """Whether every finger rests on one straight edge."""
        return self.types == ("edge", "edge", "edge")


def supports(outline: Outline, contacts: FloatArray, radius: float) -> Supports:
    """Supports of finger centres (3, 2) with discs of ``radius`` > 0, in the outline's unit."""
    fingers: list[int] = []
    edges: list[int] = []
    normals: list[FloatArray] = []
    types: list[ContactType] = []
    for k, point in enumerate(np.asarray(contacts, dtype=np.float64)):
        foot, share = feet(outline, point)
        away = point - foot
        gap = np.hypot(*away.T)
        mine: list[FloatArray] = []
        on_side = False
        for j in np.flatnonzero(np.abs(gap - radius) <= REACH * outline.diameter).tolist():
            normal = away[j] / gap[j]
            on_side = on_side or 0.0 < share[j] < 1.0
            if all(normal @ other < np.cos(ONE_NORMAL) for other in mine):
                mine.append(normal)
                fingers.append(k)
                edges.append(j)
        normals += mine
        types.append(_type(len(mine), on_side))
    first, second, third = types
    return Supports(
        (first, second, third),
        np.array(fingers, dtype=np.int64),
        np.array(edges, dtype=np.int64),
        np.array(normals).reshape(-1, 2),
    )


def _type(count: int, on_side: bool) -> ContactType:
    if count == 0:
        return "free"
    if count > 1:
        return "concave_corner"
    return "edge" if on_side else "vertex"


def feet(outline: Outline, point: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Nearest point (n, 2) of every edge, and its share (n,) of the way along it, 0 to 1."""
    a = outline.vertices
    side = np.roll(a, -1, axis=0) - a
    share = np.clip(((point - a) * side).sum(axis=1) / (side**2).sum(axis=1), 0.0, 1.0)
    return a + share[:, None] * side, share


def on_supports(outline: Outline, held: Supports, fingers: FloatArray) -> bool:
    """Whether fingers (3, 2) still stand over the inside of the edges they rest on."""
    for k, j in zip(held.finger.tolist(), held.edge.tolist(), strict=True):
        _, share = feet(outline, fingers[k])
        if not 0.0 < share[j] < 1.0:
            return False
    return True


def on_others(outline: Outline, held: Supports, fingers: FloatArray, radius: float) -> bool:
    """Whether a finger (3, 2) has come up against an edge that it did not rest on."""
    reach = radius + REACH * outline.diameter
    for k in range(3):
        points, _ = feet(outline, fingers[k])
        distance = np.hypot(*(points - fingers[k]).T)
        if (np.delete(distance, held.edge[held.finger == k]) <= reach).any():
            return True
    return False
