"""The largest sigma in a component that never escapes. Our own.

sigma is convex on a cell, so its maximum is at an extreme point: two fingers at corners of their
pieces, or one at a corner and the others on edges.
"""

from __future__ import annotations

import numpy as np

from icage.arrays import BoolArray, ComplexArray, FloatArray
from icage.cells.free_space import Search
from icage.geometry.exterior import Pieces

_INSIDE = 1e-9
"""[diameter] A point this far outside a piece is in it: the rounding of w, divided by the sine of
the angle between two edges."""


def largest_sigma_in(found: Search) -> float:
    """Largest |w| over all visited cells, [unit]."""
    pieces, z = found.free_space.pieces, found.free_space.hand.z
    return max(_largest_in_cell(pieces, z, [int(v) for v in row]) for row in found.cells)


def opens_to(found: Search, level: float) -> bool:
    """Whether a visited cell holds a hand as wide as ``level``, [unit]."""
    pieces, z = found.free_space.pieces, found.free_space.hand.z
    return any(
        _largest_in_cell(pieces, z, [int(v) for v in row[:3]]) >= level for row in found.nodes
    )


def _corners(pieces: Pieces, k: int) -> ComplexArray:
    v = pieces.slot_vertex[pieces.ptr[k] : pieces.ptr[k + 1]]
    return pieces.x[v] + 1j * pieces.y[v]


def _holds(pieces: Pieces, k: int, points: ComplexArray) -> BoolArray:
    s = slice(int(pieces.ptr[k]), int(pieces.ptr[k + 1]))
    v = pieces.slot_vertex[s]
    gap: FloatArray = pieces.normal_x[s][:, None] * (
        points.real - pieces.x[v][:, None]
    ) + pieces.normal_y[s][:, None] * (points.imag - pieces.y[v][:, None])
    return np.logical_and.reduce(gap >= -_INSIDE * pieces.diameter, axis=0)


def _largest_in_cell(pieces: Pieces, z: ComplexArray, cell: list[int]) -> float:
    best = 0.0
    fingers = len(z)
    for i in range(fingers):
        j, k = (i + 1) % fingers, (i + 2) % fingers
        a, b, c = (_corners(pieces, cell[f]) for f in (i, j, k))
        # fingers i and j at corners
        w = ((b[None, :] - a[:, None]) / (z[j] - z[i])).ravel()
        third = np.repeat(a, len(b)) + w * (z[k] - z[i])
        ok = _holds(pieces, cell[k], third)
        best = max(best, float(np.abs(w[ok]).max(initial=0.0)))
        # finger i at a corner, j and k on edges: n . (a + w u - corner) = 0 twice
        for at in a:
            w = _on_two_edges(at, b, z[j] - z[i], c, z[k] - z[i])
            ok = _holds(pieces, cell[j], at + w * (z[j] - z[i]))
            ok &= _holds(pieces, cell[k], at + w * (z[k] - z[i]))
            best = max(best, float(np.abs(w[ok]).max(initial=0.0)))
    return best


def _on_two_edges(
    at: complex, b: ComplexArray, u: complex, c: ComplexArray, v: complex
) -> ComplexArray:
    """All w that put finger j on an edge line of ring b and finger k on one of ring c."""
    n_b, n_c = 1j * (np.roll(b, -1) - b), 1j * (np.roll(c, -1) - c)
    g_b, g_c = np.conj(u) * n_b, np.conj(v) * n_c
    r_b, r_c = (np.conj(n_b) * (b - at)).real, (np.conj(n_c) * (c - at)).real
    det = g_b.real[:, None] * g_c.imag - g_b.imag[:, None] * g_c.real
    with np.errstate(divide="ignore", invalid="ignore"):
        x = (r_b[:, None] * g_c.imag - g_b.imag[:, None] * r_c) / det
        y = (g_b.real[:, None] * r_c - r_b[:, None] * g_c.real) / det
        w = (x + 1j * y).ravel()
    return w[np.isfinite(w)]
