"""An exact frictionless closing in the plane: sigma falls until it cannot fall any more.

The hand is the four numbers (d, w), finger k at d + w z_k, and every edge of the object is a
convex obstacle. Around the present hand each obstacle is replaced by the half plane that touches
it nearest to the finger: linear in (d, w), and on the safe side, because the distance to a convex
set is convex. A step minimizes ``|w|^2 / 2 + |finger displacements|^2 / (2 eagerness)``
under these half planes, a quadratic program in four unknowns; the straight way to its answer is
free of collisions and |w| falls along it. Point fingers on a convex vertex try both sides. At rest
the Karush-Kuhn-Tucker conditions hold for the true object. Works for discs on the true arcs.

No pieces of the plane, no cells, no offset polygon. Our own; the quadratic program is solved with
the dual method of Goldfarb and Idnani (1983).
"""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np
from numpy.typing import NDArray

from tests.oracles.geometry import Floats, Ring, fingers_of, size_of
from tests.oracles.path_check import depth_of_ways
from tests.oracles.statics import touch

MAX_STEPS = 20_000
TOUCH = 1e-9
"""[diameter] A point finger this close to an edge, on either side, touches it."""
SLIDE = 5e-3
"""[diameter] Step of a slide between parallel edges."""
REACH = 0.08
"""[diameter] No finger moves further in one step."""
AT_REST = 1e-11
"""[diameter] The hand rests when no finger wants to move further than this."""
NO_GAIN = 1e-14
"""[diameter] Nor does it move if w does not change: it slides between parallel edges."""
SLID_OFF = 1e-9
"""[diameter] A slide led on if sigma fell by more than this."""
PINCHED = 1e-7
"""[diameter] Below this sigma the object is out of the hand."""

_MOST_ROWS = 256


class ClosingError(ArithmeticError):
    """The closing neither came to rest nor pinched."""


@dataclass(frozen=True, slots=True)
class Closed:
    """Where a closing ended: configuration (4,), fingers (3, 2), sigma [unit]."""

    q: Floats
    contacts: Floats
    sigma: float
    steps: int
    escaped: bool


def close_hand(
    ring: Ring,
    hand: NDArray[np.complex128],
    q: Floats,
    radius: float = 0.0,
    eagerness: float = 3.0,
) -> Closed:
    """Close a hand of the given shape from the collision-free configuration q = (d, w).

    ``eagerness`` [1] sets how far one step goes for its gain: small values follow the steepest
    descent of sigma, large ones cut corners; any of them may end in another grasp, none may
    leave a basin.

    Raises
    ------
    ClosingError:
        Not at rest after MAX_STEPS, or a collision at the start.
    """
    worst = max(ring.depth(p, radius) for p in fingers_of(q, hand))
    if worst > 1e-9 * ring.diameter:
        raise ClosingError(f"a finger starts {worst:.3g} inside the object")
    end, steps, outcome = _closed(ring, hand, q, radius, eagerness)
    if outcome == 1:
        end, more, outcome = _slid_on(ring, hand, end, radius, eagerness)
        steps += more
    if outcome == 0:
        raise ClosingError(f"not at rest after {steps} steps, sigma {size_of(end)}")
    fingers = fingers_of(end, hand)
    if max(ring.depth(p, radius) for p in fingers) > 10.0 * TOUCH * ring.diameter:
        raise ClosingError("a finger went through an edge")
    return Closed(end, fingers, size_of(end), steps, outcome == 2)


def _closed(
    ring: Ring, hand: NDArray[np.complex128], q: Floats, radius: float, eagerness: float
) -> tuple[Floats, int, int]:
    """End, number of steps and outcome of the compiled closing."""
    size = ring.diameter
    end, steps, outcome = _close(
        ring.starts / size, ring.tangents, ring.lengths / size, ring.normals, ring.concave,
        radius / size, hand.real.copy(), hand.imag.copy(),
        np.asarray(q, dtype=np.float64) / size, eagerness, MAX_STEPS,
    )  # fmt: skip
    return end * size, int(steps), int(outcome)


def _slid_on(
    ring: Ring, hand: NDArray[np.complex128], q: Floats, radius: float, eagerness: float
) -> tuple[Floats, int, int]:
    """Between parallel edges the hand may slide at no cost: where it can close on, it does."""
    fingers = fingers_of(q, hand)
    touches = [touch(ring, p, radius, TOUCH * ring.diameter) for p in fingers]
    normals = [n for t in touches if t is not None for choice in t.choices for n in choice]
    if not normals:
        return q, 0, 1
    tangent = np.array([-normals[0][1], normals[0][0]])
    if any(abs(float(tangent @ n)) > 1e-9 for n in normals):
        return q, 0, 1
    for way in (ring.diameter * tangent, -ring.diameter * tangent):
        gone, step = 0.0, SLIDE
        while gone < 2.0 and step > 1e-6:
            ways = np.stack([fingers + gone * way, fingers + (gone + step) * way], axis=1)
            if depth_of_ways(ring, ways, radius) > TOUCH * ring.diameter:
                step *= 0.5  # up to what blocks it
                continue
            gone += step
            there = q + gone * np.array([way[0], way[1], 0.0, 0.0])
            end, steps, outcome = _closed(ring, hand, there, radius, eagerness)
            if size_of(end) < size_of(q) - SLID_OFF * ring.diameter:
                return end, steps, outcome
    return q, 0, 1


