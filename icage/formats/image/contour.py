"""The contour of a blob between its pixels, and without their staircase.

Where edges are grey, a pixel tells how much of it is covered: the contour at half of that lies on
the edge. Where they are hard, each pixel only says on which side its middle lies. Then the contour
is smoothed [Taubin1995], each of its points on its own segment between the two pixels' middles, so
that every pixel stays on its side.
"""

from __future__ import annotations

from typing import Final

import contourpy
import numpy as np
import shapely

from icage.arrays import FloatArray
from icage.errors import FormatError
from icage.formats.image.mask import Blob

_ROUNDS: Final = 200

_SHRINK, _GROW = 0.5, -0.53

_MARGIN: Final = 1e-3
"""[pixel] A point stays so far from the middles of pixels."""

MAX_RINGS: Final = 1_000
"""The contour and its holes."""


def contour(blob: Blob) -> list[FloatArray]:
    """Closed rings (k, 2), the outer one first: column and row in the blob's window.

    Raises
    ------
    FormatError:
        Nothing is enclosed, or too many holes.
    """
    generator = contourpy.contour_generator(z=blob.values, name="serial")
    rings = [np.asarray(line) for line in generator.lines(blob.level) if len(line) > 3]
    if not rings:
        raise FormatError("the object is too small: no contour encloses an area")
    if len(rings) > MAX_RINGS:
        raise FormatError(f"the object has {len(rings)} holes; a cleaner image is needed")
    if blob.hard:
        rings = [_smoothed(ring) for ring in rings]
    sizes = [abs(shapely.Polygon(ring).area) for ring in rings]
    return [rings[k] for k in np.argsort(sizes)[::-1]]


def _smoothed(ring: FloatArray) -> FloatArray:
    """The ring (closed, its first point again at the end) without its staircase."""
    points = ring[:-1].copy()
    # A point lies between two pixels: on one axis at a pixel's middle, free on the other.
    off = np.abs(points - np.round(points))
    free = off.argmax(axis=1)
    rows = np.arange(len(points))
    low = np.floor(points[rows, free]) + _MARGIN
    high = low + 1.0 - 2.0 * _MARGIN
    for turn in range(_ROUNDS):
        middle = (np.roll(points, 1, axis=0) + np.roll(points, -1, axis=0)) / 2.0
        step = (_SHRINK if turn % 2 == 0 else _GROW) * (middle - points)
        points[rows, free] = np.clip(points[rows, free] + step[rows, free], low, high)
    return np.vstack([points, points[:1]])
