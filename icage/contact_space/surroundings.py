"""Boundary, plane and hand as flat arrays for the contact space kernels.

Contact space is the set of hands with two fingers on the boundary. [Bunis2018, Def. 2]
The exterior pieces are those of the cells' method; from here on nothing is shared with it.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from icage.arrays import FloatArray, IntArray
from icage.geometry.exterior import exterior_pieces
from icage.geometry.kernels.pieces import WALL
from icage.hand import HandShape
from icage.kernels.tips import SHARP, tips_of
from icage.outline import Outline

CLIP: Final = 1e-13
"""[scale] A corner this close to a line is on it. At 1e-11 sigma_max was off by 3.5e-8."""

TOUCH: Final = 1e-8
"""[scale] A third finger this close to the boundary touches it: no tunnel edge starts there."""

HAIR: Final = 1e-12
"""[scale] Walls reach this far beyond their ends when rays are shot."""

TIE: Final = 1e-11
"""[scale] Levels this close are one; a tenth of the depth at which a minimum counts."""

PINCH: Final = 1e-12
"""[scale] A hand smaller than this is pinched."""


class Surroundings(NamedTuple):
    """Edges of the object, pieces of the plane, hand; coordinates relative to ``origin``.

    Edge q runs counterclockwise from vertex q, with the object on its left. ``turn`` of pair i is
    the paper's R_{i,i+1} as a complex number: X = f_i + turn (f_{i+1} - f_i).
    [Bunis2018, Sec. IV-B] ``tip_*`` are the sharp tips of the pieces (``kernels.tips``).
    """

    edge_x: FloatArray
    edge_y: FloatArray
    edge_tx: FloatArray
    edge_ty: FloatArray
    edge_length: FloatArray
    edge_piece: IntArray
    ptr: IntArray
    slot_x: FloatArray
    slot_y: FloatArray
    slot_nx: FloatArray
    slot_ny: FloatArray
    slot_length: FloatArray
    slot_next: IntArray
    slot_edge: IntArray
    tip_ptr: IntArray
    tip_x: FloatArray
    tip_y: FloatArray
    tip_nx: FloatArray
    tip_ny: FloatArray
    turn_re: FloatArray
    turn_im: FloatArray
    rho: FloatArray
    unit_re: FloatArray
    unit_im: FloatArray
    z_re: FloatArray
    z_im: FloatArray
    clip: float
    touch: float
    hair: float
    tie: float
    flat: float
    pinch: float

    @property
    def edges(self) -> int:
        """Number of edges n."""
        return len(self.edge_x)


def surroundings(
    outline: Outline, hand: HandShape, *, merge: bool = True
) -> tuple[Surroundings, FloatArray]:
    """Cut the plane and lay everything out; returns the origin too. O(n log n)."""
    pieces, origin = exterior_pieces(outline, hand, merge=merge, apexes=False)
    ring = np.column_stack([pieces.x[4:], pieces.y[4:]])  # the box has the first four vertices
    side = np.roll(ring, -1, axis=0) - ring
    length = np.hypot(side[:, 0], side[:, 1])
    n = len(ring)
    slots = len(pieces.slot_vertex)
    slot_edge = np.full(slots, -1, dtype=np.int64)
    owner = np.repeat(np.arange(pieces.total), np.diff(pieces.ptr))
    walls = np.flatnonzero(pieces.slot_neighbour == WALL)
    # a wall runs clockwise round the object: it ends where its edge begins
    slot_edge[walls] = (pieces.slot_vertex[walls] - 5) % n
    edge_piece = np.empty(n, dtype=np.int64)
    edge_piece[slot_edge[walls]] = owner[walls]
    after = np.arange(1, slots + 1)
    after[pieces.ptr[1:] - 1] = pieces.ptr[:-1]
    slot_end = pieces.slot_vertex[after]
    slot_length = np.hypot(
        pieces.x[slot_end] - pieces.x[pieces.slot_vertex],
        pieces.y[slot_end] - pieces.y[pieces.slot_vertex],
    )
    ends = hand.z[[1, 2, 0]] - hand.z
    turn = (hand.z[[2, 0, 1]] - hand.z) / ends
    unit = 1.0 / ends
    scale = outline.diameter
    tips = tips_of(pieces, SHARP)
    return Surroundings(
        edge_x=np.ascontiguousarray(ring[:, 0]),
        edge_y=np.ascontiguousarray(ring[:, 1]),
        edge_tx=side[:, 0] / length,
        edge_ty=side[:, 1] / length,
        edge_length=length,
        edge_piece=edge_piece,
        ptr=pieces.ptr,
        slot_x=pieces.x[pieces.slot_vertex],
        slot_y=pieces.y[pieces.slot_vertex],
        slot_nx=pieces.normal_x,
        slot_ny=pieces.normal_y,
        slot_length=slot_length,
        slot_next=pieces.slot_neighbour,
        slot_edge=slot_edge,
        **tips._asdict(),
        turn_re=np.ascontiguousarray(turn.real),
        turn_im=np.ascontiguousarray(turn.imag),
        rho=np.abs(unit),
        unit_re=np.ascontiguousarray(unit.real),
        unit_im=np.ascontiguousarray(unit.imag),
        z_re=np.ascontiguousarray(hand.z.real),
        z_im=np.ascontiguousarray(hand.z.imag),
        clip=CLIP * scale,
        touch=TOUCH * scale,
        hair=HAIR * scale,
        tie=TIE * scale,
        flat=CLIP * scale,
        pinch=PINCH * scale,
    ), origin
