"""Everything about one target in the plane around one polygon, for point fingers.

This is the exact part; disc fingers and the value types that users see are built on it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from icage.arrays import ComplexArray, FloatArray, IntArray
from icage.cells.kernels.columns import (
    BIRTH_SIGMA,
    EDGE_FINGER,
    EDGE_FROM,
    EDGE_SLOT,
    EDGE_TO,
    MERGE_EDGE,
    PASS_SIGMA,
    PASS_WX,
    RECORD_BIRTH,
    RECORD_LEVEL,
    Ending,
)
from icage.cells.kernels.facet import ends_on_facet, middles_on_facets
from icage.cells.kernels.search import explore
from icage.cells.kernels.tree import merge, visited_births
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
        pieces = np.ascontiguousarray(cell, dtype=np.int64)
        ends = ends_on_facet(self.pieces, self.z, pieces, finger, slot, wx, wy)
        w = complex(wx, wy)
        shift = w * self.hand.z[finger]
        first = complex(ends.x_lo, ends.y_lo) - shift
        last = complex(ends.x_hi, ends.y_hi) - shift
        return Configuration(first, w), Configuration(last, w)


@dataclass(frozen=True, slots=True)
class Search:
    """What a best-first search from the target's cell has found."""

    free_space: FreeSpace
    sigma_0: float
    outcome: Ending
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
    def cells(self) -> IntArray:
        """(k, fingers) pieces of every node."""
        return self.nodes[:, : len(self.free_space.z)]

    @property
    def escaped(self) -> bool:
        """Whether a pinched hand was reached."""
        return self.outcome == Ending.ESCAPED

    @property
    def gave_up(self) -> bool:
        """Whether the search hit its limit of cells."""
        return self.outcome == Ending.GAVE_UP

    @property
    def never_escapes(self) -> bool:
        """Whether every cell in reach was visited without a way out."""
        return self.outcome == Ending.CLOSED_IN and self.level == np.inf

    def sigma_first(self, depth: float = DEPTH_CUT) -> float:
        """First level at which a basin deeper than ``depth`` [diameter], or the escape, is met.

        Basins met at the escape level itself belong to the escape, as in ``merge_tree``.
        """
        cut = depth * self.free_space.pieces.diameter
        level, birth = self.records[:, RECORD_LEVEL], self.records[:, RECORD_BIRTH]
        deep = np.flatnonzero((level < below_escape(self)) & (level - birth > cut))
        return float(level[deep[0]]) if len(deep) else self.level

    def edge_configuration(self, edge: int) -> Configuration:
        """A configuration of least sigma on the facet of an edge (the middle of a plateau)."""
        return self.edge_configurations([edge])[0]

    def edge_configurations(self, edges: list[int] | IntArray) -> list[Configuration]:
        """The same for several edges."""
        which = np.array(edges, dtype=np.int64)
        rows = self.edges[which]
        middle = middles_on_facets(
            self.free_space.pieces, self.free_space.z, self.nodes[rows[:, EDGE_FROM]],
            rows[:, EDGE_FINGER], rows[:, EDGE_SLOT], self.edge_value[which, PASS_WX:],
        )  # fmt: skip
        return [Configuration(complex(*m[:2]), complex(*m[2:])) for m in middle.tolist()]


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
    """(m, 4) = surviving and swallowed minimum (nodes), edge, ``StartSide``."""
    lows: FloatArray
    """(m, 2) = level, level - birth of the swallowed minimum."""


def search(
    free_space: FreeSpace,
    cell: IntArray,
    sigma_0: float,
    *,
    stop_above: float = np.inf,
    limit: int = CELL_LIMIT,
) -> Search:
    """Visit the cells around the target's in ascending order of the pass to them."""
    found = explore(
        free_space.pieces, free_space.z, np.asarray(cell, dtype=np.int64), sigma_0,
        free_space.cap, free_space.worst, stop_above, limit, np.inf,
    )  # fmt: skip
    return Search(
        free_space=free_space,
        sigma_0=sigma_0,
        outcome=Ending(found.outcome),
        level=float(found.level),
        standing=int(found.standing),
        nodes=found.nodes,
        node_level=found.node_level,
        edges=found.edges,
        edge_value=found.edge_value,
        records=found.records,
        tally=found.tally,
        keys=found.keys,
        values=found.values,
    )


def merge_tree(found: Search) -> Tree:
    """Minima and merges of the component of the target just below the escape.

    Passes at the escape level itself belong to the escape. Complexity: a sort of the passes.
    """
    free_space = found.free_space
    inside = inside_cells(found)
    born = visited_births(
        free_space.pieces, free_space.z, found.nodes[:inside], found.edges, found.edge_value,
        free_space.cap, free_space.worst,
    )  # fmt: skip
    ends = found.edges[:, EDGE_FROM], found.edges[:, EDGE_TO]
    below = below_escape(found)
    sigma = found.edge_value[:, PASS_SIGMA]
    used = np.flatnonzero(
        (ends[0] < inside) & (ends[1] < inside) & (ends[1] >= 0) & (sigma < below)
    )
    joined = merge(born.value[:, BIRTH_SIGMA].copy(), found.edges[used], sigma[used], below)
    joined.merges[:, MERGE_EDGE] = used[joined.merges[:, MERGE_EDGE]]
    return Tree(
        birth=born.value,
        birth_at=born.where,
        parent=joined.parent,
        stamp=joined.stamp,
        merges=joined.merges,
        lows=joined.lows,
    )


def below_escape(found: Search) -> float:
    """The level just below sigma_max (inf if the hand never escapes)."""
    return found.level * (1.0 - 2.0 * LEVEL)


def inside_cells(found: Search) -> int:
    """How many of the nodes (they come in order of entry) are reached below the escape level."""
    if found.level == np.inf:
        return len(found.nodes)
    return max(1, int(np.searchsorted(found.node_level, below_escape(found))))
