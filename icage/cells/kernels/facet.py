"""The pass value: least sigma with one finger on a segment and the others in convex pieces.

Finger i stands at P + tau e on the segment, the others at that point plus w (z_j - z_i), each in
its convex piece. Every constraint is linear in (tau, w); pairing the lower and the upper bounds on
tau (Fourier-Motzkin) leaves half planes for w alone, and the pass value is the least |w| in them.
Our own. [docs/theory.md, Sec. 3.3]

The doubles go first; wherever rounding could move the value by more than ``worst`` the answer is
computed again in double-double arithmetic from the same vertices.
"""

# pyright: basic
from __future__ import annotations

import math

import numpy as np

from icage.cells.kernels.min_norm import FOUND, INFEASIBLE, UNSURE, min_norm, min_norm_careful
from icage.kernels import double_double as dd
from icage.kernels.compiled import compiled

MAX_EDGES = 12
"""Most edges of a merged piece: bounds the number of rows below."""

MAX_BASE = 2 * MAX_EDGES + 2
MAX_ROWS = (MAX_EDGES + 2) * (MAX_EDGES + 2) + MAX_BASE
_EPS = 2.220446049250313e-16

CLEARANCE = 2e-14
"""[diameter] Touching is free: a facet that is empty by no more than this counts as open, so that
the rounding of a turned drawing cannot close a passage of no width."""


@compiled
def _base_rows(pieces, z, finger, piece, i, px, py, ex, ey, base, count):
    """Append the half planes of one finger's piece: (g_x, g_y, h, c, error) of g.w + h tau >= c."""
    vx, vy, ptr, slot_vertex = pieces.x, pieces.y, pieces.ptr, pieces.slot_vertex
    ux = z[finger, 0] - z[i, 0]
    uy = z[finger, 1] - z[i, 1]
    size = abs(ux) + abs(uy)
    for s in range(ptr[piece], ptr[piece + 1]):
        nx = pieces.normal_x[s]
        ny = pieces.normal_y[s]
        a = slot_vertex[s]
        dx = vx[a] - px
        dy = vy[a] - py
        base[count, 0] = ux * nx + uy * ny
        base[count, 1] = ux * ny - uy * nx
        base[count, 2] = nx * ex + ny * ey
        base[count, 3] = nx * dx + ny * dy
        base[count, 4] = CLEARANCE * pieces.scale + 4.0 * _EPS * (
            abs(dx) + abs(dy) + pieces.scale * size
        )
        count += 1
    return count


@compiled
def pass_fast(pieces, z, i, p, q, j, piece_j, k, piece_k, cap, worst, base, rows):
    """(status, w_x, w_y) in doubles; ``cap`` is the largest sigma of interest."""
    px = pieces.x[p]
    py = pieces.y[p]
    ex = pieces.x[q] - px
    ey = pieces.y[q] - py
    length = math.hypot(ex, ey)
    ex /= length
    ey /= length
    n = _base_rows(pieces, z, j, piece_j, i, px, py, ex, ey, base, 0)
    n = _base_rows(pieces, z, k, piece_k, i, px, py, ex, ey, base, n)
    base[n, 0], base[n, 1], base[n, 2], base[n, 3], base[n, 4] = 0.0, 0.0, 1.0, 0.0, 0.0
    n += 1
    base[n, 0], base[n, 1], base[n, 2], base[n, 3] = 0.0, 0.0, -1.0, -length
    base[n, 4] = 2.0 * _EPS * length
    n += 1
    count = 0
    for a in range(n):
        ha = base[a, 2]
        if ha == 0.0:
            count, status = _put(
                base[a, 0], base[a, 1], base[a, 3], base[a, 4], 1.0, cap, rows, count
            )
            if status != FOUND:
                return status, 0.0, 0.0
        elif ha > 0.0:
            for b in range(n):
                hb = base[b, 2]
                if hb < 0.0:
                    gx = ha * base[b, 0] - hb * base[a, 0]
                    gy = ha * base[b, 1] - hb * base[a, 1]
                    c = ha * base[b, 3] - hb * base[a, 3]
                    err = ha * base[b, 4] - hb * base[a, 4]
                    count, status = _put(gx, gy, c, err, ha - hb, cap, rows, count)
                    if status != FOUND:
                        return status, 0.0, 0.0
    return min_norm(rows, count, worst)


