"""Jams of disc fingers by brute force, on the true curve: lines and circles, no polygon for arcs.

Nothing is shared with icage.friction. A contact is a finger's centre p and a point q of the object
at the radius from it; the force acts at q, the motor at p. Hands with two contacts come from pairs
of sampled contacts, hands with three from a sampled one and two elements of the curve, which leave
a few hands for each. Balance is the basic solutions of a small linear program, all of them.
"""

from __future__ import annotations

import math
from itertools import combinations
from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.optimize import linprog

from tests.oracles.balance import squeezing
from tests.oracles.geometry import Floats, Ring
from tests.oracles.targets import offset_corners

Complex = NDArray[np.complex128]

SLACK = 1e-9
"""[1] Residual of balance, and of the bounds of an element."""


class Contacts(NamedTuple):
    """Centres (n,) of fingers; where each touches and in which direction it pushes, (n, 2).

    Both columns are alike where it touches one element only.
    """

    p: Complex
    q: Complex
    n: Complex

    @property
    def single(self) -> NDArray[np.bool_]:
        """Which touch one element."""
        return self.q[:, 0] == self.q[:, 1]


class Curve(NamedTuple):
    """The boundary of the grown object: edges moved out, arcs round convex vertices, corners."""

    ring: Ring
    radius: float
    start: Complex
    side: Complex
    out: Complex
    centre: Complex
    begin: Floats
    turn: Floats
    corner: Complex

    @classmethod
    def of(cls, ring: Ring, radius: float) -> Curve:
        """Grow a polygon; what other parts of it cover is kept, and told apart by distances."""
        out = _complex(ring.normals)
        convex = np.flatnonzero(~ring.concave)
        before, after = out[convex - 1], out[convex]
        return cls(
            ring, radius, _complex(ring.starts) + radius * out, _complex(ring.ends - ring.starts),
            out, _complex(ring.vertices)[convex], np.angle(before), np.angle(after / before),
            _complex(offset_corners(ring, radius)),
        )  # fmt: skip

    def distance(self, p: Complex) -> Floats:
        """How far points are from the curve, inwards or outwards."""
        point = shapely.points(p.real, p.imag)
        gap = np.asarray(shapely.distance(point, self.ring.polygon))
        return np.abs(gap - self.radius)

    def on(self, p: Complex) -> NDArray[np.bool_]:
        """Whether points are on the curve."""
        return self.distance(p) <= 1e-10 * self.ring.diameter

    def contacts(self, count: int, around: Floats) -> Contacts:
        """``count`` contacts an edge and an arc, and all corners.

        ``around`` (k, 2): places round which contacts lie ever closer together.
        """
        p, q, n = list[Complex](), list[Complex](), list[Complex]()
        finer = np.concatenate([way * 0.6 ** np.arange(50.0) for way in (-1.0, 1.0)]) / count
        finer = np.append(finer, 0.0)
        near = [point for point in _complex(around) if self.distance(np.array([point]))[0] < 1e-6]
        for start, side, out in zip(self.start, self.side, self.out, strict=True):
            at = [float(((z - start) / side).real) for z in near]
            t = np.concatenate([np.linspace(0.0, 1.0, count), *(a + finer for a in at)])
            t = t[(t >= 0.0) & (t <= 1.0)]
            p.append(start + t * side)
            q.append(p[-1] - self.radius * out)
            n.append(np.full(len(t), -out))
        for centre, begin, turn in zip(self.centre, self.begin, self.turn, strict=True):
            at = [float(np.angle((z - centre) * np.exp(-1j * begin))) for z in near]
            a = np.concatenate([np.linspace(0.0, turn, count), *(a + finer for a in at)])
            a = a[(a >= 0.0) & (a <= turn)]
            way = np.exp(1j * (begin + a))
            p.append(centre + self.radius * way)
            q.append(np.full(len(a), centre))
            n.append(-way)
        flat = np.concatenate(p)
        single = Contacts(
            flat, np.stack([np.concatenate(q)] * 2, 1), np.stack([np.concatenate(n)] * 2, 1)
        )
        keep = self.on(flat)
        touched = [self.touched(z) for z in self.corner]
        both = np.array([t[:2] for t in touched if len(t) >= 2], dtype=complex).reshape(-1, 2)
        at = np.array(
            [z for z, t in zip(self.corner, touched, strict=True) if len(t) >= 2], complex
        )
        return Contacts(
            np.concatenate([flat[keep], at]),
            np.concatenate([single.q[keep], both]),
            np.concatenate([single.n[keep], (both - at[:, None]) / self.radius]),
        )

    def touched(self, p: complex, off: float = 1e-9) -> list[complex]:
        """Points of the object at the radius from a centre, ``off`` [diameter] or less further."""
        feet, gap = self.ring.nearest_on_edges(np.array([p.real, p.imag]))
        found: list[complex] = []
        for z in _complex(feet[gap <= self.radius + off * self.ring.diameter]):
            if all(abs(z - other) > 1e-6 * self.radius for other in found):
                found.append(complex(z))
        return found


