"""Is the object caged by a rigid hand? Sampled weighted alpha shapes, after EBCA-2D [Mahler2016].

Poses (x, y, turn) of a hand of one size are sampled at random and those in collision kept. A finger
at depth d stays inside the object until it has moved by d; so round each kept pose there is a ball
of poses that collide, too. The balls' weighted alpha complex at 0 has the shape of their union. The
hand is proven to be a cage if its start lies in a void of that complex: whatever way it took out
would cross a simplex that collides. Written from the paper's description; one answer for a hand of
one size, and sigma_max by bisection over sizes.

It errs on one side only: "caged" is proven (to rounding), "not caged" may be a lack of samples. Two
things more to know: a way that turns the hand by more than half a circle counts as open; and a
rigid hand may stay caged a little above the sigma_max of a hand that may squeeze meanwhile.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import shapely
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import ConvexHull

from benchmarks.peers.question import Question, clearance

_TRIES = 400
"""Poses tried round the last start, and ..."""
_NEAR = 0.01
"""... [diameter] how far apart."""
_BATCHES = 50
"""Batches of ``samples`` random poses, at most, to find so many that collide."""
_GROWS = 1.01
"""Largest factor by which the hand opens from one start to the next."""


@dataclass(frozen=True)
class Bisected:
    """The largest size that was proven, the least above it that was not, and what it took."""

    proven: float
    not_proven: float
    calls: int


def sigma_max(question: Question, samples: int, seed: int, tolerance: float = 5e-3) -> Bisected:
    """Bisection of the size to ``tolerance`` [sigma_0], from sigma_0 to ``question.largest``."""
    low, high, calls = question.sigma_0, question.largest, 0
    while high - low > tolerance * question.sigma_0:
        middle = 0.5 * (low + high)
        calls += 1
        if caged(question, middle, samples, seed):
            low = middle
        else:
            high = middle
    return Bisected(low, high, calls)


def caged(question: Question, sigma: float, samples: int, seed: int) -> bool:
    """Is it proven that the rigid hand of this size cannot get out from round the target?"""
    rng = np.random.default_rng(seed)
    start = start_of(question, sigma, rng)
    if start is None:
        return False
    middle = _middle(question.arms)
    around = replace(question, arms=question.arms - middle)
    shift = sigma * np.exp(1j * start[2]) * middle
    start = start + np.array([shift.real, shift.imag, 0.0])
    reach = sigma * float(np.abs(around.arms).max())
    poses, depth = _colliding(around, sigma, start[2], samples, rng)
    if len(poses) < 5:
        return False
    # with turns times reach as a third length, a finger's move is at most
    # |shift| + arm |turn| <= sqrt(1 + (arm / reach)^2) |(shift, reach turn)|
    stretch = np.sqrt(1.0 + (sigma * np.abs(around.arms) / reach) ** 2)
    radius = (depth / stretch).max(axis=1)
    return in_void((poses - start) * [1.0, 1.0, reach], radius, np.zeros(3))


def _middle(arms: np.ndarray) -> complex:
    """Of the smallest circle round the fingers: about it a turn moves them least."""
    fingers = shapely.multipoints(np.column_stack([arms.real, arms.imag]))
    circle = shapely.minimum_bounding_circle(fingers).centroid
    return complex(circle.x, circle.y)


def start_of(question: Question, sigma: float, rng: np.random.Generator) -> np.ndarray | None:
    """A free pose of the hand opened to ``sigma`` from the target, or None.

    The hand opens in small factors, at each the pose near the last one with the most room.
    """
    pose = np.array([question.reference.real, question.reference.imag, 0.0])
    steps = int(np.ceil(np.log(sigma / question.sigma_0) / np.log(_GROWS))) + 1
    spread = _NEAR * question.diameter * np.array([1.0, 1.0, 1.0 / question.diameter])
    for size in np.geomspace(question.sigma_0, sigma, max(steps, 2))[1:]:
        tried = np.vstack([pose, pose + spread * rng.normal(size=(_TRIES, 3))])
        room = question.clearance(tried, size)
        best = int(np.argmax(room))
        if room[best] <= 0.0:
            return None
        pose = tried[best]
    return pose


def _colliding(
    question: Question, sigma: float, turn: float, samples: int, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """So many random poses that collide (n, 3), and each finger's depth (n, k), 0 outside."""
    reach = sigma * float(np.abs(question.arms).max())
    low_x, low_y, high_x, high_y = question.obstacle.bounds
    low = [low_x - reach, low_y - reach, turn - np.pi]
    high = [high_x + reach, high_y + reach, turn + np.pi]
    kept_poses, kept_depth, kept = [np.empty((0, 3))], [np.empty((0, len(question.arms)))], 0
    for _ in range(_BATCHES):
        poses = rng.uniform(low, high, (samples, 3))
        depth = np.maximum(-clearance(question.obstacle, question.fingers(poses, sigma)), 0.0)
        hit = depth.max(axis=1) > 0.0
        kept_poses.append(poses[hit])
        kept_depth.append(depth[hit])
        kept += int(hit.sum())
        if kept >= samples:
            break
    return np.concatenate(kept_poses)[:samples], np.concatenate(kept_depth)[:samples]


