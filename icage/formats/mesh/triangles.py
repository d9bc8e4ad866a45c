"""The triangles of a mesh, checked once, whichever file they came from."""

from __future__ import annotations

from typing import Final

import numpy as np

from icage.arrays import FloatArray, IntArray
from icage.errors import FormatError
from icage.outline import LARGEST_COORDINATE

MAX_TRIANGLES: Final = 1_000_000
"""Of a mesh."""


def corners(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """(n, 3, 3) = the corners of triangles by the numbers of their vertices.

    Raises
    ------
    FormatError:
        There are none, too many, a vertex that is not there, or coordinates out of range.
    """
    if len(faces) and not 0 <= int(faces.min()) <= int(faces.max()) < len(vertices):
        raise FormatError(
            f"a face has a vertex that is not there; the mesh has {len(vertices)} vertices"
        )
    return checked(vertices[faces])


def checked(triangles: FloatArray) -> FloatArray:
    """The triangles (n, 3, 3) as they are.

    Raises
    ------
    FormatError:
        As ``corners``.
    """
    if not len(triangles):
        raise FormatError("the mesh has no triangles")
    check_count(len(triangles))
    if not np.isfinite(triangles).all() or np.abs(triangles).max() > LARGEST_COORDINATE:
        raise FormatError(
            f"the mesh has coordinates that are not finite or beyond {LARGEST_COORDINATE:g}"
        )
    return triangles


def check_count(count: int) -> None:
    """Refuse more than ``MAX_TRIANGLES``."""
    if count > MAX_TRIANGLES:
        raise FormatError(
            f"the mesh has {count} triangles, at most {MAX_TRIANGLES} are allowed; simplify it"
        )


def fans(counts: IntArray, numbers: IntArray) -> IntArray:
    """(n, 3) = polygons as fans of triangles: ``counts`` (k,) corners each, listed one by one.

    >>> fans(np.array([4, 3]), np.array([0, 1, 2, 3, 7, 8, 9])).tolist()
    [[0, 1, 2], [0, 2, 3], [7, 8, 9]]
    """
    if not len(counts):
        return np.zeros((0, 3), dtype=np.int64)
    starts = np.concatenate([[0], np.cumsum(counts)[:-1]]).astype(np.int64)
    triangles = np.maximum(counts - 2, 0)
    check_count(int(triangles.sum()))
    first = np.repeat(starts, triangles)
    ends = np.repeat(np.cumsum(triangles) - triangles, triangles)
    step = np.arange(int(triangles.sum())) - ends
    return np.column_stack([numbers[first], numbers[first + step + 1], numbers[first + step + 2]])
