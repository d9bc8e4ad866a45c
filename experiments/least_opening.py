"""The least opening of a hand whose fingers keep to given edges. Our own.

min |w|^2  s.t.  n . (d + w z_k - a) >= r for every edge (a, n) that finger k keeps to; sigma = |w|
is convex and the edges are half planes of (d, w), so closing the hand there ends in that minimum.
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from scipy.optimize import minimize

from icage.arrays import FloatArray, IntArray
from icage.hand import HandShape
from icage.outline import Outline

FEASIBLE: Final = 1e-6
"""[diameter] Constraints may be missed by this; the planner has the last word."""

_ASIDE: Final = 1e-6
"""[1] A hand that comes nearer to an edge by no more than this share of its way moves along it."""

_AT_MINIMUM: Final = (0, 8)
"""SLSQP has converged, or can go no lower for rounding."""


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
        The search did not converge.
    """
    size, middle = outline.diameter, near.mean(axis=0)
    a = outline.vertices
    out, _ = _normals(outline)
    x, y = out[edge].T
    z = hand.z[finger]
    matrix = np.column_stack([x, y, x * z.real + y * z.imag, y * z.real - x * z.imag])
    level = (radius + (out[edge] * (a[edge] - middle)).sum(axis=1)) / size
    d = complex(*(near[0] - middle)) / size
    w = complex(*(near[1] - near[0])) / size
    grown = 1.0 + 4.0 * radius / (size * abs(w))
    found: Any = minimize(
        lambda v: v[2] ** 2 + v[3] ** 2,
        np.array([d.real, d.imag, w.real, w.imag]) * grown,
        jac=lambda v: np.array([0.0, 0.0, 2.0 * v[2], 2.0 * v[3]]),
        constraints={"type": "ineq", "fun": lambda v: matrix @ v - level, "jac": lambda v: matrix},
        method="SLSQP",
        options={"maxiter": 200, "ftol": 1e-15},
    )
    if found.status not in _AT_MINIMUM or (matrix @ found.x - level).min() < -FEASIBLE:
        raise NoOpeningError(str(found.message))
    x, y, u, v = found.x.tolist()
    places = (complex(x, y) + complex(u, v) * hand.z) * size
    return np.column_stack([places.real, places.imag]) + middle


def sliding_room(
    outline: Outline, finger: IntArray, edge: IntArray, contacts: FloatArray, radius: float
) -> tuple[FloatArray, FloatArray] | None:
    """Finger centres (3, 2) at both ends of the way a hand of least opening may be shifted, or None.

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
        pace = -walls @ way
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
