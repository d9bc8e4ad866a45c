"""Contact features of the pieces, each with the cone of forces that a finger may apply there.

A finger on an edge pushes along the inward normal, up to atan(mu) to either side. At a convex
vertex any normal between those of its two edges may act; in a concave one both edges push at once,
and their forces add up. Both give all directions between the two outermost ones, except that a sum
of forces has no gap: where the two cones of a concave vertex reach round more than half of all
directions, they give every force. [docs/theory.md, Sec. 10]
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from icage.arrays import FloatArray, IntArray
from icage.geometry.exterior import Pieces
from icage.geometry.kernels.pieces import WALL

_WIDEST = 2.0
"""[rad] A wider cone is split: a cone of less than pi is the meet of two half planes, and nearer
to pi rounding would decide which."""


class Contacts(NamedTuple):
    """Contact features by piece: those of piece k are the rows ptr[k]:ptr[k + 1].

    ``place`` (m, 4) is a point and the side that starts there (0, 0 for a vertex); ``cone`` (m, 4)
    are the unit vectors of the right and the left edge of the force cone, less than pi apart.
    """

    ptr: IntArray
    place: FloatArray
    cone: FloatArray


def contacts_of(pieces: Pieces, mu: float) -> Contacts:
    """The walls of every piece, and the object's vertices among its corners, for a coefficient."""
    half = math.atan(mu)
    end = _slot_ends(pieces)
    wall = np.flatnonzero(pieces.slot_neighbour == WALL)
    # pieces lie outside the object, so their inward normals point out of it
    normal = np.arctan2(-pieces.normal_y, -pieces.normal_x)
    leaves = dict(zip(pieces.slot_vertex[wall].tolist(), normal[wall].tolist(), strict=True))
    enters = dict(zip(end[wall].tolist(), normal[wall].tolist(), strict=True))
    counts, places, cones = [0], list[tuple[float, ...]](), list[tuple[float, ...]]()
    for piece in range(pieces.total):
        for slot in range(int(pieces.ptr[piece]), int(pieces.ptr[piece + 1])):
            v, to = int(pieces.slot_vertex[slot]), int(end[slot])
            x, y = float(pieces.x[v]), float(pieces.y[v])
            features = list[tuple[float, float, float, float]]()
            if pieces.slot_neighbour[slot] == WALL:
                along = normal[slot]
                side = float(pieces.x[to]) - x, float(pieces.y[to]) - y
                features.append((*side, along - half, along + half))
            if v in leaves and v in enters:
                features.append((0.0, 0.0, *_vertex_cone(leaves[v], enters[v], half)))
            for side_x, side_y, right, left in features:
                for a, b in _split(right, left):
                    places.append((x, y, side_x, side_y))
                    cones.append((math.cos(a), math.sin(a), math.cos(b), math.sin(b)))
        counts.append(len(places))
    return Contacts(
        np.array(counts, dtype=np.int64),
        np.array(places, dtype=np.float64).reshape(-1, 4),
        np.array(cones, dtype=np.float64).reshape(-1, 4),
    )


def _slot_ends(pieces: Pieces) -> IntArray:
    """The vertex at which each slot ends."""
    end = np.roll(pieces.slot_vertex, -1)
    end[pieces.ptr[1:] - 1] = pieces.slot_vertex[pieces.ptr[:-1]]
    return end


def _vertex_cone(before: float, after: float, half: float) -> tuple[float, float]:
    """Right and left edge, [rad], of the cone at a vertex of the object.

    ``before`` and ``after`` are the directions of the inward normals of the edges that end and
    start there, counterclockwise round the object.
    """
    turn = math.remainder(after - before, 2.0 * math.pi)
    right, left = min(before, before + turn) - half, max(before, before + turn) + half
    if turn < 0.0 and left - right > math.pi:
        return right, right + 2.0 * math.pi
    return right, min(left, right + 2.0 * math.pi)


def _split(right: float, left: float) -> list[tuple[float, float]]:
    """The cone in parts that are none too wide."""
    parts = max(1, math.ceil((left - right) / _WIDEST))
    return list(pairwise(np.linspace(right, left, parts + 1).tolist()))
