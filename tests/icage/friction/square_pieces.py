"""The pieces round a unit square, as the kernels of friction have them."""

from __future__ import annotations

import numpy as np

from icage.geometry.exterior import exterior_pieces
from icage.hand import HandShape
from icage.outline import Outline


def square_pieces() -> tuple:
    outline = Outline(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]))
    hand = HandShape.from_contacts(np.array([[0.5, 0.0], [1.0, 0.5], [0.5, 1.0]]))
    return exterior_pieces(outline, hand)


def piece_of(pieces: tuple, at: complex) -> int:
    """The piece that a point is deepest in."""
    x, y, slots = np.array(pieces.x), np.array(pieces.y), np.array(pieces.slot_vertex)
    gap = pieces.normal_x * (at.real - x[slots]) + pieces.normal_y * (at.imag - y[slots])
    return int(np.argmax(np.minimum.reduceat(gap, pieces.ptr[:-1])))
