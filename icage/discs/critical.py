"""Minima and punctures of disc fingers on the true curve, to rounding.

Near a hand, free space is bounded by gaps g(v) >= 0 of the features it touches, v = (d, w): the
distance of a finger from a straight edge or from a convex vertex, less the radius. Arcs run into
edges without a kink and corners of the curve are concave, so every level at which the sublevel sets
change has a hand whose forces balance, w = sum lambda_i grad g_i with lambda_i >= 0 at touched
features. How many directions along the touched features descend (the index of w . w / 2 -
sum lambda_i g_i) tells what it is: none for a minimum, one for a puncture. A polygon's answer says
where to look, Newton's method does the rest. Our own. [docs/theory.md, Sec. 4]
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import combinations
from typing import NamedTuple

import numpy as np

from icage.arrays import BoolArray, FloatArray
from icage.geometry.exterior import without_straight_vertices
from icage.hand import HandShape
from icage.kernels.locate import depth_inside
from icage.outline import Outline
from icage.tolerance import FREE_FINGER

_TOUCHES = 1e-10
"""[diameter] A solved finger is this near to the features it touches, and no deeper in any."""

_BALANCED = 1e-9
"""[1] Residual of the forces of a solved hand, over its size."""

_PUSHES = 1e-9
"""[1] A force this small, over the largest, is none."""

_FLAT = 1e-7
"""[1] Curvature of sigma along the features below which a direction is level."""

_ASLANT = 1e-6
"""[1] A touched feature that a direction is inclined to by more is in its way."""

_STEPS = 12
"""Newton steps; from a polygon's answer five are enough."""

_CHANGES = 8
"""How often the set of touched features may change on the way."""

_SUBSETS = 40
"""Sets of features that are tried one by one where the likely one fails."""

_DESCENT = 240
"""Steps of a descent along the true curve."""

_NEARLY_BALANCED = 0.1
"""[1] Residual of the forces, over the size of the hand, above which no minimum is near."""

_STANDS = 1e-12
"""[diameter] A descent that closes by less in a step has come to rest."""

_NUDGE = 0.02
"""[radius] How far a hand at rest on a puncture is pushed off it."""

_STRIDE = 0.25
"""[radius] How far a finger goes in one of them."""


class Feature(NamedTuple):
    """Finger ``finger`` (0..) at an edge or at a vertex of the outline, by number."""

    finger: int
    number: int
    is_arc: bool


@dataclass(frozen=True, slots=True)
class Critical:
    """A hand on the true curve whose forces balance.

    ``contacts`` (fingers, 2) are the finger centres, ``sigma`` is the distance of the first two.
    ``descending`` counts the directions along the touched features in which sigma falls, ``level``
    those in which it neither falls nor grows (parallel edges).
    """

    contacts: FloatArray
    sigma: float
    features: tuple[Feature, ...]
    descending: int
    level: int


