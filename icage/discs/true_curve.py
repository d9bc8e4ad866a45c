"""Local minima of sigma for disc fingers on the true curve, arcs and corners with arcs included.

A polygon gives the neighbourhood; the minimum itself is a small problem in (d, w): the finger
centres at distance >= radius from the edges and vertices they touch. Our own.
"""

from __future__ import annotations

from itertools import chain
from typing import NamedTuple

import numpy as np

from icage.arrays import FloatArray, IntArray
from icage.discs.balance import balanced, finger_maps, pushes, pushing, slope_of_half_square
from icage.errors import GraspError, HandError
from icage.geometry.least_hand import least_hand
from icage.hand import HandShape
from icage.kernels.locate import depth_inside
from icage.outline import Outline
from icage.tolerance import COLLISION, CONTACT_OFF

_NEAR = 3e-3
"""[diameter] Features of the outline this close to being touched take part."""

_TOUCHED = 1e-7
"""[diameter] A contact of an inner polygon is this little outside the features it stands for."""

_TRIES = 4
"""Times that a hand whose finger has come free is put onto the curve again."""

_COLLAPSED = 0.5
"""[1] Sigma over that of the contacts given, below which the hand has fallen off its features: the
true curve is nowhere further from a polygon than a small part of the radius."""

_INSIDE = 1e-9
"""[diameter] A finger may be this far inside a feature; one this near to it touches it."""

_ROUNDS = 200
"""Times that the features are taken as half spaces."""

_STANDS = 1e-14
"""[diameter] A hand that moves by less has come to rest."""

_BALANCED = 1e-7
"""[1] Residual of the forces in a minimum, over the size of the hand."""


class Feature(NamedTuple):
    """Finger ``finger`` (0..2) keeps ``radius`` from a line (normal given) or from a vertex."""

    finger: int
    point: FloatArray
    normal: FloatArray | None


def features_near(outline: Outline, radius: float, contacts: FloatArray) -> list[Feature]:
    """Edges and convex vertices that the three finger centres touch or nearly touch."""
    a = outline.vertices
    side = np.roll(a, -1, axis=0) - a
    length = np.hypot(side[:, 0], side[:, 1])
    outward = np.column_stack([side[:, 1], -side[:, 0]]) / length[:, None]
    reach = _NEAR * outline.diameter
    found: list[Feature] = []
    for k, point in enumerate(contacts):
        t = ((point - a) * side).sum(axis=1) / length
        gap = ((point - a) * outward).sum(axis=1)
        # an edge counts as a line only where the finger faces it; beyond its ends its vertex does
        faces = (t >= -1e-9 * outline.diameter) & (t <= length + 1e-9 * outline.diameter)
        edge = faces & (np.abs(gap - radius) <= reach)
        found += [Feature(k, a[q], outward[q]) for q in np.flatnonzero(edge)]
        far = np.hypot(*(point - a).T)
        beyond_before = np.roll(t > length - reach, 1)
        corner = (np.abs(far - radius) <= reach) & (t <= reach) & beyond_before
        found += [Feature(k, a[q], None) for q in np.flatnonzero(corner)]
    return found


def refine(
    outline: Outline, hand: HandShape, radius: float, contacts: FloatArray
) -> FloatArray | None:
    """Contacts (3, 2) of the local minimum on the true curve next to the given ones, or None.

    The least hand among the half spaces that the features leave where it stands, over and over
    (sequential quadratic programming), then Newton steps on the conditions of the active features.
    The features are taken as whole lines and circles: a hand that has slid off the end of one and
    closed behind it, or stands in the object there, is no minimum. None then, as where there is
    none. A finger may be free in the minimum found.
    """
    size = outline.diameter
    features = features_near(outline, radius, contacts)
    if len({f.finger for f in features}) < 2:
        return None
    origin = contacts.mean(axis=0)
    side = contacts[1] - contacts[0]
    start = np.concatenate([contacts[0] - origin, side]) / size
    system = _System(features, hand, radius / size, origin, size)
    found = system.closed(start)
    # what only comes near without carrying force is at times no part of the minimum; and contacts
    # that are one already, however flat it is, are not to be lost
    polished = (system.polished(found, loaded=loaded) for loaded in (False, True))
    for point in chain(polished, (start,)):
        if point is None or not system.is_balanced(point):
            continue
        if np.hypot(*point[2:]) < _COLLAPSED * np.hypot(*start[2:]):
            continue
        f = (point[0] + 1j * point[1]) + (point[2] + 1j * point[3]) * hand.z
        solved = np.column_stack([f.real, f.imag]) * size + origin
        if float(_depths(outline, radius, solved).max()) <= COLLISION * size:
            return contacts.copy() if point is start else solved
    return None


