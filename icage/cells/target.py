"""The target: the strict local minimum of sigma next to the contacts that were asked for.

Each cell that holds a local minimum has it as its own least point (sigma is convex on a cell), so
being a local minimum is decided by the few cells round the contacts, with no descent.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from icage.arrays import FloatArray, IntArray
from icage.cells.free_space import Configuration, FreeSpace, Search, search
from icage.cells.kernels.columns import BIRTH_SIGMA, BIRTH_WX, BIRTH_WY, BORN_FINGER, BORN_SLOT
from icage.cells.kernels.tree import births
from icage.cells.largest_sigma import opens_to
from icage.errors import GeometryError
from icage.geometry.exterior import Pieces
from icage.hand import HandShape
from icage.tolerance import (
    DEPTH_CUT,
    NOT_A_CAGE,
    PLATEAU,
    SAME_POINT,
    SLIDE_GIVE,
    TARGET_SHIFT,
    TARGET_TURN,
)

_MAX_CELLS = 2_000_000
"""Cells round a target that fit into 200 MB; a vertex of a fine fan has some tens of pieces."""


@dataclass(frozen=True, slots=True)
class Target:
    """A local minimum, the cell to start from, and how far it is from what was asked."""

    at: Configuration
    cell: IntArray
    sigma_0: float
    moved: float
    turned: float
    plateau: tuple[Configuration, Configuration] | None


def pieces_near(pieces: Pieces, point: complex, reach: float) -> IntArray:
    """Pieces that have a point within about ``reach`` of the given one (relative coordinates)."""
    a = pieces.slot_vertex
    inside = pieces.normal_x * (point.real - pieces.x[a]) + pieces.normal_y * (
        point.imag - pieces.y[a]
    )
    worst = np.minimum.reduceat(inside, pieces.ptr[:-1])
    rough = np.flatnonzero(worst >= -reach)
    if not len(rough):
        return rough
    # half planes alone accept far too much beyond the tip of a sliver: take the true distance
    x, y = pieces.x, pieces.y
    b = _slot_end(pieces)
    side_x, side_y = x[b] - x[a], y[b] - y[a]
    t = ((point.real - x[a]) * side_x + (point.imag - y[a]) * side_y) / (side_x**2 + side_y**2)
    t = np.clip(t, 0.0, 1.0)
    gap = np.hypot(x[a] + t * side_x - point.real, y[a] + t * side_y - point.imag)
    nearest = np.minimum.reduceat(gap, pieces.ptr[:-1])
    return rough[(worst[rough] >= 0.0) | (nearest[rough] <= reach)]


def _slot_end(pieces: Pieces) -> IntArray:
    """End vertex of every slot."""
    after = np.arange(1, len(pieces.slot_vertex) + 1)
    after[pieces.ptr[1:] - 1] = pieces.ptr[:-1]
    return pieces.slot_vertex[after]


def cells_near(free_space: FreeSpace, at: Configuration, reach: float) -> IntArray:
    """All cells (k, 3) whose pieces come within ``reach`` of the fingers.

    Raises
    ------
    GeometryError:
        They are more than ``_MAX_CELLS``: to leave some out could miss the way to close further.
    """
    near: list[IntArray] = []
    for finger in free_space.fingers(at):
        found = pieces_near(free_space.pieces, complex(finger), reach)
        if not len(found):  # a configuration solved in doubles may sit this little inside a wall
            found = pieces_near(free_space.pieces, complex(finger), 100.0 * reach)
        near.append(found)
    total = math.prod(len(n) for n in near)
    if total > _MAX_CELLS:
        raise GeometryError(f"{total} cells meet round the contacts; at most {_MAX_CELLS} fit")
    return np.stack(np.meshgrid(*near, indexing="ij"), axis=-1).reshape(-1, 3).astype(np.int64)


def shift_between(hand: HandShape, a: Configuration, b: Configuration) -> float:
    """Largest distance that a finger moves from one configuration to the other."""
    return float(np.abs((b.d - a.d) + (b.w - a.w) * hand.z).max())


def turn_between(a: Configuration, b: Configuration) -> float:
    """Angle between two configurations, [rad]."""
    return abs(float(np.angle(b.w * np.conj(a.w)))) if a.w and b.w else 0.0


def find_target(
    free_space: FreeSpace,
    wanted: Configuration,
    *,
    reach: float = TARGET_SHIFT,
    turn: float = TARGET_TURN,
) -> Target | None:
    """The local minimum nearest to a configuration, or None if there is none within ``reach``.

    ``reach`` [diameter] bounds how far a finger may be from where it was asked to be.
    """
    size = free_space.pieces.diameter
    cut = DEPTH_CUT * size
    cells = cells_near(free_space, wanted, reach * size)
    if not len(cells):
        return None
    value, at = births(free_space.pieces, free_space.z, cells, free_space.cap, free_space.worst)
    best: Target | None = None
    near: list[Target] = []
    shut: Search | None = None
    for k in np.argsort(value[:, BIRTH_SIGMA], kind="stable"):
        if not 0.0 < value[k, BIRTH_SIGMA] < np.inf:
            continue
        finger, slot = int(at[k, BORN_FINGER]), int(at[k, BORN_SLOT])
        ends = free_space.on_edge(cells[k], finger, slot, value[k, BIRTH_WX], value[k, BIRTH_WY])
        here = nearest_on(ends, wanted)
        if abs(here.w - wanted.w) <= reach * size < abs(here.d - wanted.d):
            # the same hand elsewhere: perhaps on a plateau that runs through where it should be
            here = _slid_to(free_space, cells[k], here, wanted)
        moved = shift_between(free_space.hand, wanted, here) / size
        turned = turn_between(wanted, here)
        if moved > reach or turned > turn:
            continue
        near.append(Target(here, cells[k], float(value[k, BIRTH_SIGMA]), moved, turned, None))
        # hundreds of cells may meet in one point, as at the centre of an arc: it is looked at once
        if best is not None and moved >= best.moved - SAME_POINT:
            continue
        if is_local_minimum(free_space, here, float(value[k, BIRTH_SIGMA])):
            ends = plateau_through(free_space, here, float(value[k, BIRTH_SIGMA]))
            around = search(
                free_space,
                cells[k],
                float(value[k, BIRTH_SIGMA]),
                stop_above=value[k, BIRTH_SIGMA] + cut,
            )
            if ends is None and not _has_depth(around, float(value[k, BIRTH_SIGMA])):
                continue
            shut = around if _isolated(around, float(value[k, BIRTH_SIGMA])) else None
            best = Target(here, cells[k], float(value[k, BIRTH_SIGMA]), moved, turned, ends)
    return best if shut is None else _not_isolated(free_space, near, shut) or best


def _isolated(around: Search, sigma: float) -> bool:
    """Whether a hand of this least sigma can do nothing; ``around`` is the search up to the cut."""
    return around.never_escapes and not opens_to(around, sigma * (1.0 + NOT_A_CAGE))


def _not_isolated(free_space: FreeSpace, near: list[Target], shut: Search) -> Target | None:
    """The nearest minimum that can open, of the least points of cells.

    Where more fingers are held than are needed, rounding of the hand's shape may leave a point of
    free space behind, shut off from the minimum that it was and lower by a little. ``shut`` is the
    search of that point; whoever lies in it, or in another like it, is not looked at again.
    """
    seen = _cells_of(shut)
    for target in sorted(near, key=lambda t: (t.moved, t.sigma_0)):
        if tuple(target.cell.tolist()) in seen:
            continue
        top = target.sigma_0 + DEPTH_CUT * free_space.pieces.diameter
        around = search(free_space, target.cell, target.sigma_0, stop_above=top)
        if _isolated(around, target.sigma_0):
            seen |= _cells_of(around)
        elif _has_depth(around, target.sigma_0):
            return replace(target, plateau=plateau_through(free_space, target.at, target.sigma_0))
    return None


def _cells_of(found: Search) -> set[tuple[int, ...]]:
    return {tuple(row) for row in found.nodes[:, :3].tolist()}


def _slid_to(
    free_space: FreeSpace, cell: IntArray, here: Configuration, wanted: Configuration
) -> Configuration:
    """The translation of ``here`` inside its cell that is nearest to the wanted configuration."""
    corners = translations(free_space, cell, here.w)
    if not corners:
        return here
    far = max(corners, key=lambda d: abs(d - here.d))
    back = max(corners, key=lambda d: abs(d - far))
    return nearest_on((Configuration(far, here.w), Configuration(back, here.w)), wanted)


def nearest_on(ends: tuple[Configuration, Configuration], wanted: Configuration) -> Configuration:
    """The configuration between two (same w) whose finger 1 is nearest to the wanted one's."""
    a, b = ends
    side = b.d - a.d
    if abs(side) == 0.0:
        return a
    t = ((wanted.d - a.d) * np.conj(side)).real / abs(side) ** 2
    return Configuration(a.d + float(np.clip(t, 0.0, 1.0)) * side, a.w)


