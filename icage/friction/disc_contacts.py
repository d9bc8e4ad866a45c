"""Contact features of disc fingers: edges, concave corners and arcs of the true curve, by piece.

A finger of radius r whose centre is at p touches the object at p + r n, n the unit inward normal of
the curve. On an edge that is a constant offset; in a concave corner of the curve two elements push
at once, each at its own point; on the arc round a convex vertex the finger touches the vertex, and
n turns with p. Arcs come in short parts, each known by its middle direction and half its turn; the
search for jams splits them further where it matters. [docs/theory.md, Sec. 10]
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from icage.arrays import BoolArray, FloatArray, IntArray
from icage.discs.arc_stops import unit_vectors
from icage.discs.curve import TrueCurve
from icage.discs.edges import Edges
from icage.friction.kernels.disc_features import ARC, CORNER, EDGE
from icage.geometry.exterior import Pieces
from icage.geometry.kernels.pieces import WALL

_PART = 0.25
"""[rad] Turn of a part of an arc to begin with."""

_ON_WALL = 1e-9
"""[diameter] An edge this near to a wall is on it: above what dropped vertices may shift it."""

_INSIDE = 1e-12
"""[diameter] A part of an arc that reaches less far into a piece is in its neighbour's."""

_SMOOTH = 1e-9
"""[rad] Elements that meet at a smaller angle have no corner."""


class DiscContacts(NamedTuple):
    """Contact features, in the frame of the pieces.

    Piece k has the features which[ptr[k]:ptr[k + 1]]. ``place`` (m, 4) is a point and the side that
    starts there (0, 0 for a corner; for an arc the vertex and 0, 0). ``angle`` (m, 2) [rad]: of an
    edge the inward normal, twice; of a corner both normals; of an arc the direction from its vertex
    to its middle, and half its turn. ``apex`` (n, 2) are all convex vertices of the object.
    """

    ptr: IntArray
    which: IntArray
    kind: IntArray
    place: FloatArray
    angle: FloatArray
    apex: FloatArray
    radius: float


def disc_contacts(curve: TrueCurve, pieces: Pieces, origin: FloatArray) -> DiscContacts:
    """The features of a true curve on the pieces round a polygon that lies inside it.

    ``origin`` (2,) is that of the pieces, in the frame of the curve.
    """
    every, radius = curve.elements, curve.radius
    edges = Edges.of(curve.ring)
    ring, first, last = curve.ring - origin, every.first - origin, every.last - origin
    is_arc = every.turn > 0.0
    inward = np.arctan2(-edges.out[:, 1], -edges.out[:, 0])
    # of an arc against the direction from its vertex, which turns from its start to its end
    begins = np.where(is_arc, every.angle + math.pi, inward[every.number])
    ends = begins + every.turn
    straight = np.flatnonzero(~is_arc)
    turn = np.roll(begins, -1) - ends
    turn = (turn + math.pi) % (2.0 * math.pi) - math.pi
    corner = np.flatnonzero(np.abs(turn) > _SMOOTH)
    arcs = np.flatnonzero(is_arc)
    parts = np.maximum(1, np.ceil(every.turn[arcs] / _PART)).astype(np.int64)
    arc = np.repeat(arcs, parts)
    half = 0.5 * every.turn[arc] / np.repeat(parts, parts)
    place = np.arange(len(arc)) - np.repeat(np.cumsum(parts) - parts, parts)
    middle = every.angle[arc] + (2 * place + 1) * half
    apex = ring[every.number[arc]]

    none = np.zeros((max(len(corner), len(arc)), 2))
    places = [
        np.column_stack([first[straight], last[straight] - first[straight]]),
        np.column_stack([last[corner], none[: len(corner)]]),
        np.column_stack([apex, none[: len(arc)]]),
    ]
    angles = [
        np.column_stack([begins[straight], begins[straight]]),
        np.column_stack([ends[corner], np.roll(begins, -1)[corner]]),
        np.column_stack([middle, half]),
    ]
    kinds = [np.full(len(places[k]), kind) for k, kind in enumerate((EDGE, CORNER, ARC))]
    size = pieces.diameter
    point = last[corner][:, None]
    inside = np.concatenate(
        [
            _on_walls(pieces, first[straight], last[straight], _ON_WALL * size),
            _meet(pieces, point, -_ON_WALL * size),
            _meet(pieces, _hulls(apex, middle, half, radius), _INSIDE * size),
        ]
    )
    feature, piece = np.nonzero(inside)
    order = np.lexsort((feature, piece))
    counts = np.bincount(piece, minlength=pieces.total)
    return DiscContacts(
        ptr=np.concatenate([[0], np.cumsum(counts)]).astype(np.int64),
        which=np.ascontiguousarray(feature[order], dtype=np.int64),
        kind=np.concatenate(kinds).astype(np.int64),
        place=np.ascontiguousarray(np.concatenate(places)),
        angle=np.ascontiguousarray(np.concatenate(angles)),
        apex=np.ascontiguousarray(ring[edges.convex]),
        radius=radius,
    )