@compiled
def _put(gx, gy, c, err, weight, cap, rows, count):
    """Store one row scaled to |g| = 1, unless it holds for every |w| <= cap or for none."""
    norm = math.hypot(gx, gy)
    reach = norm * cap
    if c + err + reach < 0.0:
        return count, FOUND
    if c - err - reach > 0.0:
        return count, INFEASIBLE
    if norm < 1e-11 * weight:
        if c <= err + reach and c >= -err - reach:
            return count, UNSURE
        return count, FOUND
    rows[count, 0] = gx / norm
    rows[count, 1] = gy / norm
    rows[count, 2] = c / norm
    rows[count, 3] = err / norm
    return count + 1, FOUND


@compiled
def _careful_rows(pieces, z, finger, piece, i, p, eh_x, el_x, eh_y, el_y, base, count):
    vx, vy, ptr, slot_vertex = pieces.x, pieces.y, pieces.ptr, pieces.slot_vertex
    uxh, uxl = dd.two_sum(z[finger, 0], -z[i, 0])
    uyh, uyl = dd.two_sum(z[finger, 1], -z[i, 1])
    for s in range(ptr[piece], ptr[piece + 1]):
        a = slot_vertex[s]
        b = slot_vertex[s + 1 if s + 1 < ptr[piece + 1] else ptr[piece]]
        # inward normal of a counterclockwise piece: the edge turned left by a right angle
        nxh, nxl = dd.two_sum(vy[a], -vy[b])
        nyh, nyl = dd.two_sum(vx[b], -vx[a])
        inv = 1.0 / math.hypot(nxh, nyh)
        nxh, nxl = dd.scale(nxh, nxl, inv)
        nyh, nyl = dd.scale(nyh, nyl, inv)
        base[count, 0], base[count, 1] = dd.dot(uxh, uxl, uyh, uyl, nxh, nxl, nyh, nyl)
        base[count, 2], base[count, 3] = dd.dot(uxh, uxl, -uyh, -uyl, nyh, nyl, nxh, nxl)
        base[count, 4], base[count, 5] = dd.dot(nxh, nxl, nyh, nyl, eh_x, el_x, eh_y, el_y)
        dxh, dxl = dd.two_sum(vx[a], -vx[p])
        dyh, dyl = dd.two_sum(vy[a], -vy[p])
        base[count, 6], base[count, 7] = dd.dot(nxh, nxl, nyh, nyl, dxh, dxl, dyh, dyl)
        count += 1
    return count


@compiled
def pass_careful(pieces, z, i, p, q, j, piece_j, k, piece_k, cap, give):
    """(status, w_x, w_y) in double-double; here tau runs over [0, 1].

    ``give`` moves every edge of the pieces outward.
    """
    base = np.empty((MAX_BASE, 8))
    rows = np.empty((MAX_ROWS, 6))
    slack = 1e-24 * pieces.scale
    eh_x, el_x = dd.two_sum(pieces.x[q], -pieces.x[p])
    eh_y, el_y = dd.two_sum(pieces.y[q], -pieces.y[p])
    n = _careful_rows(pieces, z, j, piece_j, i, p, eh_x, el_x, eh_y, el_y, base, 0)
    n = _careful_rows(pieces, z, k, piece_k, i, p, eh_x, el_x, eh_y, el_y, base, n)
    for a in range(n):
        base[a, 6], base[a, 7] = dd.sub(base[a, 6], base[a, 7], give, 0.0)
    base[n, :] = 0.0
    base[n, 4] = pieces.scale
    n += 1
    base[n, :] = 0.0
    base[n, 4] = -pieces.scale
    base[n, 6] = -pieces.scale
    n += 1
    count = 0
    for a in range(n):
        ha = base[a, 4]
        if ha == 0.0:
            count, feasible = _careful_put(
                base[a, 0],
                base[a, 1],
                base[a, 2],
                base[a, 3],
                base[a, 6],
                base[a, 7],
                1.0,
                cap,
                slack,
                rows,
                count,
            )
            if not feasible:
                return INFEASIBLE, 0.0, 0.0
        elif ha > 0.0:
            for b in range(n):
                hb = base[b, 4]
                if hb < 0.0:
                    # over the larger weight, so that no row is scaled up from nothing
                    inv = 1.0 / max(ha, -hb)
                    mah, mal = dd.scale(ha, base[a, 5], inv)
                    mbh, mbl = dd.scale(-hb, -base[b, 5], inv)
                    th, tl = dd.mul(mah, mal, base[b, 0], base[b, 1])
                    sh, sl = dd.mul(mbh, mbl, base[a, 0], base[a, 1])
                    gxh, gxl = dd.add(th, tl, sh, sl)
                    th, tl = dd.mul(mah, mal, base[b, 2], base[b, 3])
                    sh, sl = dd.mul(mbh, mbl, base[a, 2], base[a, 3])
                    gyh, gyl = dd.add(th, tl, sh, sl)
                    th, tl = dd.mul(mah, mal, base[b, 6], base[b, 7])
                    sh, sl = dd.mul(mbh, mbl, base[a, 6], base[a, 7])
                    ch, cl = dd.add(th, tl, sh, sl)
                    count, feasible = _careful_put(
                        gxh, gxl, gyh, gyl, ch, cl, 1.0, cap, slack, rows, count
                    )
                    if not feasible:
                        return INFEASIBLE, 0.0, 0.0
    return min_norm_careful(rows, count, slack)


