"""Double-double arithmetic: a number is an unevaluated sum hi + lo, about 106 bits.

Slivers (fine arcs of disc fingers make triangles with angles of 1e-5 and less) turn a rounding
error of one unit in the last place into 1e-10 of the diameter and more. Differences of two
doubles and products of two doubles are exact here, so the kernels that use it answer for the
polygon as it is given, and not for one that lies a rounding error away. [Dekker1971] [Hida2001]
"""

from __future__ import annotations

from icage.kernels.compiled import compiled

_SPLIT = 134217729.0  # 2^27 + 1


@compiled
def two_sum(a: float, b: float) -> tuple[float, float]:
    """A + b exactly."""
    s = a + b
    t = s - a
    return s, (a - (s - t)) + (b - t)


@compiled
def two_product(a: float, b: float) -> tuple[float, float]:
    """A * b exactly."""
    p = a * b
    t = _SPLIT * a
    a_hi = t - (t - a)
    a_lo = a - a_hi
    t = _SPLIT * b
    b_hi = t - (t - b)
    b_lo = b - b_hi
    return p, ((a_hi * b_hi - p) + a_hi * b_lo + a_lo * b_hi) + a_lo * b_lo


@compiled
def add(ah: float, al: float, bh: float, bl: float) -> tuple[float, float]:
    """A + b, relative error 2^-104 also under cancellation."""
    s, e = two_sum(ah, bh)
    t, f = two_sum(al, bl)
    e += t
    h = s + e
    e = e - (h - s)
    e += f
    hi = h + e
    return hi, e - (hi - h)


@compiled
def sub(ah: float, al: float, bh: float, bl: float) -> tuple[float, float]:
    """A - b."""
    return add(ah, al, -bh, -bl)


@compiled
def mul(ah: float, al: float, bh: float, bl: float) -> tuple[float, float]:
    """A * b."""
    p, e = two_product(ah, bh)
    e += ah * bl + al * bh
    hi = p + e
    return hi, e - (hi - p)


@compiled
def scale(ah: float, al: float, b: float) -> tuple[float, float]:
    """A * b for a double b."""
    p, e = two_product(ah, b)
    e += al * b
    hi = p + e
    return hi, e - (hi - p)


@compiled
def div(ah: float, al: float, bh: float, bl: float) -> tuple[float, float]:
    """A / b by three steps of long division."""
    q1 = ah / bh
    ph, pl = scale(bh, bl, q1)
    rh, rl = sub(ah, al, ph, pl)
    q2 = rh / bh
    ph, pl = scale(bh, bl, q2)
    rh, rl = sub(rh, rl, ph, pl)
    q3 = rh / bh
    s, e = two_sum(q1, q2)
    e += q3
    hi = s + e
    return hi, e - (hi - s)


@compiled
def dot(
    axh: float, axl: float, ayh: float, ayl: float, bxh: float, bxl: float, byh: float, byl: float
) -> tuple[float, float]:
    """a_x b_x + a_y b_y."""
    ph, pl = mul(axh, axl, bxh, bxl)
    qh, ql = mul(ayh, ayl, byh, byl)
    return add(ph, pl, qh, ql)
