"""Nodes of the caging graph in one convex region. [Bunis2018, Def. 7]

The search walks stars with one node a seam instead (``kernels/explore.py``): by convexity of sigma
the sublevel sets are the same. This is the graph as the paper draws it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from icage.arrays import FloatArray
from icage.contact_space.boundary import Boundary
from icage.contact_space.formation_scale import ScaleForm
from icage.contact_space.third_finger import Parallelogram
from icage.hand import HandShape

Kind: TypeAlias = Literal["vertex", "extremum", "escape"]

_TOUCHES = 1e-9
"""[perimeter] A third finger this close to the boundary is on it."""

_NO_CHANGE = 1e-12
"""[1] Sigma does not change along an edge if it does by no more than this over its length."""

_SAME = 1e-12
"""[perimeter] Corners of a region this close are one node."""


@dataclass(frozen=True, slots=True)
class Node:
    """A node: where, at what sigma, what it is.

    Attributes
    ----------
    s:
        (2,) = s_i, s_{i+1}, [unit].
    sigma:
        [unit].
    kind:
        "vertex" of a convex region, "extremum" of sigma on one of its edges (Eq. (5)), or
        "escape": a vertex at which the fingers are pinched.
    third:
        s_{i+2} if all three fingers touch, [unit]; None if the third is free. [Bunis2018, Sec. V-A]
    """

    s: FloatArray
    sigma: float
    kind: Kind
    third: float | None


def lambda_crit(form: ScaleForm, s_1: FloatArray, s_2: FloatArray) -> float | None:
    """Where on the edge s_1 + lambda (s_2 - s_1) sigma has its extremum. [Bunis2018, Eq. (5)]

    None where sigma does not change along the edge (A Delta s = 0: parallel edges).
    """
    step = form.a @ (s_2 - s_1)
    square = float(step @ step)
    if square <= _NO_CHANGE**2 * float((s_2 - s_1) @ (s_2 - s_1)):
        return None
    return float(-(step @ (form.a @ s_1 + form.b)) / square)


def nodes_of_region(
    boundary: Boundary, hand: HandShape, pair: int, j: int, k: int, corners: FloatArray
) -> list[Node]:
    """Nodes of a convex region of R_jk with these corners (m, 2). [Bunis2018, Def. 7]

    First the vertices, then the extrema inside edges; at most twice the number of corners.
    """
    form = ScaleForm.of(boundary, hand, pair, j, k)
    finger = Parallelogram.over(boundary, hand, pair, j, k)
    same = _SAME * boundary.perimeter
    places: list[tuple[FloatArray, Kind]] = []
    for s in corners:
        if all(np.hypot(*(s - other)) > same for other, _ in places):
            pinched = float(form(s)) <= same
            places.append((s, "escape" if pinched else "vertex"))
    for s_1, s_2 in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        at = lambda_crit(form, s_1, s_2)
        if at is not None and 0.0 < at < 1.0:
            s = s_1 + at * (s_2 - s_1)
            if all(np.hypot(*(s - other)) > same for other, _ in places):
                places.append((s, "extremum"))
    return [Node(s, float(form(s)), kind, _third(boundary, finger, s)) for s, kind in places]


def _third(boundary: Boundary, finger: Parallelogram, s: FloatArray) -> float | None:
    """S_{i+2} = s_{i+2}^0 + t_{i+2} . (X - p_{i+2}^0) if the third finger touches. [V-A]"""
    x = finger.at(s)
    edge, _, gap = boundary.nearest(x)
    if gap > _TOUCHES * boundary.perimeter:
        return None
    return float(boundary.s_0[edge] + boundary.tangent[edge] @ (x - boundary.start[edge]))
