"""Everything about one target in the plane around one polygon, for point fingers.

This is the exact part; disc fingers and the value types that users see are built on it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from icage.arrays import ComplexArray, FloatArray, IntArray
from icage.cells.kernels.facet import MAX_BASE, finger_on_segment
from icage.cells.kernels.search import CLOSED_IN, ESCAPED, GAVE_UP, explore
from icage.cells.kernels.tree import births, merge
from icage.geometry.exterior import Pieces, exterior_pieces, largest_sigma
from icage.hand import HandShape
from icage.outline import Outline
from icage.tolerance import DEPTH_CUT, LEVEL, PASS_ERROR

CELL_LIMIT = 5_000_000
"""Cells visited before the search gives up: about 1 GB."""


class Configuration(NamedTuple):
    """A hand in the plane: finger k at d + w z_k, relative to the pieces' origin."""

    d: complex
    w: complex


@dataclass(frozen=True, slots=True)
class FreeSpace:
    """The free plane of one polygon cut into pieces, for one hand."""

    outline: Outline
    hand: HandShape
    pieces: Pieces
    origin: FloatArray
    z: FloatArray
    cap: float
    worst: float

    @classmethod
    def around(cls, outline: Outline, hand: HandShape, *, merge: bool = True) -> FreeSpace:
        """Cut the plane around the outline; ``merge=False`` keeps raw triangles."""
        pieces, origin = exterior_pieces(outline, hand, merge=merge)
        return cls.of_pieces(outline, hand, pieces, origin)

    @classmethod
    def of_pieces(
        cls, outline: Outline, hand: HandShape, pieces: Pieces, origin: FloatArray
    ) -> FreeSpace:
        """A free space on pieces cut before (for a hand with at least this box)."""
        z = np.ascontiguousarray(hand.unit_fingers)
        cap = largest_sigma(outline.diameter, hand)
        return cls(outline, hand, pieces, origin, z, cap, PASS_ERROR * outline.diameter)

    def fingers(self, at: Configuration) -> ComplexArray:
        """The three fingers of a configuration, (3,), relative to the origin."""
        return at.d + at.w * self.hand.z

    def contacts(self, at: Configuration) -> FloatArray:
        """The three fingers in the object's frame, (3, 2)."""
        f = self.fingers(at)
        return np.column_stack([f.real, f.imag]) + self.origin

    def placement(self, at: Configuration) -> FloatArray:
        """(4,) = x, y, theta, sigma in the object's frame."""
        x, y = self.origin
        return np.array([at.d.real + x, at.d.imag + y, np.angle(at.w), abs(at.w)])

    def on_edge(
        self, cell: IntArray, finger: int, slot: int, wx: float, wy: float
    ) -> tuple[Configuration, Configuration]:
        """Both ends of the configurations (one, unless a plateau) of least sigma on an edge."""
        i, j, k = finger, (finger + 1) % 3, (finger + 2) % 3
        ptr, vertex = self.pieces.ptr, self.pieces.slot_vertex
        after = slot + 1 if slot + 1 < ptr[cell[i] + 1] else ptr[cell[i]]
        x_a, y_a, x_b, y_b = finger_on_segment(
            self.pieces,
            self.z,
            i,
            vertex[slot],
            vertex[after],
            j,
            cell[j],
            k,
            cell[k],
            wx,
            wy,
            np.empty((MAX_BASE, 5)),
        )
        w = complex(wx, wy)
        shift = w * self.hand.z[i]
        first = complex(x_a, y_a) - shift
        last = complex(x_b, y_b) - shift
        return Configuration(first, w), Configuration(last, w)


@dataclass(frozen=True, slots=True)
class Search:
    """What a best-first search from the target's cell has found."""

    free_space: FreeSpace
    sigma_0: float
    outcome: int
    level: float
    """sigma_max, or inf if the hand never escapes."""
    standing: int
    """Finger (0..2) that the others can shrink to at the end, -1 if all are in one piece."""
    nodes: IntArray
    node_level: FloatArray
    edges: IntArray
    edge_value: FloatArray
    records: FloatArray
    tally: IntArray
    keys: IntArray
    values: IntArray

    @property
    def escaped(self) -> bool:
        """Whether a pinched hand was reached."""
        return self.outcome == ESCAPED

    @property
    def gave_up(self) -> bool:
        """Whether the search hit its limit of cells."""
        return self.outcome == GAVE_UP

    @property
    def never_escapes(self) -> bool:
        """Whether every cell in reach was visited without a way out."""
        return self.outcome == CLOSED_IN and self.level == np.inf

    def sigma_first(self, depth: float = DEPTH_CUT) -> float:
        """First level at which a basin deeper than ``depth`` [diameter], or the escape, is met.

        Basins met at the escape level itself belong to the escape, as in ``merge_tree``.
        """
        cut = depth * self.free_space.pieces.diameter
        before = self.records[:, 0] < below_escape(self)
        deep = np.flatnonzero(before & (self.records[:, 0] - self.records[:, 1] > cut))
        return float(self.records[deep[0], 0]) if len(deep) else self.level

    def edge_configuration(self, edge: int) -> Configuration:
        """A configuration of least sigma on the facet of an edge (the middle of a plateau)."""
        cell = self.nodes[self.edges[edge, 0], :3]
        finger, slot = int(self.edges[edge, 2]), int(self.edges[edge, 3])
        _, wx, wy = self.edge_value[edge]
        a, b = self.free_space.on_edge(cell, finger, slot, wx, wy)
        return Configuration(0.5 * (a.d + b.d), a.w)


@dataclass(frozen=True, slots=True)
class Tree:
    """Births and merges of the visited cells below the escape."""

    birth: FloatArray
    """(n, 3) = least sigma, w_x, w_y."""
    birth_at: IntArray
    """(n, 2) = finger, slot."""
    parent: IntArray
    stamp: FloatArray
    merges: IntArray
    lows: FloatArray


def search(
    free_space: FreeSpace,
    cell: IntArray,
    sigma_0: float,
    *,
    stop_above: float = np.inf,
    limit: int = CELL_LIMIT,
) -> Search:
    """Visit the cells around the target's in ascending order of the pass to them."""
    outcome, level, standing, *arrays = explore(
        free_space.pieces, free_space.z, np.asarray(cell, dtype=np.int64), sigma_0,
        free_space.cap, free_space.worst, stop_above, limit,
    )  # fmt: skip
    return Search(free_space, sigma_0, int(outcome), float(level), int(standing), *arrays)


def merge_tree(found: Search) -> Tree:
    """Minima and merges of the component of the target just below the escape.

    Passes at the escape level itself belong to the escape. Complexity: a sort of the passes.
    """
    free_space = found.free_space
    inside = inside_cells(found)
    birth, birth_at = births(
        free_space.pieces, free_space.z, found.nodes[:inside], free_space.cap, free_space.worst
    )
    usable = (found.edges[:, 0] < inside) & (found.edges[:, 1] < inside)
    edges = np.where(usable[:, None], found.edges, -1)
    value = np.where(usable, found.edge_value[:, 0], np.inf)
    parent, stamp, merges, lows = merge(birth[:, 0], edges, value, below_escape(found))
    return Tree(birth, birth_at, parent, stamp, merges, lows)


def below_escape(found: Search) -> float:
    """The level just below sigma_max (inf if the hand never escapes)."""
    return found.level * (1.0 - 2.0 * LEVEL)


def inside_cells(found: Search) -> int:
    """How many of the nodes (they come in order of entry) are reached below the escape level."""
    if found.level == np.inf:
        return len(found.nodes)
    return max(1, int(np.searchsorted(found.node_level, below_escape(found))))
