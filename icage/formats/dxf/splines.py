"""B-splines as Bezier pieces, exactly, whatever their knots are.

The control points of the piece over a knot span [a, b] are values of the span's blossom, its polar
form: f(a, ..., a), f(a, ..., a, b), ..., f(b, ..., b). [Ramshaw1987]
"""

from __future__ import annotations

from typing import Final

import numpy as np

from icage.arrays import FloatArray
from icage.errors import FormatError

MAX_DEGREE: Final = 25
"""CAD programs draw splines up to degree 11; some kernels allow 25."""

MAX_FIT_POINTS: Final = 2_000
"""A spline through more points is solved too slowly."""


def bezier_pieces(degree: int, knots: FloatArray, control: FloatArray) -> list[FloatArray]:
    """Control points (degree + 1, d) of the pieces of a B-spline with control points (n, d).

    Raises
    ------
    FormatError:
        Degree, knots and control points do not go together.

    Examples
    --------
    >>> bezier_pieces(1, np.array([0.0, 0, 1, 2, 2]), np.eye(3))[1].tolist()
    [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    """
    if not 1 <= degree <= MAX_DEGREE:
        raise FormatError(f"degree {degree}; 1 to {MAX_DEGREE} is allowed")
    if len(control) <= degree or len(knots) != len(control) + degree + 1:
        raise FormatError(
            f"{len(control)} control points and {len(knots)} knots, which do not make a spline of "
            f"degree {degree}"
        )
    if not np.isfinite(knots).all() or (np.diff(knots) < 0.0).any():
        raise FormatError("knots that are not finite or not in order")
    # Knots that differ by rounding only are one: a span between them would have no shape.
    scale = float(knots[-1] - knots[0])
    spans = [k for k in range(degree, len(control)) if knots[k + 1] - knots[k] > 1e-12 * scale]
    return [_piece(degree, knots, control, k) for k in spans]


def _piece(degree: int, knots: FloatArray, control: FloatArray, span: int) -> FloatArray:
    a, b = float(knots[span]), float(knots[span + 1])
    return np.array(
        [
            _blossom(degree, knots, control, span, [a] * (degree - ends) + [b] * ends)
            for ends in range(degree + 1)
        ]
    )


def _blossom(
    degree: int, knots: FloatArray, control: FloatArray, span: int, places: list[float]
) -> FloatArray:
    """The recursion of de Boor with another parameter in each round."""
    rows = [control[span - degree + j] for j in range(degree + 1)]
    for level, place in enumerate(places, start=1):
        for j in range(degree, level - 1, -1):
            low, high = knots[j + span - degree], knots[j + 1 + span - level]
            share = (place - low) / (high - low)
            rows[j] = (1.0 - share) * rows[j - 1] + share * rows[j]
    return rows[degree]


def fitted(points: FloatArray, tangents: FloatArray | None) -> tuple[FloatArray, FloatArray]:
    """Knots and control points (n, 3) of the cubic that CAD draws through points (k, 3).

    Raises
    ------
    FormatError:
        Too many points, or two neighbours are the same.
    """
    from ezdxf.math import fit_points_to_cad_cv

    if len(points) > MAX_FIT_POINTS:
        raise FormatError(f"more than {MAX_FIT_POINTS} fit points; write out its control points")
    if (np.diff(points, axis=0) == 0.0).all(axis=1).any():
        raise FormatError("a fit point that is there twice")
    rows = None if tangents is None else [tuple(row) for row in tangents.tolist()]
    spline = fit_points_to_cad_cv([tuple(row) for row in points.tolist()], tangents=rows)
    control = np.array([tuple(point) for point in spline.control_points])
    return np.array(spline.knots()), control
