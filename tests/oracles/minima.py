"""All local minima of sigma of one hand with point fingers, by trying every set of contacts.

A minimum is held by forces on at most four contacts (Caratheodory in the four unknowns d, w), so
it is the least |w| on the lines of one of these sets: three edges; a concave vertex and an edge;
two concave vertices; a concave vertex and two edges; parallel edges (a plateau). Every set is
solved as a linear problem and then judged by its forces. Cubic in the number of edges: for small
polygons. Our own, next to [Bunis2018, Sec. IV-C].
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations, permutations, product

import numpy as np
import shapely
from numpy.typing import NDArray

from tests.oracles.geometry import Floats, Ring, fingers_of, row, size_of
from tests.oracles.planar_closing import close_hand
from tests.oracles.statics import is_strict_minimum, squeezing_forces

Contact = tuple[int, int]
"""(finger, edge): the finger is on the line of the edge."""


@dataclass(frozen=True, slots=True)
class Minimum:
    """A local minimum: configuration (4,), fingers (3, 2), sigma [unit]; or one of a plateau."""

    q: Floats
    contacts: Floats
    sigma: float
    plateau: bool


def all_minima(ring: Ring, hand: NDArray[np.complex128]) -> list[Minimum]:
    """Every local minimum of sigma, ascending; a plateau appears once."""
    found: list[Minimum] = []
    for contacts in _contact_sets(ring):
        q = _least_size(ring, hand, contacts)
        if q is None or not _on_its_edges(ring, hand, q, contacts):
            continue
        fingers = fingers_of(q, hand)
        if any(np.abs(fingers - m.contacts).max() < 1e-8 * ring.diameter for m in found):
            continue
        if is_strict_minimum(ring, fingers, margin=1e-9):
            found.append(Minimum(q, fingers, size_of(q), False))
    return sorted(found + _plateaus(ring, hand), key=lambda m: m.sigma)


def _contact_sets(ring: Ring) -> list[tuple[Contact, ...]]:
    edges = range(len(ring))
    corners = [((v - 1) % len(ring), v) for v in np.flatnonzero(ring.concave).tolist()]
    sets: list[tuple[Contact, ...]] = [
        ((0, a), (1, b), (2, c)) for a, b, c in product(edges, repeat=3)
    ]
    for i, j in permutations(range(3), 2):
        sets += [((i, a), (i, b), (j, e)) for a, b in corners for e in edges]
    for i, j in combinations(range(3), 2):
        sets += [((i, a), (i, b), (j, c), (j, d)) for a, b in corners for c, d in corners]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        sets += [
            ((i, a), (i, b), (j, e), (k, f)) for a, b in corners for e, f in product(edges, edges)
        ]
    return sets


def _least_size(
    ring: Ring, hand: NDArray[np.complex128], contacts: tuple[Contact, ...]
) -> Floats | None:
    """Configuration of least |w| with the fingers on these lines, or None (singular)."""
    rows = np.array([row(ring.normals[e], hand[k]) for k, e in contacts])
    level = np.array([ring.normals[e] @ ring.starts[e] for _, e in contacts])
    left, values, _ = np.linalg.svd(rows[:, :2])
    if values[1] < 1e-9:
        return None
    across = left[:, 2:].T  # combinations of the rows that do not see d
    w, _, rank, _ = np.linalg.lstsq(across @ rows[:, 2:], across @ level, rcond=1e-10)
    if rank < len(across) or not np.hypot(*w) > 1e-6 * ring.diameter:
        return None
    d = np.linalg.lstsq(rows[:, :2], level - rows[:, 2:] @ w, rcond=None)[0]
    return np.concatenate([d, w])


def _on_its_edges(
    ring: Ring, hand: NDArray[np.complex128], q: Floats, contacts: tuple[Contact, ...]
) -> bool:
    fingers = fingers_of(q, hand)
    slack = 1e-9 * ring.diameter
    for k, e in contacts:
        along = float((fingers[k] - ring.starts[e]) @ ring.tangents[e])
        if not -slack <= along <= ring.lengths[e] + slack:
            return False
    return True


def _plateaus(ring: Ring, hand: NDArray[np.complex128]) -> list[Minimum]:
    """Minima that slide between two opposing parallel edges, the third finger touching nothing."""
    found: list[Minimum] = []
    for a, b in permutations(range(len(ring)), 2):
        if float(ring.normals[a] @ ring.normals[b]) > -1.0 + 1e-12:
            continue
        thick = float((ring.starts[a] - ring.starts[b]) @ ring.normals[a])
        if thick <= 1e-9 * ring.diameter:
            continue
        for i, j in combinations(range(3), 2):
            for low, high in _slides(ring, hand, a, b, i, j, thick):
                middle = 0.5 * (low + high)
                if all(_holds(ring, hand, q) for q in (low, middle, high)):
                    found.append(_plateau(middle, hand))
    for edges in product(range(len(ring)), repeat=3):
        ends = _triple_slide(ring, hand, edges)
        if ends is not None and all(_holds(ring, hand, q) for q in (*ends, sum(ends) / 2.0)):
            found.append(_plateau(sum(ends) / 2.0, hand))
    return found


def _plateau(q: Floats, hand: NDArray[np.complex128]) -> Minimum:
    return Minimum(q, fingers_of(q, hand), size_of(q), True)


def _triple_slide(
    ring: Ring, hand: NDArray[np.complex128], edges: tuple[int, ...]
) -> tuple[Floats, Floats] | None:
    """Both ends of the slide with fingers 1, 2, 3 on three parallel edges, the forces balanced."""
    n = ring.normals[edges[0]]
    if any(abs(float(ring.tangents[edges[0]] @ ring.normals[e])) > 1e-12 for e in edges):
        return None
    level = np.array([float(ring.starts[e] @ n) for e in edges])
    arms = np.array([row(n, hand[k])[2:] for k in range(3)])
    matrix = arms[1:] - arms[0]
    if abs(np.linalg.det(matrix)) < 1e-9:
        return None
    w = np.linalg.solve(matrix, level[1:] - level[0])
    rows = np.array([row(ring.normals[e], hand[k]) for k, e in enumerate(edges)])
    if np.hypot(*w) < 1e-6 * ring.diameter or squeezing_forces(rows, w)[1] > 1e-7:
        return None
    t = ring.tangents[edges[0]]
    sides = np.array([row(t, hand[k])[2:] @ w for k in range(3)])  # along t, from d
    ends = np.array([sorted((ring.starts[e] @ t, ring.ends[e] @ t)) for e in edges])
    low, high = float((ends[:, 0] - sides).max()), float((ends[:, 1] - sides).min())
    if high - low <= 1e-9 * ring.diameter:
        return None
    across = (level[0] - float(arms[0] @ w)) * n
    return tuple(np.concatenate([across + s * t, w]) for s in (low, high))  # type: ignore[return-value]


def _slides(
    ring: Ring, hand: NDArray[np.complex128], a: int, b: int, i: int, j: int, thick: float
) -> list[tuple[Floats, Floats]]:
    """Both ends of the free slides with finger i on edge a and finger j on edge b."""
    n = complex(*ring.normals[a])
    w = -n * thick / complex(hand[j] - hand[i])
    way, here = ring.tangents[a], ring.starts[a]
    ends = sorted(float((p - here) @ way) for p in (ring.starts[b], ring.ends[b]))
    low, high = max(0.0, ends[0]), min(ring.lengths[a], ends[1])
    if high - low <= 1e-9 * ring.diameter:
        return []
    k = 3 - i - j
    arms = [w * complex(hand[m] - hand[i]) for m in (i, k)]
    offset = np.array([arms[1].real, arms[1].imag])
    third = shapely.LineString([here + low * way + offset, here + high * way + offset])
    free = third.difference(ring.polygon)
    shift = w * complex(hand[i])
    slides: list[tuple[Floats, Floats]] = []
    for part in shapely.get_parts(free):
        if part.geom_type != "LineString" or part.length <= 1e-9 * ring.diameter:
            continue
        first, last = (np.array(p) - offset for p in (part.coords[0], part.coords[-1]))
        slides.append(
            tuple(  # type: ignore[arg-type]
                np.array([p[0] - shift.real, p[1] - shift.imag, w.real, w.imag])
                for p in (first, last)
            )
        )
    return slides


def _holds(ring: Ring, hand: NDArray[np.complex128], q: Floats) -> bool:
    """Whether closing from here does not get smaller."""
    if max(ring.depth(p) for p in fingers_of(q, hand)) > 1e-9 * ring.diameter:
        return False
    return close_hand(ring, hand, q).sigma > size_of(q) - 1e-9 * ring.diameter
