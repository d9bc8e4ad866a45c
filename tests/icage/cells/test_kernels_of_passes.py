"""Least openings on facets: by conditions of optimality."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import linprog, nnls

from icage.cells.kernels.careful import pass_careful
from icage.cells.kernels.facet import (
    ALONG,
    BASE_COLUMNS,
    BOUND,
    ERROR,
    G_X,
    G_Y,
    MAX_BASE,
    ends_on_facet,
    facet_of,
    middles_on_facets,
    rows_of_others,
    segment_of,
)
from icage.cells.kernels.min_norm import (
    FOUND,
)
from icage.cells.kernels.near import Hand, cells_near
from icage.cells.kernels.passes import new_room, pass_fast, pass_value
from tests.icage.cells.setting import Setting
from tests.oracles.geometry import Floats

pytestmark = pytest.mark.usefixtures("plain")


def facets(s: Setting, count: int, spread: float) -> list[tuple[np.ndarray, int, int]]:
    """Cells round the target, with a finger and an edge of its piece."""
    found = []
    hand = s.hand
    while len(found) < count:
        off = spread * s.size * s.rng.normal(size=4)
        cells, _ = cells_near(s.pieces, s.z, Hand(*(np.array(hand) + off)), 0.02 * s.size, 10**6)
        if len(cells) == 0:
            continue
        cell = cells[s.rng.integers(len(cells))]
        i = int(s.rng.integers(3))
        slots = range(s.pieces.ptr[cell[i]], s.pieces.ptr[cell[i] + 1])
        found.append((cell, i, int(s.rng.choice(slots))))
    return found


@pytest.mark.parametrize("seed", range(8))
def test_the_least_opening_on_a_facet_is_held_by_what_it_touches(seed: int) -> None:
    """It is feasible, and w is a sum with weights >= 0 of the rows that are tight."""
    s = Setting(seed, 1.0 if seed % 2 else 30.0)
    room, base = new_room(), np.empty((MAX_BASE, BASE_COLUMNS))
    told = [0, 0]
    for cell, i, slot in facets(s, 30, 0.1):
        facet = facet_of(s.pieces, cell, i, slot)
        assert facet.finger == i
        assert (facet.second, facet.second_piece) == ((i + 1) % 3, cell[(i + 1) % 3])
        assert (facet.third, facet.third_piece) == ((i + 2) % 3, cell[(i + 2) % 3])
        corners = s.corners[cell[i]]
        at = slot - s.pieces.ptr[cell[i]]
        p, q = corners[at], corners[(at + 1) % len(corners)]
        segment = segment_of(s.pieces, facet)
        length = float(np.hypot(*(q - p)))
        assert (segment.x, segment.y) == tuple(p)
        assert segment.length == pytest.approx(length)
        n = rows_of_others(s.pieces, s.z, facet, segment, base)
        # from scratch: all corners of the other pieces' half planes
        way = (q - p) / length
        rows = [[0.0, 0.0, 1.0, 0.0], [0.0, 0.0, -1.0, -length]]
        for other in (facet.second, facet.third):
            u = complex(*(s.z[other] - s.z[i]))
            ring = s.corners[cell[other]]
            for a, b in zip(ring, np.roll(ring, -1, axis=0), strict=True):
                side = b - a
                normal = complex(-side[1], side[0]) / np.hypot(*side)
                g = normal * np.conj(u)
                rows.append([g.real, g.imag, normal.real * way[0] + normal.imag * way[1],
                             normal.real * (a - p)[0] + normal.imag * (a - p)[1]])  # fmt: skip
        own = np.array(rows)
        assert base[:n, [G_X, G_Y, ALONG, BOUND]] == pytest.approx(own[2:], abs=1e-9 * s.size)
        assert (base[:n, ERROR] > 0.0).all()
        assert base[:n, ERROR].max() < 1e-11 * s.size
        free = linprog(np.zeros(3), A_ub=-own[:, :3], b_ub=-own[:, 3], bounds=[(None, None)] * 3)
        cap = s.space.cap
        value, wx, wy = pass_value(s.pieces, s.z, facet, cap, s.space.worst, room)
        told[int(value < np.inf)] += 1
        if value == np.inf:
            assert free.status == 2 or least_at_least(own) > 0.99 * cap
            continue
        assert value == pytest.approx(np.hypot(wx, wy))
        rest = own[:, 3] - own[:, :2] @ [wx, wy]
        h = own[:, 2]
        low = max(r / k for r, k in zip(rest, h, strict=True) if k > 1e-9)
        high = min(r / k for r, k in zip(rest, h, strict=True) if k < -1e-9)
        tiny = 1e-9 * s.size
        assert low <= high + tiny
        assert rest[np.abs(h) <= 1e-9].max(initial=-1.0) <= tiny
        ends = ends_on_facet(s.pieces, s.z, cell, i, slot, wx, wy)
        for tau, x, y in ((low, ends.x_lo, ends.y_lo), (high, ends.x_hi, ends.y_hi)):
            assert (x, y) == pytest.approx(tuple(p + tau * way), abs=1e-6 * s.size)
        middle = middles_on_facets(s.pieces, s.z, cell[None], np.array([i]), np.array([slot]),
                                   np.array([[wx, wy]]))[0]  # fmt: skip
        spot = p + 0.5 * (low + high) * way
        finger = complex(*middle[:2]) + complex(wx, wy) * complex(*s.z[i])
        assert (finger.real, finger.imag) == pytest.approx(tuple(spot), abs=1e-6 * s.size)
        if value < 1e-6 * s.size:
            continue
        # a hand that is too small by rounding stands in the middle of what is left: nothing
        shrunk = ends_on_facet(s.pieces, s.z, cell, i, slot, *(np.array([wx, wy]) * (1.0 - 1e-8)))
        if high - low < 1e-9 * s.size:
            assert (shrunk.x_lo, shrunk.y_lo) == pytest.approx(tuple(spot), abs=1e-5 * s.size)
            assert (shrunk.x_hi, shrunk.y_hi) == pytest.approx(tuple(spot), abs=1e-5 * s.size)
        tau = 0.5 * (low + high)
        tight = own @ [wx, wy, tau, -1.0] < 1e-7 * s.size
        _force, miss = nnls(own[tight][:, :3].T, np.array([wx, wy, 0.0]))
        assert miss <= 1e-6 * value
        below, above = (
            pass_value(s.pieces, s.z, facet, value * (1.0 + off), s.space.worst, room)[0]
            for off in (-1e-7, 1e-7)
        )
        assert below == np.inf
        assert above == pytest.approx(value)
        careful = pass_careful(s.pieces, s.z, facet, cap, 0.0)
        fast = pass_fast(s.pieces, s.z, facet, cap, s.space.worst, room)
        if fast.status == FOUND and careful.status == FOUND:
            assert careful[1:] == pytest.approx(fast[1:], abs=1e-8 * s.size)
    assert room.tally[0] > 30
    assert min(told) > 2


def least_at_least(rows: Floats) -> float:
    """A lower bound of |w| over rows: the most of its components along 24 directions."""
    found = 0.0
    for angle in np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False):
        cost = [np.cos(angle), np.sin(angle), 0.0]
        one = linprog(cost, A_ub=-rows[:, :3], b_ub=-rows[:, 3], bounds=[(None, None)] * 3)
        if one.status == 0:
            found = max(found, float(one.fun))
    return found