@numba.njit(cache=True)
def _close(start, tangent, length, normal, concave, radius, zr, zi, q0, eagerness, limit):  # type: ignore[no-untyped-def]
    """Steps until rest (outcome 1), pinched (2) or the limit (0). Lengths in diameters."""
    q = q0.copy()
    for step in range(limit):
        if np.hypot(q[2], q[3]) < PINCHED:
            return q, step, 2
        # far from rest small steps follow the slope; near it large ones end the slow tails
        h = eagerness
        p = _best_step(start, tangent, length, normal, concave, radius, zr, zi, q, h)
        move = _longest(p, zr, zi)
        while move < 1e-3 and h < 1e9:
            h *= 30.0
            p = _best_step(start, tangent, length, normal, concave, radius, zr, zi, q, h)
            move = _longest(p, zr, zi)
        if move <= AT_REST or np.hypot(p[2], p[3]) <= NO_GAIN:
            return q, step, 1
        q = q + p * min(1.0, REACH / move)
    return q, limit, 0


@numba.njit(cache=True)
def _longest(p, zr, zi):  # type: ignore[no-untyped-def]
    longest = 0.0
    for k in range(len(zr)):
        x = p[0] + p[2] * zr[k] - p[3] * zi[k]
        y = p[1] + p[2] * zi[k] + p[3] * zr[k]
        longest = max(longest, np.hypot(x, y))
    return longest


@numba.njit(cache=True)
def _best_step(start, tangent, length, normal, concave, radius, zr, zi, q, eagerness):  # type: ignore[no-untyped-def]
    """Step (4,) of least cost over the sides on which fingers may pass convex vertices."""
    n, fingers = len(start), len(zr)
    rows = np.empty((_MOST_ROWS, 5))
    count = 0
    either = np.empty((fingers, 2), dtype=np.int64)
    choosing = 0
    for k in range(fingers):
        x = q[0] + q[2] * zr[k] - q[3] * zi[k]
        y = q[1] + q[2] * zi[k] + q[3] * zr[k]
        for e in range(n):
            rx, ry = x - start[e, 0], y - start[e, 1]
            along = rx * tangent[e, 0] + ry * tangent[e, 1]
            t = min(max(along, 0.0), length[e])
            ux, uy = rx - t * tangent[e, 0], ry - t * tangent[e, 1]
            gap = np.hypot(ux, uy)
            if gap > radius + REACH:
                continue
            if radius > 0.0 or gap > TOUCH:
                _put(rows, count, ux / gap, uy / gap, min(0.0, radius - gap), zr[k], zi[k])
                count += 1
                continue
            after = e + 1 if e + 1 < n else 0
            if length[e] - along <= TOUCH and not concave[after]:
                either[choosing, 0], either[choosing, 1] = k, e
                choosing += 1
            elif not (along <= TOUCH and not concave[e]):
                side = rx * normal[e, 0] + ry * normal[e, 1]
                _put(rows, count, normal[e, 0], normal[e, 1], -side, zr[k], zi[k])
                count += 1
    metric, factor = _metric(zr, zi, eagerness)
    best = np.zeros(4)
    lowest = np.inf
    for choice in range(1 << choosing):
        used = count
        for c in range(choosing):
            k, e = either[c]
            if (choice >> c) & 1:
                e = e + 1 if e + 1 < n else 0
            side = (q[0] + q[2] * zr[k] - q[3] * zi[k] - start[e, 0]) * normal[e, 0]
            side += (q[1] + q[2] * zi[k] + q[3] * zr[k] - start[e, 1]) * normal[e, 1]
            _put(rows, used, normal[e, 0], normal[e, 1], -side, zr[k], zi[k])
            used += 1
        p = _quadratic_program(metric, factor, q, rows[:used])
        cost = p[2] * (q[2] + 0.5 * p[2]) + p[3] * (q[3] + 0.5 * p[3])
        moved = metric @ p
        moved[2] -= p[2]
        moved[3] -= p[3]
        cost += 0.5 * (p @ moved)
        if cost < lowest:
            lowest, best = cost, p
    return best


@numba.njit(cache=True)
def _put(rows, at, nx, ny, bound, zr, zi):  # type: ignore[no-untyped-def]
    """Row ``at``: normal . (displacement of the finger at z) >= bound."""
    rows[at, 0], rows[at, 1] = nx, ny
    rows[at, 2], rows[at, 3] = nx * zr + ny * zi, -nx * zi + ny * zr
    rows[at, 4] = bound