def is_local_minimum(free_space: FreeSpace, here: Configuration, sigma: float) -> bool:
    """Whether no cell round the configuration goes deeper by more than the depth cut."""
    size = free_space.pieces.diameter
    cells = cells_near(free_space, here, SAME_POINT * size)
    value, _ = births(free_space.pieces, free_space.z, cells, free_space.cap, free_space.worst)
    return bool(value[:, BIRTH_SIGMA].min() >= sigma - DEPTH_CUT * size)


def _has_depth(around: Search, sigma: float) -> bool:
    """Whether a hand of this least sigma must open by more than the depth cut to close further.

    ``around`` is the search up to the cut. A minimum that is less deep does not
    count. [docs/formats.md, Tolerances]
    """
    if around.escaped:
        return False
    free_space = around.free_space
    value, _ = births(
        free_space.pieces, free_space.z, around.nodes, free_space.cap, free_space.worst
    )
    return bool(value[:, BIRTH_SIGMA].min() >= sigma - DEPTH_CUT * free_space.pieces.diameter)


def plateau_through(
    free_space: FreeSpace, here: Configuration, sigma: float
) -> tuple[Configuration, Configuration] | None:
    """Ends of the translations at constant sigma through a minimum (opposing parallel edges).

    The hand keeps w, so the set is a segment of d; it is followed from cell to cell.
    """
    size = free_space.pieces.diameter
    ends = [here, here]
    for side in range(2):
        for _ in range(10 * free_space.pieces.total):
            best = ends[side]
            cells = cells_near(free_space, best, SAME_POINT * size)
            low, _ = births(
                free_space.pieces, free_space.z, cells, free_space.cap, free_space.worst
            )
            # beyond the end of a plateau the hand may close further: not a part of it
            for cell in cells[np.abs(low[:, BIRTH_SIGMA] - sigma) <= DEPTH_CUT * size]:
                for d in translations(free_space, cell, here.w):
                    if _further(here, ends[1 - side], best, d, PLATEAU * size):
                        best = Configuration(d, here.w)
            if best is ends[side]:
                break
            ends[side] = best
    if abs(ends[0].d - ends[1].d) <= PLATEAU * size:
        return None
    return ends[0], ends[1]


