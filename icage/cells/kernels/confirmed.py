"""The least point of which doubles know the rows that decide, in double-double: those rows alone.

Where other rows may be tight as well, at an angle at which rounding counts, doubles cannot tell
whether these hold. Nearly all hold exactly, as they meet in a vertex. Our own.
[docs/decisions/0014-whole-sublevels.md]
"""

# pyright: basic
from __future__ import annotations

import math

from icage.cells.kernels.careful import (
    CAREFUL_SLACK,
    careful_bound,
    careful_end,
    careful_row,
    careful_side,
)
from icage.cells.kernels.min_norm import FOUND, UNSURE, LeastNorm
from icage.kernels import double_double as dd
from icage.kernels.compiled import compiled_borrowing


@compiled_borrowing
def _bound(pieces, z, facet, side, slots, row):
    """The bound of a row of ``Bounds``."""
    if row >= len(slots):
        return careful_end(pieces, row > len(slots))
    other, piece = facet.second, facet.second_piece
    if 2 * row >= len(slots):
        other, piece = facet.third, facet.third_piece
    return careful_bound(pieces, z, facet.finger, facet.start, side, other, piece, slots[row])


@compiled_borrowing
def confirmed(pieces, z, facet, slots, near, found):
    """The least norm of which doubles found the rows that decide, if all near it hold there.

    Else ``UNSURE``. In double-double; ``slots`` and ``near`` are those of ``Bounds``.
    """
    slack = CAREFUL_SLACK * pieces.scale
    side = careful_side(pieces, facet.start, facet.end)
    lower = _bound(pieces, z, facet, side, slots, found.a)
    upper = _bound(pieces, z, facet, side, slots, found.b)
    if lower.along_hi <= 0.0 or upper.along_hi >= 0.0:
        return LeastNorm(UNSURE, 0.0, 0.0)
    r = careful_row(lower, upper)
    if found.rows == 1:
        nh, nl = dd.dot(
            r.g.x_hi, r.g.x_lo, r.g.y_hi, r.g.y_lo, r.g.x_hi, r.g.x_lo, r.g.y_hi, r.g.y_lo
        )
        kh, kl = dd.div(r.c_hi, r.c_lo, nh, nl)
        wxh, wxl = dd.mul(kh, kl, r.g.x_hi, r.g.x_lo)
        wyh, wyl = dd.mul(kh, kl, r.g.y_hi, r.g.y_lo)
    else:
        lower = _bound(pieces, z, facet, side, slots, found.a_2)
        upper = _bound(pieces, z, facet, side, slots, found.b_2)
        if lower.along_hi <= 0.0 or upper.along_hi >= 0.0:
            return LeastNorm(UNSURE, 0.0, 0.0)
        q = careful_row(lower, upper)
        nh, nl = dd.dot(
            r.g.x_hi, r.g.x_lo, -r.g.y_hi, -r.g.y_lo, q.g.y_hi, q.g.y_lo, q.g.x_hi, q.g.x_lo
        )
        th, tl = dd.dot(r.c_hi, r.c_lo, -q.c_hi, -q.c_lo, q.g.y_hi, q.g.y_lo, r.g.y_hi, r.g.y_lo)
        wxh, wxl = dd.div(th, tl, nh, nl)
        th, tl = dd.dot(q.c_hi, q.c_lo, -r.c_hi, -r.c_lo, r.g.x_hi, r.g.x_lo, q.g.x_hi, q.g.x_lo)
        wyh, wyl = dd.div(th, tl, nh, nl)
    for row in range(found.near):
        at_a, at_b = near[row, 0], near[row, 1]
        if (at_a == found.a and at_b == found.b) or (
            found.rows == 2 and at_a == found.a_2 and at_b == found.b_2
        ):
            continue
        lower = _bound(pieces, z, facet, side, slots, at_a)
        upper = _bound(pieces, z, facet, side, slots, at_b)
        if lower.along_hi <= 0.0 or upper.along_hi >= 0.0:
            return LeastNorm(UNSURE, 0.0, 0.0)
        q = careful_row(lower, upper)
        vh, vl = dd.dot(q.g.x_hi, q.g.x_lo, q.g.y_hi, q.g.y_lo, wxh, wxl, wyh, wyl)
        vh, vl = dd.sub(vh, vl, q.c_hi, q.c_lo)
        if vh < -slack * math.sqrt(q.g.x_hi * q.g.x_hi + q.g.y_hi * q.g.y_hi):
            return LeastNorm(UNSURE, 0.0, 0.0)
    return LeastNorm(FOUND, wxh + wxl, wyh + wyl)