def _hulls(apex: FloatArray, middle: FloatArray, half: FloatArray, radius: float) -> FloatArray:
    """Triangles (m, 3, 2) of the ends of arcs and of the crossing of their tangents."""
    ends = [apex + radius * unit_vectors(middle + way * half) for way in (-1.0, 1.0)]
    over = apex + (radius / np.cos(half))[:, None] * unit_vectors(middle)
    return np.stack([*ends, over], axis=1)


def _on_walls(pieces: Pieces, first: FloatArray, last: FloatArray, near: float) -> BoolArray:
    """Which straight edges (m, 2), (m, 2) lie on a wall of which piece, (m, pieces)."""
    found = np.zeros((len(first), pieces.total), dtype=np.bool_)
    wall = np.flatnonzero(pieces.slot_neighbour == WALL)
    owner = np.searchsorted(pieces.ptr, wall, side="right") - 1
    n = np.column_stack([pieces.normal_x[wall], pieces.normal_y[wall]])
    end = np.roll(pieces.slot_vertex, -1)
    end[pieces.ptr[1:] - 1] = pieces.slot_vertex[pieces.ptr[:-1]]
    a, b = (
        np.column_stack([pieces.x[v], pieces.y[v]]) for v in (pieces.slot_vertex[wall], end[wall])
    )
    at = (n * a).sum(axis=1)
    on = (np.abs(first @ n.T - at) <= near) & (np.abs(last @ n.T - at) <= near)
    way = np.column_stack([n[:, 1], -n[:, 0]])
    low, high = (way * a).sum(axis=1), (way * b).sum(axis=1)
    low, high = np.minimum(low, high), np.maximum(low, high)
    s, t = first @ way.T, last @ way.T
    on &= (np.minimum(s, t) <= high + near) & (np.maximum(s, t) >= low - near)
    edge, number = np.nonzero(on)
    found[edge, owner[number]] = True
    return found


def _meet(pieces: Pieces, hull: FloatArray, depth: float) -> BoolArray:
    """Which convex hulls (m, k, 2) no side of which piece keeps out, (m, pieces).

    A hull that a side keeps to a depth of less is kept out. A few may be taken to meet that do not.
    """
    found = np.empty((len(hull), pieces.total), dtype=np.bool_)
    n = np.column_stack([pieces.normal_x, pieces.normal_y])
    v = pieces.slot_vertex
    at = n[:, 0] * pieces.x[v] + n[:, 1] * pieces.y[v]
    begin = pieces.ptr[:-1]
    x, y = pieces.x[v], pieces.y[v]
    low = np.column_stack([np.minimum.reduceat(x, begin), np.minimum.reduceat(y, begin)])
    high = np.column_stack([np.maximum.reduceat(x, begin), np.maximum.reduceat(y, begin)])
    for rows in np.array_split(np.arange(len(hull)), 1 + len(hull) * len(n) // 1_000_000):
        part = hull[rows]
        reach = (part @ n.T).max(axis=1) - at
        some = np.logical_and.reduceat(reach >= depth, begin, axis=1)
        least, most = part.min(axis=1)[:, None], part.max(axis=1)[:, None]
        some &= ((least <= high - depth) & (most >= low + depth)).all(axis=2)
        found[rows] = some
    return found