def translations(free_space: FreeSpace, cell: IntArray, w: complex) -> list[complex]:
    """Corners d of the convex set of hands in a cell that have this very w, to SLIDE_GIVE."""
    pieces, z = free_space.pieces, free_space.hand.z
    give = SLIDE_GIVE * pieces.diameter
    corners: list[complex] = []
    for finger, k in enumerate(cell.tolist()):
        s = slice(int(pieces.ptr[k]), int(pieces.ptr[k + 1]))
        v = pieces.slot_vertex[s]
        ring = (pieces.x[v] + 1j * pieces.y[v] - w * z[finger]).tolist()
        normals = (pieces.normal_x[s] + 1j * pieces.normal_y[s]).tolist()
        if finger == 0:
            corners = ring
            continue
        for a, n in zip(ring, normals, strict=True):
            corners = _cut(corners, a, n, give)
    return corners


def _cut(corners: list[complex], a: complex, n: complex, give: float) -> list[complex]:
    """The part of a convex polygon on the free side of the line through a, or ``give`` beyond."""
    inside = [((c - a) * n.conjugate()).real + give for c in corners]
    kept: list[complex] = []
    for k, (p, u) in enumerate(zip(corners, inside, strict=True)):
        q, v = corners[(k + 1) % len(corners)], inside[(k + 1) % len(corners)]
        if u >= 0.0:
            kept.append(p)
        if (u > 0.0 > v) or (v > 0.0 > u):
            kept.append(p + u / (u - v) * (q - p))
    return kept


def _further(
    here: Configuration, other: Configuration, best: Configuration, d: complex, reach: float
) -> bool:
    """Whether d lies further from ``here`` than ``best``, on the side away from ``other``."""
    if abs(d - here.d) <= abs(best.d - here.d) + reach:
        return False
    return ((d - here.d) * np.conj(other.d - here.d)).real <= 0.0


def contacts_as_configuration(free_space: FreeSpace, contacts: FloatArray) -> Configuration:
    """The configuration whose fingers 1 and 2 are at the first two contacts."""
    d = complex(*(contacts[0] - free_space.origin))
    return Configuration(d, complex(*(contacts[1] - contacts[0])))
