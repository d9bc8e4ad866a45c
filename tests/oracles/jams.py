"""Jams by brute force: contacts sampled along the outline, forces from the edges of their cones.

Nothing is shared with icage.friction. Hands with two contacts come from pairs of sampled points;
hands with three from a sampled point and two edges, which leave one hand for each. Balance is the
basic solutions of a small linear program, all of them. What is found are jams, so their least
sigma is an upper bound of the true one.
"""

from __future__ import annotations

import math
from itertools import combinations, pairwise, product
from typing import NamedTuple

import numpy as np
import shapely
from scipy.optimize import linprog

from tests.oracles.balance import squeezing
from tests.oracles.geometry import Floats, Ring

SLACK = 1e-9
"""[1] Residual of balance and of the bounds of an edge."""


class Sample(NamedTuple):
    """Points (n, 2) of the outline with the middle and half the width of their force cones."""

    point: Floats
    middle: Floats
    half: Floats


def sample_of(ring: Ring, mu: float, count: int, around: Floats | None = None) -> Sample:
    """``count`` points an edge, both ends among them, and the vertices with cones of their own.

    ``around`` (k, 2): places on the outline round which points lie ever closer together, to look
    where a thin set of jams is said to be.
    """
    phi = math.atan(mu)
    inward = np.arctan2(-ring.normals[:, 1], -ring.normals[:, 0])
    points, middle, half = list[Floats](), list[float](), list[float]()
    finer = np.concatenate([[0.0], *(way * 0.6 ** np.arange(50.0) for way in (-1.0, 1.0))]) / count
    for k in range(len(ring)):
        share = [np.linspace(0.0, 1.0, count)]
        for point in np.empty((0, 2)) if around is None else around:
            if ring.nearest_on_edges(point)[1][k] <= 1e-9 * ring.diameter:
                foot = float((point - ring.starts[k]) @ ring.tangents[k] / ring.lengths[k])
                share.append(np.clip(foot + finer, 0.0, 1.0))
        for t in np.concatenate(share):
            points.append(ring.starts[k] + t * (ring.ends[k] - ring.starts[k]))
            middle.append(float(inward[k]))
            half.append(phi)
    for v in range(len(ring)):
        for right, left in vertex_cones(ring, v, phi):
            points.append(ring.vertices[v])
            middle.append(0.5 * (right + left))
            half.append(0.5 * (left - right))
    return Sample(np.array(points), np.array(middle), np.array(half))


def vertex_cones(ring: Ring, v: int, phi: float) -> list[tuple[float, float]]:
    """Convex cones, right to left edge [rad], that together are the forces at a vertex.

    Two halves at a convex vertex, whose forces may be no convex set; thirds of the plane at a
    concave one whose two edges together give every force.
    """
    before, after = (math.atan2(-n[1], -n[0]) for n in (ring.normals[v - 1], ring.normals[v]))
    turn = math.remainder(after - before, 2.0 * math.pi)
    right, left = before + min(turn, 0.0) - phi, before + max(turn, 0.0) + phi
    if not ring.concave[v]:
        return [(right, 0.5 * (right + left)), (0.5 * (right + left), left)]
    if left - right < math.pi:
        return [(right, left)]
    thirds = np.linspace(0.0, 2.0 * math.pi, 4).tolist()
    return list(pairwise(thirds))


def two_finger_jams(ring: Ring, hand: Floats, sample: Sample, below: float) -> Floats:
    """Hands (k, 3, 2) smaller than a level whose forces run along the line of two contacts."""
    z = hand[:, 0] + 1j * hand[:, 1]
    p = sample.point @ [1.0, 1.0j]
    gap = p[None, :] - p[:, None]
    angle = np.angle(gap)
    pushes = np.abs(_wrapped(angle - sample.middle[:, None])) <= sample.half[:, None] + SLACK
    resists = np.abs(_wrapped(angle + np.pi - sample.middle[None])) <= sample.half[None] + SLACK
    found: list[Floats] = []
    for i, j in combinations(range(len(z)), 2):
        for a, b in ((i, j), (j, i)):
            side = z[b] - z[a]
            use = pushes & resists & (np.abs(gap) < below * abs(side)) & (np.abs(gap) > 0.0)
            first, second = np.nonzero(use)
            w = gap[first, second] / side
            f = (p[first] - w * z[a])[:, None] + w[:, None] * z
            third = f[:, 3 - i - j]
            free = ~shapely.contains_xy(ring.polygon, third.real, third.imag)
            found.append(np.stack([f.real, f.imag], axis=2)[free])
    return np.concatenate(found)