def _depths(outline: Outline, radius: float, contacts: FloatArray) -> FloatArray:
    """How far each finger (3,) is inside the true curve, [unit]; negative outside."""
    middle = contacts.mean(axis=0)
    return depth_inside(outline.vertices - middle, contacts - middle, radius)


def onto_curve(outline: Outline, radius: float, contacts: FloatArray) -> FloatArray | None:
    """Contacts (3, 2) of an inner polygon moved onto the true curve, each the nearest way, or None.

    A contact on a chord goes to its arc, one in a corner of the polygon to the corner of the curve,
    one just off the curve back to it (Newton steps). The shape of the hand changes with them.
    """
    size = outline.diameter
    moved = contacts.copy()
    for k in range(len(contacts)):
        near = [f for f in features_near(outline, radius, contacts) if f.finger == k]
        if not near:
            return None
        least = min(_gap(f, moved[k], radius)[0] for f in near)
        bound = max(0.0, least) + _TOUCHED * size  # a free finger goes to what is nearest to it
        touched = [f for f in near if _gap(f, moved[k], radius)[0] <= bound]
        for _ in range(8):
            rows = [_gap(f, moved[k], radius) for f in touched]
            gaps, normals = np.array([g for g, _ in rows]), np.array([n for _, n in rows])
            moved[k] -= np.linalg.lstsq(normals, gaps, rcond=1e-9)[0]
    if float(np.abs(_depths(outline, radius, moved)).max()) > COLLISION * size:
        return None
    return moved


def _gap(feature: Feature, point: FloatArray, radius: float) -> tuple[float, FloatArray]:
    """Distance of a finger from touching a feature, and the direction in which it grows."""
    off = point - feature.point
    far = float(np.hypot(*off))
    normal = off / far if feature.normal is None else feature.normal
    return float(normal @ off) - radius, normal


def grasp_on_curve(
    outline: Outline, radius: float, contacts: FloatArray, hand: HandShape | None = None
) -> FloatArray:
    """The grasp of disc fingers on the true curve next to contacts (3, 2) of an inner polygon.

    The minimum of the same hand, if all fingers touch there. On the true curve the hand may be too
    small for that by the height of a chord: a finger is left free, or nothing is held. The best
    grasps stand where a finger is just about to be free, so this is no rare case. Then the contacts
    are moved onto the curve, and the hand with them, unless ``hand`` is what is asked for.

    Raises
    ------
    GraspError:
        There is no such grasp; says why.
    """
    why = ""
    solved = refine(outline, hand or HandShape.from_contacts(contacts), radius, contacts)
    if solved is None:
        why = "no minimum on the true curve"
    elif _all_touch(outline, radius, solved):
        return solved
    else:
        why = "a finger leaves the outline on the true curve"
    points = contacts
    for _ in range(_TRIES if hand is None else 0):
        moved = onto_curve(outline, radius, points)
        if moved is None:
            break
        solved = _own_minimum(outline, radius, moved)
        if solved is None:
            break
        if _all_touch(outline, radius, solved):
            return solved
        points = solved
    raise GraspError(why)


def _own_minimum(outline: Outline, radius: float, contacts: FloatArray) -> FloatArray | None:
    """The minimum of the hand that stands on these contacts; None also if that is no hand."""
    try:
        return refine(outline, HandShape.from_contacts(contacts), radius, contacts)
    except HandError:
        return None


def _all_touch(outline: Outline, radius: float, contacts: FloatArray) -> bool:
    depth = _depths(outline, radius, contacts)
    return bool(np.abs(depth).max() <= CONTACT_OFF * outline.diameter)