@compiled
def _careful_put(gxh, gxl, gyh, gyl, ch, cl, weight, cap, slack, rows, count):
    norm = math.hypot(gxh, gyh)
    if ch + norm * cap < -slack:
        return count, True
    if ch - norm * cap > slack:
        return count, False
    if norm < 1e-27 * weight:
        return count, True
    inv = 1.0 / norm
    rows[count, 0], rows[count, 1] = dd.scale(gxh, gxl, inv)
    rows[count, 2], rows[count, 3] = dd.scale(gyh, gyl, inv)
    rows[count, 4], rows[count, 5] = dd.scale(ch, cl, inv)
    return count + 1, True


@compiled
def pass_value(pieces, z, i, p, q, j, piece_j, k, piece_k, cap, worst, base, rows, tally):
    """Least sigma with finger i on segment (p, q) and fingers j, k in their pieces.

    Returns (sigma, w_x, w_y); sigma = inf where there is none below ``cap``. ``tally`` counts
    [all calls, careful calls].
    """
    tally[0] += 1
    status, wx, wy = pass_fast(pieces, z, i, p, q, j, piece_j, k, piece_k, cap, worst, base, rows)
    if status == UNSURE:
        tally[1] += 1
        status, wx, wy = pass_careful(pieces, z, i, p, q, j, piece_j, k, piece_k, cap, 0.0)
        # as little as will do: in a sliver what is given comes back a thousandfold in sigma
        give = 1e-3 * CLEARANCE * pieces.scale
        while status == INFEASIBLE and give <= 1.01 * CLEARANCE * pieces.scale:
            status, wx, wy = pass_careful(pieces, z, i, p, q, j, piece_j, k, piece_k, cap, give)
            give *= 10.0
    if status == INFEASIBLE:
        return np.inf, 0.0, 0.0
    sigma = math.hypot(wx, wy)
    if sigma > cap:
        return np.inf, 0.0, 0.0
    return sigma, wx, wy


@compiled
def finger_on_segment(pieces, z, i, p, q, j, piece_j, k, piece_k, wx, wy, base):
    """Range of finger i along the segment for a given w: (x_lo, y_lo, x_hi, y_hi)."""
    px = pieces.x[p]
    py = pieces.y[p]
    ex = pieces.x[q] - px
    ey = pieces.y[q] - py
    length = math.hypot(ex, ey)
    ex /= length
    ey /= length
    n = _base_rows(pieces, z, j, piece_j, i, px, py, ex, ey, base, 0)
    n = _base_rows(pieces, z, k, piece_k, i, px, py, ex, ey, base, n)
    lo = 0.0
    hi = length
    for a in range(n):
        rest = base[a, 3] - base[a, 0] * wx - base[a, 1] * wy
        h = base[a, 2]
        # give every bound its own rounding error: one from a nearly parallel edge is good to
        # little along the segment, and must not push a finger through an edge that is not
        doubt = 4.0 * base[a, 4]
        if abs(h) * length < 4.0 * doubt:
            continue
        if h > 0.0:
            lo = max(lo, min((rest - doubt) / h, length))
        elif h < 0.0:
            hi = min(hi, max((rest - doubt) / h, 0.0))
    if lo > hi:
        lo = 0.5 * (lo + hi)
        hi = lo
    return px + lo * ex, py + lo * ey, px + hi * ex, py + hi * ey
