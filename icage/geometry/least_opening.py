"""The least opening of a hand whose fingers keep to given edges. Our own.

min |w|^2  s.t.  n . (d + w z_k - a) >= r for every edge (a, n) that finger k keeps to; sigma = |w|
is convex and the edges are half planes of (d, w), so closing the hand there ends in that minimum.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from icage.arrays import FloatArray, IntArray
from icage.geometry.contact_types import feet
from icage.geometry.least_hand import least_hand
from icage.hand import HandShape
from icage.kernels.locate import depth_inside
from icage.outline import Outline

FEASIBLE: Final = 1e-6
"""[diameter] Constraints may be missed by this; the planner has the last word."""

_ASIDE: Final = 1e-6
"""[1] A hand that comes nearer to an edge by no more than this share of its way moves along it."""

_SHUT: Final = 1e-3
"""[diameter] A least opening below this holds nothing: no edges are in its way."""

_ROUNDS: Final = 12
"""Edges that a finger may roll over, and a few more."""


class NoOpeningError(ValueError):
    """No least opening was found."""


def least_opening(
    outline: Outline,
    hand: HandShape,
    finger: IntArray,
    edge: IntArray,
    near: FloatArray,
    radius: float,
) -> FloatArray:
    """Finger centres (3, 2) of the smallest hand outside the moved edges.

    Parameters
    ----------
    finger, edge:
        (m,) finger 0..2 and edge (from vertex ``edge``) of each support.
    near:
        (3, 2) finger centres to begin from.

    Raises
    ------
    NoOpeningError:
        There is none, or it is shut.
    """
    size, middle = outline.diameter, near.mean(axis=0)
    a = outline.vertices
    out, _ = _normals(outline)
    x, y = out[edge].T
    z = hand.z[finger]
    matrix = np.column_stack([x, y, x * z.real + y * z.imag, y * z.real - x * z.imag])
    level = (radius + (out[edge] * (a[edge] - middle)).sum(axis=1)) / size
    d = complex(*(near[0] - middle)) / size
    found = least_hand(matrix, level, np.array([d.real, d.imag]))
    if found is None or ((matrix * found).sum(axis=1) - level).min() < -FEASIBLE:
        raise NoOpeningError("no hand of this shape stands outside all of these edges")
    if not np.hypot(found[2], found[3]) > FEASIBLE:
        raise NoOpeningError("these edges let the hand close to a point")
    x, y, u, v = found.tolist()
    places = (complex(x, y) + complex(u, v) * hand.z) * size
    return np.column_stack([places.real, places.imag]) + middle


def followed_opening(
    outline: Outline,
    hand: HandShape,
    finger: IntArray,
    edge: IntArray,
    near: FloatArray,
    radius: float,
) -> tuple[FloatArray, IntArray, IntArray]:
    """Least opening and the supports it ends on, followed where fingers leave their edges.

    A finger that reaches into another edge has that one as well; one that presses on its edge
    beyond the end has rolled on to the next. Where that does not come to rest (a finger on a
    vertex) it is the least opening among the edges that were given.

    Raises
    ------
    NoOpeningError:
        No least opening was found.
    """
    first = least_opening(outline, hand, finger, edge, near, radius), finger, edge
    contacts, held = first[0], list(zip(finger.tolist(), edge.tolist(), strict=True))
    for _ in range(_ROUNDS):
        now = held + _reached(outline, held, contacts, radius)
        now = _rolled(outline, held, contacts, radius) if now == held else now
        if now == held:
            finger, edge = np.array(held, dtype=np.int64).T
            return contacts, finger, edge
        held = list(dict.fromkeys(now))
        finger, edge = np.array(held, dtype=np.int64).T
        try:
            contacts = least_opening(outline, hand, finger, edge, near, radius)
        except NoOpeningError:
            break
        if np.hypot(*(contacts[1] - contacts[0])) < _SHUT * outline.diameter:
            break
    return first


_Held = list[tuple[int, int]]


def _reached(outline: Outline, held: _Held, contacts: FloatArray, radius: float) -> _Held:
    """The nearest other edge of every finger that reaches into the outline."""
    deep = depth_inside(outline.vertices, contacts, radius) > FEASIBLE * outline.diameter
    new: _Held = []
    for k in np.flatnonzero(deep).tolist():
        points, _ = feet(outline, contacts[k])
        away = np.hypot(*(points - contacts[k]).T)
        away[[j for finger, j in held if finger == k]] = np.inf
        new.append((k, int(away.argmin())))
    return new


def _rolled(outline: Outline, held: _Held, contacts: FloatArray, radius: float) -> _Held:
    """Supports, with the next edge for the one that is pressed farthest beyond its end."""
    out, length = _normals(outline)
    beyond = np.zeros(len(held))
    for i, (k, j) in enumerate(held):
        x, y = contacts[k] - outline.vertices[j]
        foot = out[j, 0] * y - out[j, 1] * x
        if out[j, 0] * x + out[j, 1] * y - radius <= FEASIBLE * outline.diameter:
            beyond[i] = max(foot - length[j], 0.0) + min(foot, 0.0)
    i = int(np.abs(beyond).argmax())
    if abs(beyond[i]) <= FEASIBLE * outline.diameter:
        return held
    k, j = held[i]
    return [*held[:i], (k, (j + int(np.sign(beyond[i]))) % len(outline)), *held[i + 1 :]]


def sliding_room(
    outline: Outline, finger: IntArray, edge: IntArray, contacts: FloatArray, radius: float
) -> tuple[FloatArray, FloatArray] | None:
    """Finger centres (3, 2) at both ends of the way a hand of least opening may shift, or None.

    A hand that fits loosely has one: its fingers press on opposite edges, and it slides along them
    until another of its edges stops it, or a finger comes to the end of its own.
    """
    size, at = outline.diameter, contacts[finger] - outline.vertices[edge]
    out, length = _normals(outline)
    n = out[edge]
    slack = np.maximum((n * at).sum(axis=1) - radius, 0.0)
    pressed = slack <= FEASIBLE * size
    along = np.column_stack([-n[:, 1], n[:, 0]])
    foot = (along * at).sum(axis=1)[pressed]
    walls = np.vstack([n, along[pressed], -along[pressed]])
    rooms = np.concatenate([np.where(pressed, 0.0, slack), foot, length[edge][pressed] - foot])

    def far(way: FloatArray) -> float:
        pace = -(walls * way).sum(axis=1)
        stops = pace > _ASIDE
        return max(float((rooms[stops] / pace[stops]).min(initial=np.inf)), 0.0)

    way = max(along[pressed], key=lambda way: far(way) + far(-way))
    ahead, behind = far(way), far(-way)
    if not FEASIBLE * size < ahead + behind < np.inf:
        return None
    return contacts + ahead * way, contacts - behind * way


def _normals(outline: Outline) -> tuple[FloatArray, FloatArray]:
    """Outward unit normals (n, 2) and lengths (n,) of the edges."""
    side = np.roll(outline.vertices, -1, axis=0) - outline.vertices
    length = np.hypot(*side.T)
    return np.column_stack([side[:, 1], -side[:, 0]]) / length[:, None], length