class _System:
    """Gaps of the features as functions of v = (d_x, d_y, w_x, w_y) / size about an origin."""

    def __init__(
        self, features: list[Feature], hand: HandShape, radius: float, origin: FloatArray,
        size: float,
    ) -> None:  # fmt: skip
        self._radius = radius
        self._features = features
        self._points = np.array([(f.point - origin) / size for f in features])
        self._maps = finger_maps(hand)[[f.finger for f in features]]

    def _normals(self, v: FloatArray) -> tuple[FloatArray, FloatArray]:
        off = self._maps @ v - self._points
        far = np.hypot(off[:, 0], off[:, 1])
        normals = np.array(
            [
                o / r if f.normal is None else f.normal
                for f, o, r in zip(self._features, off, far, strict=True)
            ]
        )
        return normals, (normals * off).sum(axis=1) - self._radius

    def gaps(self, v: FloatArray) -> FloatArray:
        """Distance of every feature minus the radius, over the size."""
        return self._normals(v)[1]

    def slopes(self, v: FloatArray) -> FloatArray:
        """Derivative of the gaps, (features, 4)."""
        return np.einsum("ki,kij->kj", self._normals(v)[0], self._maps)

    def closed(self, v: FloatArray) -> FloatArray:
        """Where closing comes to rest, or nearly so."""
        for _ in range(_ROUNDS):
            slopes = self.slopes(v)
            least = least_hand(slopes, (slopes * v).sum(axis=1) - self.gaps(v), v[:2])
            if least is None:
                break
            step = float(np.abs(least - v).max())
            v = least
            if step < _STANDS:
                break
        return v

    def _curvature(self, v: FloatArray, force: FloatArray, rows: IntArray) -> FloatArray:
        """Hessian of 1/2 |w|^2 - sum force x gap over the active features, (4, 4)."""
        hessian = np.diag([0.0, 0.0, 1.0, 1.0])
        normals, gaps = self._normals(v)
        for k, lam in zip(rows, force, strict=True):
            if self._features[int(k)].normal is None:
                n = normals[int(k)]
                flat = (np.eye(2) - np.outer(n, n)) / (gaps[int(k)] + self._radius)
                hessian -= lam * self._maps[int(k)].T @ flat @ self._maps[int(k)]
        return hessian

    def is_balanced(self, v: FloatArray) -> bool:
        """Whether pushing forces of touched features balance, and no finger is inside of one."""
        gaps = self.gaps(v)
        if not -_INSIDE <= float(gaps.min()) <= _INSIDE:
            return False
        touched = self.slopes(v)[gaps <= _INSIDE].T
        return balanced(touched, slope_of_half_square(v), _BALANCED) is not None

    def polished(self, v: FloatArray, *, loaded: bool = False) -> FloatArray | None:
        """Newton on stationarity and contact of the features that carry or nearly carry force.

        ``loaded`` keeps to those that carry some when all forces push.
        """
        active: IntArray = np.flatnonzero(self.gaps(v) < 1e-7).astype(np.int64)
        if loaded and len(active):
            force, _ = pushing(self.slopes(v)[active].T, slope_of_half_square(v))
            active = active[pushes(force)]
        if not len(active):
            return None
        slope = self.slopes(v)[active]
        force = np.linalg.lstsq(slope.T, slope_of_half_square(v), rcond=1e-9)[0].astype(np.float64)
        for _ in range(8):
            slope = self.slopes(v)[active]
            residual = np.concatenate(
                [slope_of_half_square(v) - slope.T @ force, self.gaps(v)[active]]
            )
            n = len(active)
            matrix = np.block(
                [[self._curvature(v, force, active), -slope.T], [slope, np.zeros((n, n))]]
            )
            step = np.linalg.lstsq(matrix, -residual, rcond=1e-12)[0]
            if not np.isfinite(step).all() or float(np.abs(step[:4]).max()) > 1e-2:
                return None
            v = np.asarray(v + step[:4], dtype=np.float64)
            force = np.asarray(force + step[4:], dtype=np.float64)
        off = slope_of_half_square(v) - self.slopes(v)[active].T @ force
        return v if float(np.abs(off).max()) < 1e-9 else None