def two_finger_jams(
    curve: Curve, hand: Floats, every: Contacts, phi: float, below: float
) -> Floats:
    """Hands (k, 3, 2) smaller than a level, two contacts of which carry forces."""
    z = _complex(hand)
    found: list[Floats] = []
    use = np.flatnonzero(every.single)
    q, n = every.q[use, 0], every.n[use, 0]
    gap = q[None, :] - q[:, None]
    with np.errstate(invalid="ignore", divide="ignore"):
        pushes = np.abs(np.angle(gap / n[:, None])) <= phi + SLACK
        resists = np.abs(np.angle(-gap / n[None])) <= phi + SLACK
    first, second = np.nonzero(pushes & resists & (np.abs(gap) > 0.0))
    pairs = [np.column_stack([use[first], use[second]])]
    for k in np.flatnonzero(~every.single).tolist():
        other = np.delete(np.arange(len(every.p)), k)
        both = np.column_stack([np.full(len(other), k), other])
        pairs.append(both[squeezes(every, both, phi, curve.ring.diameter)])
    pair = np.concatenate(pairs)
    for i, j in combinations(range(3), 2):
        for a, b in ((i, j), (j, i)):
            w = (every.p[pair[:, 1]] - every.p[pair[:, 0]]) / (z[b] - z[a])
            f = (every.p[pair[:, 0]] - w * z[a])[:, None] + w[:, None] * z
            f = f[np.abs(w) < below]
            found.append(np.stack([f.real, f.imag], axis=2))
    return np.concatenate(found)


def three_finger_jams(
    curve: Curve, hand: Floats, every: Contacts, phi: float, below: float
) -> Floats:
    """Hands (k, 3, 2): a finger on a sampled contact, the others wherever they reach elements."""
    z = _complex(hand)
    found: list[Floats] = []
    for a, b, c in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        on, fb, fc, q_b, q_c = _all_met(curve, z, (a, b, c), every, below)
        for one in (True, False):  # those on a corner, which pushes in more directions, apart
            rows = np.flatnonzero(every.single[on] == one)
            jam = rows[_three_squeeze(curve, every, on, fb, fc, q_b, q_c, rows, phi)]
            f = np.empty((len(jam), 3), dtype=np.complex128)
            f[:, a], f[:, b], f[:, c] = every.p[on[jam]], fb[jam], fc[jam]
            found.append(np.stack([f.real, f.imag], axis=2))
    return np.concatenate(found)


def _all_met(
    curve: Curve, z: Complex, order: tuple[int, int, int], every: Contacts, below: float
) -> tuple[NDArray[np.int64], Complex, Complex, Complex, Complex]:
    """Hands (k) with finger a on a sampled contact, whose number comes first, and b and c on an
    element each; then b and c, and where they touch.
    """
    a, b, c = order
    ratio = (z[c] - z[a]) / (z[b] - z[a])
    shift = every.p * (1.0 - ratio)
    elements = len(curve.start) + len(curve.centre)
    none = np.empty(0, dtype=np.complex128)
    met = [(np.empty(0, dtype=np.int64), none, none, none, none)]
    for e in range(elements):
        for g in range(elements):
            for fc in _met(curve, e, g, ratio, shift):
                fb = (fc - shift) / ratio
                sigma = np.abs((fb - every.p) / (z[b] - z[a]))
                on = np.flatnonzero(np.isfinite(fc) & (sigma < below) & (sigma > 0.0))
                if not len(on):
                    continue
                fb, fc = fb[on], fc[on]
                q_b, q_c = _foot(curve, e, fb), _foot(curve, g, fc)
                good = np.isfinite(q_b) & np.isfinite(q_c)
                if good.any():
                    met.append((on[good], fb[good], fc[good], q_b[good], q_c[good]))
    on, fb, fc, q_b, q_c = (np.concatenate(columns) for columns in zip(*met, strict=True))
    good = curve.on(fb)  # asked of all at once
    good[good] = curve.on(fc[good])
    return on[good], fb[good], fc[good], q_b[good], q_c[good]


def _three_squeeze(
    curve: Curve, every: Contacts, on: NDArray[np.int64], fb: Complex, fc: Complex,
    q_b: Complex, q_c: Complex, rows: NDArray[np.int64], phi: float,
) -> NDArray[np.bool_]:  # fmt: skip
    """Which of these rows of hands squeeze in balance."""
    if not len(rows):
        return np.zeros(0, dtype=np.bool_)
    on, fb, fc = on[rows], fb[rows], fc[rows]
    b_q, c_q = (np.stack([q[rows]] * 2, 1) for q in (q_b, q_c))
    all_three = Contacts(
        np.concatenate([every.p[on], fb, fc]),
        np.concatenate([every.q[on], b_q, c_q]),
        np.concatenate(
            [every.n[on], (b_q - fb[:, None]) / curve.radius, (c_q - fc[:, None]) / curve.radius]
        ),
    )
    numbers = np.arange(len(rows))[:, None] + len(rows) * np.arange(3)
    return squeezes(all_three, numbers, phi, curve.ring.diameter)