def in_void(centres: np.ndarray, radii: np.ndarray, start: np.ndarray) -> bool:
    """Does the union of balls enclose the point? By the weighted alpha complex at 0.

    The regular triangulation is the lower hull of the lifted centres. A tetrahedron with the plane
    h = 2 c.p - k over it has the power centre c, of power |c|^2 - k: covered if that is not
    positive. Two open tetrahedra are joined if no point of the segment between their power centres,
    the dual edge of their common triangle, is covered.
    """
    lifted = (centres**2).sum(axis=1) - radii**2
    hull = ConvexHull(np.column_stack([centres, lifted]), qhull_options="Qt")
    normal, offset = hull.equations[:, :4], hull.equations[:, 4]
    lower = normal[:, 3] < -1e-12
    number = np.where(lower, np.cumsum(lower) - 1, -1)
    tetrahedra, normal, offset = hull.simplices[lower], normal[lower], offset[lower]
    beyond = number[hull.neighbors[lower]]  # -1: outside the convex hull
    centre = -normal[:, :3] / (2.0 * normal[:, 3:])
    power = (centre**2).sum(axis=1) - offset / normal[:, 3]
    outside = len(tetrahedra)
    start_in = _located(centres, tetrahedra, normal, offset, start)
    if start_in is None or power[start_in] <= 0.0:
        return False
    rows, columns = [], []
    for corner in range(4):
        others = tetrahedra[:, [c for c in range(4) if c != corner]]
        one, two = np.arange(len(tetrahedra)), beyond[:, corner]
        vertex = centres[others[:, 0]]
        weight = radii[others[:, 0]] ** 2
        # to the next power centre, or without end away from the convex hull
        across = np.cross(centres[others[:, 1]] - vertex, centres[others[:, 2]] - vertex)
        inward = ((centres[tetrahedra[:, corner]] - vertex) * across).sum(axis=1) > 0.0
        away = np.where(inward[:, None], -across, across)
        edge = np.where(two[:, None] >= 0, centre[two] - centre, away)
        length = np.maximum((edge**2).sum(axis=1), np.finfo(float).tiny)
        along = ((vertex - centre) * edge).sum(axis=1) / length
        along = np.clip(along, 0.0, np.where(two >= 0, 1.0, np.inf))
        nearest = centre + along[:, None] * edge
        open_way = ((nearest - vertex) ** 2).sum(axis=1) > weight
        rows.append(one[open_way])
        columns.append(np.where(two >= 0, two, outside)[open_way])
    row, column = np.concatenate(rows), np.concatenate(columns)
    graph = coo_array((np.ones(len(row), dtype=bool), (row, column)), shape=(outside + 1,) * 2)
    component = connected_components(graph, directed=False)[1]
    return bool(component[start_in] != component[outside])


def _located(
    centres: np.ndarray,
    tetrahedra: np.ndarray,
    normal: np.ndarray,
    offset: np.ndarray,
    point: np.ndarray,
) -> int | None:
    """The tetrahedron that holds a point: its plane is the highest there; None outside the hull."""
    height = -(normal[:, :3] @ point + offset) / normal[:, 3]
    highest = int(np.argmax(height))
    corners = centres[tetrahedra[highest]]
    parts = np.linalg.solve(np.vstack([corners.T, np.ones(4)]), np.append(point, 1.0))
    return highest if parts.min() >= 0.0 else None