@numba.njit(cache=True)
def _metric(zr, zi, eagerness):  # type: ignore[no-untyped-def]
    """Hessian of the cost, (4, 4), and its inverse Cholesky factor."""
    m = np.zeros((4, 4))
    jac = np.zeros((2, 4))
    for k in range(len(zr)):
        jac[0, 0], jac[0, 2], jac[0, 3] = 1.0, zr[k], -zi[k]
        jac[1, 1], jac[1, 2], jac[1, 3] = 1.0, zi[k], zr[k]
        m += jac.T @ jac / eagerness
    m[2, 2] += 1.0
    m[3, 3] += 1.0
    return m, np.linalg.inv(np.linalg.cholesky(m))


@numba.njit(cache=True)
def _quadratic_program(metric, factor, q, rows):  # type: ignore[no-untyped-def]
    """argmin of w . p_w + p' metric p / 2 under rows[:, :4] p >= rows[:, 4]. [Goldfarb-Idnani]

    Works in y = L' p with metric = L L', where the cost is |y - c|^2 / 2; ``factor`` = L^-1.
    """
    goal = np.array([0.0, 0.0, -q[2], -q[3]])
    y = factor @ goal
    g = np.ascontiguousarray(rows[:, :4]) @ np.ascontiguousarray(factor.T)
    bound = rows[:, 4].copy()
    for i in range(len(g)):
        size = np.sqrt(g[i] @ g[i])
        g[i] /= size
        bound[i] /= size
    active = np.empty(4, dtype=np.int64)
    force = np.zeros(5)
    held = 0
    for _ in range(60 + 4 * len(g)):
        slack = g @ y - bound
        worst, new = -1e-14 * (1.0 + np.abs(y).max()), -1
        for i in range(len(g)):
            taken = False
            for j in range(held):
                taken = taken or active[j] == i
            if slack[i] < worst and not taken:
                worst, new = slack[i], i
        if new < 0:
            break
        gain = 0.0
        while True:
            way, share = _projected(g, active, held, g[new])
            full = way @ way
            partial, leaving = np.inf, -1
            for j in range(held):
                if share[j] > 1e-13 and force[j] / share[j] < partial:
                    partial, leaving = force[j] / share[j], j
            need = np.inf
            if full > 0.0:
                need = -(g[new] @ y - bound[new]) / full
            if need == np.inf and partial == np.inf:
                return np.zeros(4)  # contradictory to rounding: the finger is wedged
            t = min(need, partial)
            if need < np.inf:
                y = y + t * way
            for j in range(held):
                force[j] -= t * share[j]
            gain += t
            if need <= partial:
                if held < 4:
                    active[held], force[held] = new, gain
                    held += 1
                break
            for j in range(leaving, held - 1):
                active[j], force[j] = active[j + 1], force[j + 1]
            held -= 1
    y = _onto_active(g, bound, active, held, y)
    return np.ascontiguousarray(factor.T) @ y


@numba.njit(cache=True)
def _orthonormal(g, active, held):  # type: ignore[no-untyped-def]
    """Rows of Q (held, 4) and R with the active normals = Q' R; orthogonalized twice."""
    base, upper = np.zeros((4, 4)), np.zeros((4, 4))
    for j in range(held):
        rest = g[active[j]].copy()
        for _ in range(2):
            for i in range(j):
                part = base[i] @ rest
                upper[i, j] += part
                rest = rest - part * base[i]
        upper[j, j] = np.sqrt(rest @ rest)
        base[j] = rest / upper[j, j]
    return base, upper


@numba.njit(cache=True)
def _projected(g, active, held, new):  # type: ignore[no-untyped-def]
    """Part of ``new`` across the active normals, and its coordinates along them."""
    base, upper = _orthonormal(g, active, held)
    way = new.copy()
    along = np.zeros(4)
    for _ in range(2):
        for i in range(held):
            part = base[i] @ way
            along[i] += part
            way = way - part * base[i]
    share = np.zeros(4)
    for i in range(held - 1, -1, -1):
        total = along[i]
        for j in range(i + 1, held):
            total -= upper[i, j] * share[j]
        share[i] = total / upper[i, i]
    if way @ way < 1e-24:
        way = np.zeros(4)
    return way, share


@numba.njit(cache=True)
def _onto_active(g, bound, active, held, y):  # type: ignore[no-untyped-def]
    """The nearest point that satisfies the active rows with equality, to the last digits."""
    base, upper = _orthonormal(g, active, held)
    for _ in range(2):
        miss = np.zeros(4)
        for i in range(held):
            miss[i] = bound[active[i]] - g[active[i]] @ y
            for j in range(i):
                miss[i] -= upper[j, i] * miss[j]
            miss[i] /= upper[i, i]
        for i in range(held):
            y = y + miss[i] * base[i]
    return y