def three_finger_jams(ring: Ring, hand: Floats, sample: Sample, mu: float, below: float) -> Floats:
    """Hands (k, 3, 2): a finger on a sampled point, the others wherever they reach two edges."""
    z = hand[:, 0] + 1j * hand[:, 1]
    phi = math.atan(mu)
    start = ring.starts @ [1.0, 1.0j]
    side = (ring.ends - ring.starts) @ [1.0, 1.0j]
    inward = np.angle(-(ring.normals @ [1.0, 1.0j]))
    p = sample.point @ [1.0, 1.0j]
    e, g = (edge.ravel() for edge in np.meshgrid(range(len(ring)), range(len(ring))))
    found: list[Floats] = []
    for a, b, c in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        ratio = (z[c] - z[a]) / (z[b] - z[a])
        # p + ratio (start_e + s side_e - p) = start_g + u side_g
        m1, m2 = ratio * side[e], -side[g]
        det = m1.real * m2.imag - m1.imag * m2.real
        flat = np.abs(det) < 1e-9 * np.abs(m1) * np.abs(m2)
        det = np.where(flat, np.nan, det)
        rhs = start[g] - (p[:, None] * (1.0 - ratio) + ratio * start[e])
        s = (rhs.real * m2.imag - rhs.imag * m2.real) / det
        u = (m1.real * rhs.imag - m1.imag * rhs.real) / det
        fb = start[e] + s * side[e]
        sigma = np.abs((fb - p[:, None]) / (z[b] - z[a]))
        at, pair = np.nonzero(
            (s >= 0.0) & (s <= 1.0) & (u >= 0.0) & (u <= 1.0) & (sigma < below) & (sigma > 0.0)
        )
        if not len(at):
            continue
        f = np.empty((len(at), 3), dtype=np.complex128)
        f[:, a], f[:, b] = p[at], fb[at, pair]
        f[:, c] = start[g[pair]] + u[at, pair] * side[g[pair]]
        cones = np.empty((len(at), 3, 2))
        cones[:, a] = sample.middle[at, None] + sample.half[at, None] * [-1.0, 1.0]
        cones[:, b] = inward[e[pair], None] + phi * np.array([-1.0, 1.0])
        cones[:, c] = inward[g[pair], None] + phi * np.array([-1.0, 1.0])
        found.append(np.stack([f.real, f.imag], axis=2)[squeezes(f, cones, ring.diameter)])
    return np.concatenate(found) if found else np.empty((0, 3, 2))


def squeezes(f: Floats, cones: Floats, diameter: float) -> np.ndarray:
    """Whether forces in the cones (n, 3, 2) [rad] on fingers (n, 3) balance and squeeze, (n,)."""
    return squeezing(_generators(f, cones, diameter))


def _generators(f: Floats, cones: Floats, diameter: float) -> Floats:
    """(n, 5, 6): force, torque, one, and the work of opening, for both edges of every cone."""
    force = np.exp(1j * cones)
    arm = ((f - f.mean(axis=1, keepdims=True)) / diameter)[..., None]
    rows = [force.real, force.imag, (np.conj(arm) * force).imag, np.ones(force.shape)]
    rows.append((np.conj(arm) * force).real)
    return np.stack([row.reshape(len(f), 6) for row in rows], axis=1)


def residual(ring: Ring, contacts: Floats, mu: float, off: float) -> float:
    """How badly the best squeezing forces at contacts (3, 2) balance, [1]: 0 for a jam.

    A finger within ``off`` [unit] of an edge may push there, within ``off`` of a vertex there.
    The forces do unit work. Linear programs: least size of the force and torque left over.
    """
    phi = math.atan(mu)
    choices: list[list[list[float]]] = []
    for point in contacts:
        near = np.flatnonzero(ring.nearest_on_edges(point)[1] <= off)
        normals = [math.atan2(-ring.normals[k, 1], -ring.normals[k, 0]) for k in near]
        cones = [[n - phi, n + phi] for n in normals]
        at = np.flatnonzero(np.hypot(*(ring.vertices - point).T) <= off)
        if len(at) and not ring.concave[at[0]]:
            choices.append([list(cone) for cone in vertex_cones(ring, int(at[0]), phi)])
        else:  # both edges of a concave vertex push at once
            choices.append([[edge for cone in cones for edge in cone]])
    return min(_left_over(contacts, ring.diameter, list(chosen)) for chosen in product(*choices))


def _left_over(contacts: Floats, diameter: float, cones: list[list[float]]) -> float:
    centre = contacts.mean(axis=0)
    columns: list[list[float]] = []
    for point, directions in zip(contacts, cones, strict=True):
        arm = (point - centre) / diameter
        for x, y in ((math.cos(a), math.sin(a)) for a in directions):
            columns.append([x, y, arm[0] * y - arm[1] * x, -(arm[0] * x + arm[1] * y)])
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


def _wrapped(angle: Floats) -> Floats:
    return (angle + np.pi) % (2.0 * np.pi) - np.pi