class CurveFeatures:
    """The features of one outline for fingers of one radius, and the hands that they hold.

    Lengths inside are in diameters, from the middle of the outline.
    """

    def __init__(self, outline: Outline, radius: float, hand: HandShape) -> None:
        self.size = outline.diameter
        ring = without_straight_vertices(outline.vertices, self.size)
        self.origin = 0.5 * (ring.min(axis=0) + ring.max(axis=0))
        self.hand = hand
        self._r = radius / self.size
        a = self._ring = np.ascontiguousarray((ring - self.origin) / self.size)
        side = np.roll(a, -1, axis=0) - a
        self._length = np.hypot(side[:, 0], side[:, 1])
        self._way = side / self._length[:, None]
        self._out = np.column_stack([self._way[:, 1], -self._way[:, 0]])
        back = np.roll(self._way, 1, axis=0)
        self._convex = back[:, 0] * self._way[:, 1] - back[:, 1] * self._way[:, 0] > 0.0
        self._remembered: dict[tuple[frozenset[Feature], int], Critical] = {}
        # finger k = maps[k] v
        self._maps = np.array(
            [[[1.0, 0.0, z.real, -z.imag], [0.0, 1.0, z.imag, z.real]] for z in hand.z]
        )

    # ------------------------------------------------------------------ what is asked

    def minimum(self, contacts: FloatArray, reach: float) -> Critical | None:
        """The local minimum next to contacts (fingers, 2), or None if Newton's method finds none.

        Every finger is within ``reach`` [unit] of the features that it touches there.
        """
        return self._solve(contacts, reach, 0)

    def puncture(self, contacts: FloatArray, reach: float) -> Critical | None:
        """The puncture next to contacts (fingers, 2), as ``minimum``."""
        return self._solve(contacts, reach, 1)

    def below(self, contacts: FloatArray, reach: float) -> Critical | None:
        """The minimum that a hand at contacts (fingers, 2) comes to as it closes on the true curve.

        Each finger keeps to the half planes that the nearest points of the edges around it leave:
        all of them free, so that every step is a motion of the hand that never opens it.
        """
        v = self._as_hand(contacts)
        sigma = math.inf
        for step in range(_DESCENT):
            v = self._closed(v)
            if v is None:
                return None
            now = float(np.hypot(v[2], v[3]))
            stands = sigma - now < _STANDS
            if step % 8 == 7 or stands:
                found = self._solve(self._as_contacts(v), reach, 0)
                if found is not None and found.sigma <= now * self.size * (1.0 + 1e-9):
                    return found
            if stands:
                down = self._way_down(v)
                if down is None:
                    return None
                v = v + _NUDGE * self._r * down
            sigma = now
        return None

    def _way_down(self, v: FloatArray) -> FloatArray | None:
        """A direction (4,) along the touched features in which sigma falls to second order.

        A minimum of chords may stand on the very puncture of the arcs.
        """
        near = self._near(v, 1e-6)
        if len({f.finger for f in near}) < 2:
            return None
        gaps, normals = self._gaps(v, near)
        slope = self._slopes(near, normals)
        force, _ = _pushing(slope.T, np.array([0.0, 0.0, v[2], v[3]]))
        along = _free_directions(slope[force > _PUSHES * force.max()])
        if not len(along):
            return None
        hessian = along @ self._curvature(near, normals, force, gaps) @ along.T
        bend, ways = np.linalg.eigh(hessian)
        if bend[0] >= -_FLAT:
            return None
        way = ways[:, 0] @ along
        return np.asarray(way / float(np.hypot(*(self._maps @ way).T).max()))

    def minima_near(self, hands: FloatArray, reach: float) -> list[Critical]:
        """Minima (of any number) next to some of the hands (k, fingers, 2), ascending in sigma.

        Of hands that touch the same features, to within ``reach`` [unit], only the smallest is
        looked at, and Newton's method is tried where forces nearly balance.
        """
        at = (hands - self.origin) / self.size
        rows = np.concatenate([at[:, 0], at[:, 1] - at[:, 0]], axis=1)
        order = np.argsort(np.hypot(rows[:, 2], rows[:, 3]), kind="stable")
        touched = self._touched(at[order], reach / self.size)
        _, first = np.unique(touched, axis=0, return_index=True)
        found: list[Critical] = []
        for k in np.sort(first).tolist():
            v = rows[order[k]]
            near = self._named(touched[k])
            if len({f.finger for f in near}) < 2:
                continue
            slope = self._slopes(near, self._gaps(v, near)[1])
            _, miss = _pushing(slope.T, np.array([0.0, 0.0, v[2], v[3]]))
            if miss <= _NEARLY_BALANCED * np.hypot(v[2], v[3]):
                one = self._solve(self._as_contacts(v), reach, 0)
                if one is not None:
                    found.append(one)
        return sorted(found, key=lambda one: one.sigma)

    def _touched(self, at: FloatArray, reach: float) -> BoolArray:
        """Which features hands (k, fingers, 2) nearly touch, (k, fingers x edges and vertices)."""
        off = at[:, :, None] - self._ring
        along = (off * self._way).sum(axis=3)
        gap = (off * self._out).sum(axis=3) - self._r
        edges = (np.abs(gap) <= reach) & (along >= 0.0) & (along <= self._length)
        far = np.hypot(off[..., 0], off[..., 1])
        before = np.roll(along - self._length, 1, axis=2)
        arcs = (np.abs(far - self._r) <= reach) & self._convex & (along <= 0.0) & (before >= 0.0)
        return np.concatenate([edges, arcs], axis=2).reshape(len(at), -1)

    def _named(self, touched: BoolArray) -> list[Feature]:
        """The features of a row of ``_touched``."""
        n = len(self._ring)
        return [
            Feature(k // (2 * n), k % n, bool(k % (2 * n) >= n))
            for k in np.flatnonzero(touched).tolist()
        ]

    def free_fingers(self, contacts: FloatArray) -> tuple[int, ...]:
        """Fingers (1..) of contacts (fingers, 2) that touch nothing."""
        at = (contacts - self.origin) / self.size
        depth = depth_inside(self._ring, at, self._r)
        return tuple(k + 1 for k in range(len(at)) if depth[k] < -FREE_FINGER)

    # ------------------------------------------------------------------ hands

    def _as_hand(self, contacts: FloatArray) -> FloatArray:
        at = (contacts - self.origin) / self.size
        return np.concatenate([at[0], at[1] - at[0]])

    def _as_contacts(self, v: FloatArray) -> FloatArray:
        f = (v[0] + 1j * v[1]) + (v[2] + 1j * v[3]) * self.hand.z
        return np.column_stack([f.real, f.imag]) * self.size + self.origin

    def _near(self, v: FloatArray, reach: float) -> list[Feature]:
        """Features within ``reach`` [diameter] of being touched, of all fingers."""
        found: list[Feature] = []
        for k, m in enumerate(self._maps):
            off = m @ v - self._ring
            along = (off * self._way).sum(axis=1)
            gap = (off * self._out).sum(axis=1) - self._r
            edge = (np.abs(gap) <= reach) & (along >= -reach) & (along <= self._length + reach)
            found += [Feature(k, int(q), False) for q in np.flatnonzero(edge)]
            far = np.hypot(off[:, 0], off[:, 1])
            before = np.roll(along - self._length, 1)
            round_ = (
                (np.abs(far - self._r) <= reach) & self._convex
                & (along <= reach) & (before >= -reach)
            )  # fmt: skip
            found += [Feature(k, int(q), True) for q in np.flatnonzero(round_)]
        return found

    def _gaps(self, v: FloatArray, features: list[Feature]) -> tuple[FloatArray, FloatArray]:
        """Gaps (m,) and unit normals (m, 2) of features."""
        which = [f.finger for f in features]
        number = [f.number for f in features]
        off = self._maps[which] @ v - self._ring[number]
        normals = self._out[number]
        for k, f in enumerate(features):
            if f.is_arc:
                normals[k] = off[k] / math.hypot(off[k, 0], off[k, 1])
        return (normals * off).sum(axis=1) - self._r, normals

    def _slopes(self, features: list[Feature], normals: FloatArray) -> FloatArray:
        return np.einsum("ki,kij->kj", normals, self._maps[[f.finger for f in features]])

    def _curvature(
        self, features: list[Feature], normals: FloatArray, force: FloatArray, gaps: FloatArray
    ) -> FloatArray:
        """Second derivative (4, 4) of w . w / 2 - sum of force times gap."""
        hessian = np.diag([0.0, 0.0, 1.0, 1.0])
        for k, f in enumerate(features):
            if f.is_arc:
                across = np.array([-normals[k, 1], normals[k, 0]]) @ self._maps[f.finger]
                hessian -= force[k] / (self._r + gaps[k]) * np.outer(across, across)
        return hessian

    # ------------------------------------------------------------------ Newton

    def _solve(self, contacts: FloatArray, reach: float, descending: int) -> Critical | None:
        start = self._as_hand(contacts)
        near = self._near(start, max(reach / self.size, 1e-7))
        if len({f.finger for f in near}) < 2:
            return None
        gaps, normals = self._gaps(start, near)
        force, _ = _pushing(self._slopes(near, normals).T, np.array([0.0, 0.0, start[2], start[3]]))
        likely = [f for f, x in zip(near, force, strict=True) if x > _PUSHES * force.max()]
        known = self._remembered.get((frozenset(likely), descending))
        if known is not None:
            moved = float(np.hypot(*(known.contacts - contacts).T).max())
            if moved <= 0.5 * self._furthest(reach) * self.size:
                return known
        touched = [f for f, g in zip(near, gaps, strict=True) if g < 1e-7]
        for features in (likely, touched):
            found = self._with_changes(start, features, reach, descending)
            if found is not None:
                self._remembered[frozenset(likely), descending] = found
                return found
        if descending == 0:
            return None  # a descent finds what features are missing
        tried = 0
        for count in (3, 2, 4):
            for chosen in combinations(near, count):
                if len({f.finger for f in chosen}) < 2:
                    continue
                tried += 1
                if tried > _SUBSETS:
                    return None
                found = self._with_changes(start, list(chosen), reach, descending, changes=1)
                if found is not None:
                    return found
        return None

    def _with_changes(
        self, start: FloatArray, features: list[Feature], reach: float, descending: int,
        changes: int = _CHANGES,
    ) -> Critical | None:  # fmt: skip
        """Newton's method on a set of features that may change where the solution asks for it."""
        v = start
        far = self._furthest(reach)
        seen: set[frozenset[Feature]] = set()
        for _ in range(changes):
            if len({f.finger for f in features}) < 2 or frozenset(features) in seen:
                return None
            seen.add(frozenset(features))
            solved = self._newton(v, features)
            if solved is None or float(np.abs(self._maps @ (solved[0] - start)).max()) > far:
                return None
            v, force = solved
            better = self._changed(v, features, force)
            if better is None:
                return self._judged(v, features, descending)
            features = better
        return None

    def _furthest(self, reach: float) -> float:
        """How far a finger may be from where the polygon had it, [diameter]: a chord's length."""
        return max(math.sqrt(8.0 * self._r * reach / self.size), 1e-6) * 2.0

    def _newton(
        self, v: FloatArray, features: list[Feature]
    ) -> tuple[FloatArray, FloatArray] | None:
        gaps, normals = self._gaps(v, features)
        slope = self._slopes(features, normals)
        force: FloatArray = np.asarray(
            np.linalg.lstsq(slope.T, np.array([0.0, 0.0, v[2], v[3]]), rcond=1e-9)[0], np.float64
        )
        m = len(features)
        matrix = np.zeros((4 + m, 4 + m))
        for _ in range(_STEPS):
            matrix[:4, :4] = self._curvature(features, normals, force, gaps)
            matrix[:4, 4:] = -slope.T
            matrix[4:, :4] = slope
            residual = np.concatenate([np.array([0.0, 0.0, v[2], v[3]]) - slope.T @ force, gaps])
            step = np.linalg.lstsq(matrix, -residual, rcond=1e-11)[0]
            longest = float(np.abs(step[:4]).max())
            if not longest < 0.5:
                return None
            v, force = np.asarray(v + step[:4]), np.asarray(force + step[4:], np.float64)
            gaps, normals = self._gaps(v, features)
            slope = self._slopes(features, normals)
            if longest < 1e-14:
                break
        off = np.array([0.0, 0.0, v[2], v[3]]) - slope.T @ force
        if float(np.abs(off).max()) > _BALANCED * np.hypot(v[2], v[3]):
            return None
        return (v, force) if float(np.abs(gaps).max()) <= _TOUCHES else None

    def _changed(
        self, v: FloatArray, features: list[Feature], force: FloatArray
    ) -> list[Feature] | None:
        """The set of features that the solution asks for instead, or None if it is right."""
        n = len(self._ring)
        # off the end of an edge its vertex is touched, off the end of an arc the edge beside it
        for k, f in enumerate(features):
            off = self._maps[f.finger] @ v - self._ring[f.number]
            along = float(off @ self._way[f.number])
            other: Feature | None = None
            if not f.is_arc:
                if along < -_TOUCHES:
                    other = Feature(f.finger, f.number, True)
                elif along > self._length[f.number] + _TOUCHES:
                    other = Feature(f.finger, (f.number + 1) % n, True)
            elif along > _TOUCHES:
                other = Feature(f.finger, f.number, False)
            elif float(off @ self._way[f.number - 1]) < -_TOUCHES:
                other = Feature(f.finger, (f.number - 1) % n, False)
            if other is not None:
                if other.is_arc and not self._convex[other.number]:
                    return features[:k] + features[k + 1 :]
                rest = [g for g in features if g not in (f, other)]
                return [*rest, other]
        deepest = self._deepest(v)
        if deepest is not None and deepest not in features:
            return [*features, deepest]
        weak = int(np.argmin(force))
        if force[weak] < -_PUSHES * float(np.abs(force).max()):
            _, miss = _pushing(
                self._slopes(features, self._gaps(v, features)[1]).T,
                np.array([0.0, 0.0, v[2], v[3]]),
            )
            if miss <= _BALANCED * np.hypot(v[2], v[3]):  # more are touched than are needed
                return None
            return features[:weak] + features[weak + 1 :]
        return None

    def _deepest(self, v: FloatArray) -> Feature | None:
        """The feature that a finger is deepest inside, if any is deeper than rounding."""
        points = (self._maps @ v).reshape(-1, 2)
        depth = depth_inside(self._ring, points, self._r)
        k = int(np.argmax(depth))
        if depth[k] <= _TOUCHES:
            return None
        off = points[k] - self._ring
        t = np.clip((off * self._way).sum(axis=1), 0.0, self._length)
        gap = np.hypot(*(off - t[:, None] * self._way).T)
        q = int(np.argmin(gap))
        if t[q] <= 0.0 or t[q] >= self._length[q]:
            vertex = q if t[q] <= 0.0 else (q + 1) % len(self._ring)
            if self._convex[vertex]:
                return Feature(k, vertex, True)
        return Feature(k, q, False)

    def _judged(self, v: FloatArray, features: list[Feature], descending: int) -> Critical | None:
        """What the hand is, if its forces balance pushing and it is of the wanted kind."""
        gaps, normals = self._gaps(v, features)
        slope = self._slopes(features, normals)
        force, miss = _pushing(slope.T, np.array([0.0, 0.0, v[2], v[3]]))
        if miss > _BALANCED * np.hypot(v[2], v[3]):
            return None
        pushing = force > _PUSHES * force.max()
        along = _free_directions(slope[pushing])
        hessian = self._curvature(features, normals, force, gaps)
        bend, ways = np.linalg.eigh(along @ hessian @ along.T)
        down, level = int((bend < -_FLAT).sum()), int((np.abs(bend) <= _FLAT).sum())
        arcs = any(f.is_arc for f, p in zip(features, pushing, strict=True) if p)
        if down != descending and not (level and not arcs and down <= descending):
            return None
        # a puncture goes on to both sides, down or, between parallel edges, on the level first
        if descending and self._is_blocked(v, ways[:, 0] @ along):
            return None
        if level and arcs:
            return None  # neither a minimum nor a puncture, to second order
        contacts = self._as_contacts(v)
        sigma = float(np.hypot(*(contacts[1] - contacts[0])))
        return Critical(contacts, sigma, tuple(features), down, level)

    def _is_blocked(self, v: FloatArray, way: FloatArray) -> bool:
        """Whether a feature that is touched, pushing or not, is in the way on one side or other."""
        near = self._near(v, 10.0 * _TOUCHES)
        slopes = self._slopes(near, self._gaps(v, near)[1])
        return bool(np.abs(slopes @ way).max() > _ASLANT)

    # ------------------------------------------------------------------ descent

    def _closed(self, v: FloatArray) -> FloatArray | None:
        """The hand after one step of closing inside the half planes around its fingers.

        The least |w|^2 + weight |step|^2 in them, a least-distance problem. [Lawson1974]
        """
        stride = _STRIDE * self._r
        rows: list[FloatArray] = []
        for m in self._maps:
            off = m @ v - self._ring
            t = np.clip((off * self._way).sum(axis=1), 0.0, self._length)
            from_ = off - t[:, None] * self._way
            far = np.hypot(from_[:, 0], from_[:, 1])
            use = np.flatnonzero((far < self._r + 3.0 * stride) & (far > 1e-9))
            n = from_[use] / far[use, None]
            rows.append(np.column_stack([n @ m, far[use] - self._r]))
        table = np.vstack(rows)
        scale = 1.0 / np.sqrt(np.array([1e-3, 1e-3, 1.0, 1.0]))
        aim = np.array([0.0, 0.0, -v[2], -v[3]])  # of the step, without half planes
        # x = (step - aim) / scale: least |x| with g (aim + scale x) + gap >= 0
        g = table[:, :4] * scale
        h = -(table[:, 4] + table[:, :4] @ aim)
        u, miss = _pushing(np.vstack([g.T, h]), np.array([0.0, 0.0, 0.0, 0.0, 1.0]))
        if miss < 1e-14:
            return None
        if not len(u):
            return None  # nothing is near: the hand closes to a point
        r = np.vstack([g.T, h]) @ u - np.array([0.0, 0.0, 0.0, 0.0, 1.0])
        step = aim + scale * (-r[:4] / r[4])
        longest = float(np.hypot(*(self._maps @ step).T).max())
        return np.asarray(v + step * min(1.0, stride / max(longest, 1e-300)))


def _free_directions(slopes: FloatArray) -> FloatArray:
    """Unit directions (k, 4) along which none of the gaps with these slopes (m, 4) changes."""
    _, size, right = np.linalg.svd(slopes)
    return np.asarray(right[int((size > 1e-9 * size[0]).sum()) :])


def _pushing(columns: FloatArray, wanted: FloatArray) -> tuple[FloatArray, float]:
    """Forces >= 0 (k,) whose sum over columns (m, k) comes nearest to a vector, and the miss."""
    if not columns.shape[1]:  # scipy 1.17.1 corrupts its memory when there is no column
        return np.zeros(0), float(np.linalg.norm(wanted))
    try:
        from scipy.optimize import nnls  # only now: scipy is slow to load

        found, miss = nnls(columns, wanted)
    except RuntimeError:  # too many steps: as good as unbalanced
        return np.zeros(columns.shape[1]), float(np.linalg.norm(wanted))
    return np.asarray(found), float(miss)
