"""Affine maps (a, b, c, d, e, f) of SVG: x' = a x + c y + e, y' = b x + d y + f."""

from __future__ import annotations

import math
from typing import Final, TypeAlias

import numpy as np

from icage.arrays import FloatArray
from icage.errors import FormatError
from icage.formats.drawings.curves import Bezier, Curve, EllipseArc

Matrix: TypeAlias = tuple[float, float, float, float, float, float]

IDENTITY: Final[Matrix] = (1.0, 0.0, 0.0, 1.0, 0.0, 0.0)

_SIMILAR: Final = 1e-9


def product(first: Matrix, second: Matrix) -> Matrix:
    """The map that applies ``second``, then ``first``.

    >>> product((2, 0, 0, 2, 0, 0), (1, 0, 0, 1, 3, 4))
    (2, 0, 0, 2, 6, 8)
    """
    a, b, c, d, e, f = first
    p, q, r, s, t, u = second
    return (
        a * p + c * q, b * p + d * q, a * r + c * s, b * r + d * s, a * t + c * u + e,
        b * t + d * u + f,
    )  # fmt: skip


def translation(x: float, y: float) -> Matrix:
    """Moved by (x, y)."""
    return (1.0, 0.0, 0.0, 1.0, x, y)


def placed(curve: Curve, matrix: Matrix) -> Curve:
    """The curve's image, a curve of the same kind.

    Raises
    ------
    FormatError:
        Numbers that are not finite.
    """
    with np.errstate(all="ignore"):
        linear = np.array([[matrix[0], matrix[1]], [matrix[2], matrix[3]]], dtype=np.float64)
        shift = np.array([matrix[4], matrix[5]], dtype=np.float64)
        if isinstance(curve, EllipseArc):
            centre, a, b = curve.centre @ linear + shift, curve.a @ linear, curve.b @ linear
            _check_finite(np.stack([centre, a, b]))
            return EllipseArc(centre, a, b, curve.start, curve.sweep)
        if not isinstance(curve, Bezier):
            raise TypeError(f"a {type(curve).__name__} is no curve of SVG")
        control = curve.control @ linear + shift
        _check_finite(control)
        return Bezier(control)


def _check_finite(numbers: FloatArray) -> None:
    if not np.isfinite(numbers).all():
        raise FormatError("the drawing has coordinates that are not finite")


def similarity_scale(matrix: Matrix) -> float | None:
    """By how much all lengths grow; None if some grow more than others."""
    a, b, c, d = matrix[:4]
    first, second = math.hypot(a, b), math.hypot(c, d)
    size = max(first, second)
    if abs(first - second) > _SIMILAR * size or abs(a * c + b * d) > _SIMILAR * size**2:
        return None
    return math.sqrt(first * second)