def _met(curve: Curve, e: int, g: int, ratio: complex, shift: Complex) -> list[Complex]:
    """Where element e, turned and scaled by a ratio and then shifted, meets element g; nan: not."""
    edges, r = len(curve.start), curve.radius
    if g < edges:
        start, side = curve.start[g], curve.side[g]
        if e < edges:
            moved, way = shift + ratio * curve.start[e], ratio * curve.side[e]
            cross = (np.conj(way) * side).imag
            if abs(cross) < 1e-9 * abs(way) * abs(side):
                return []
            u = (np.conj(way) * (moved - start)).imag / cross
            return [start + u * side]
        return _on_line(start, side, shift + ratio * curve.centre[e - edges], r * abs(ratio))
    centre = curve.centre[g - edges]
    if e < edges:
        back = (centre - shift) / ratio  # the circle seen from the line
        hits = _on_line(curve.start[e], curve.side[e], back, r / abs(ratio))
        return [shift + ratio * hit for hit in hits]
    other, big = shift + ratio * curve.centre[e - edges], r * abs(ratio)
    way = other - centre
    far = np.abs(way)
    with np.errstate(invalid="ignore", divide="ignore"):
        along = (far**2 + r**2 - big**2) / (2.0 * far)
        up = np.sqrt(r**2 - along**2)
        return [centre + way / far * (along + sign * 1j * up) for sign in (-1.0, 1.0)]


def _on_line(start: complex, side: complex, centre: Complex, radius: float) -> list[Complex]:
    unit = side / abs(side)
    off = (centre - start) / unit
    with np.errstate(invalid="ignore"):
        half = np.sqrt(radius**2 - off.imag**2)
    return [start + unit * (off.real + sign * half) for sign in (-1.0, 1.0)]


def _foot(curve: Curve, element: int, f: Complex) -> Complex:
    """Where fingers on an element touch the object; nan beyond its ends."""
    edges = len(curve.start)
    if element >= edges:
        k = element - edges
        angle = np.angle((f - curve.centre[k]) * np.exp(-1j * curve.begin[k]))
        good = (angle >= -SLACK) & (angle <= curve.turn[k] + SLACK)
        return np.where(good, curve.centre[k], np.nan)
    t = ((f - curve.start[element]) / curve.side[element]).real
    good = (t >= -SLACK) & (t <= 1.0 + SLACK)
    return np.where(good, f - curve.radius * curve.out[element], np.nan)


def squeezes(every: Contacts, rows: NDArray[np.int64], phi: float, diameter: float) -> np.ndarray:
    """Whether forces at contacts (n, k) balance, at where they touch, and squeeze, (n,)."""
    return squeezing(_generators(every, rows, phi, diameter))


def _generators(every: Contacts, rows: NDArray[np.int64], phi: float, diameter: float) -> Floats:
    """(n, 5, c): force, torque, one, and the work of opening, for both edges of every cone."""
    middle = every.p[rows].mean(axis=1, keepdims=True)
    columns: list[Floats] = []
    for k in range(rows.shape[1]):
        at = rows[:, k]
        for cone in range(1 if every.single[at].all() else 2):
            for way in (-1.0, 1.0):
                force = every.n[at, cone] * np.exp(1j * way * phi)
                arm = (every.q[at, cone] - middle[:, 0]) / diameter
                motor = (every.p[at] - middle[:, 0]) / diameter
                torque, work = (np.conj(arm) * force).imag, (np.conj(motor) * force).real
                one = np.ones(len(at))
                columns.append(np.stack([force.real, force.imag, torque, one, work], axis=1))
    return np.stack(columns, axis=2)


def residual(curve: Curve, contacts: Floats, mu: float, off: float = 1e-9) -> float:
    """How badly the best squeezing forces at centres (3, 2) balance, [1]: 0 for a jam.

    The forces do unit work. A linear program: least size of the force and torque left over.
    """
    phi = math.atan(mu)
    diameter = curve.ring.diameter
    centre = complex(*contacts.mean(axis=0))
    columns: list[list[float]] = []
    for p in _complex(contacts).tolist():
        for q in curve.touched(p, off):
            n = (q - p) / abs(q - p)
            for way in (-1.0, 1.0):
                f = n * complex(math.cos(phi), way * math.sin(phi))
                arm, motor = (q - centre) / diameter, (p - centre) / diameter
                columns.append(
                    [f.real, f.imag, (arm.conjugate() * f).imag, -(motor.conjugate() * f).real]
                )
    if not columns:
        return math.inf
    wrench = np.array(columns).T
    n = wrench.shape[1]
    both = np.vstack([wrench[:3], -wrench[:3]])
    answer = linprog(
        np.append(np.zeros(n), 1.0), A_ub=np.column_stack([both, -np.ones(6)]), b_ub=np.zeros(6),
        A_eq=np.append(wrench[3], 0.0)[None], b_eq=[1.0], bounds=(0.0, None),
    )  # fmt: skip
    return float(answer.fun) if answer.status == 0 else math.inf


def _complex(points: Floats) -> Complex:
    return points[:, 0] + 1j * points[:, 1]
