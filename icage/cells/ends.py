"""Where closing may end: the minima that hands below a level can come to, on given pieces. Our own.

[docs/theory.md, Sec. 2.8]
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from icage.arrays import ComplexArray, FloatArray, IntArray
from icage.cells.free_space import CELL_LIMIT, FreeSpace
from icage.cells.kernels.columns import (
    BIRTH_SIGMA,
    BIRTH_WX,
    BORN_FINGER,
    BORN_SLOT,
    EDGE_TO,
    LOW_DEPTH,
    LOW_LEVEL,
    MERGE_KEEP,
    MERGE_LOSE,
    PASS_SIGMA,
    Ending,
)
from icage.cells.kernels.facet import middles_on_facets
from icage.cells.kernels.search import Explored, explore
from icage.cells.kernels.tree import Births, Merges, births, find_at, merge, visited_births
from icage.kernels.locate import nodes_of
from icage.tolerance import DEPTH_CUT


class Bottom(NamedTuple):
    """A local minimum: its size [unit], and finger 1 ``d`` (k,) of its hands with their ``w`` (k,).

    More than one hand only where parallel edges let it slide. Of a pinched hand there is none.
    """

    sigma: float
    d: ComplexArray
    w: ComplexArray


class Meeting(NamedTuple):
    """The components of two minima meet at a level [unit]; the second, higher one ends there."""

    keep: int
    lose: int
    level: float


class Ends(NamedTuple):
    """One component of the hands below a level.

    Attributes
    ----------
    least:
        [unit] Least size of a hand in the cells that were asked for.
    bottoms:
        The minima in it.
    meetings:
        Which of them meet where, ascending.
    escape:
        [unit] The level at which the object can escape, inf if it cannot.
    """

    least: float
    bottoms: tuple[Bottom, ...]
    meetings: tuple[Meeting, ...]
    escape: float


def ends_below(free_space: FreeSpace, cells: IntArray, top: float, depth: float) -> Iterator[Ends]:
    """The components below ``top`` [unit] that hold a part of some cells (n, fingers).

    Minima count that are deeper than ``depth`` [unit].
    """
    left = np.ascontiguousarray(cells)
    # the first is the target's own, which as a rule leads to all the others
    for most in (1, len(left)):
        some = left[:most]
        least = _least(free_space, some)
        for row in np.argsort(least, kind="stable").tolist():
            if not least[row] < top:
                break
            if not (left == some[row]).all(axis=1).any():
                continue
            found = explore(
                free_space.pieces, free_space.z, some[row], least[row], free_space.cap,
                free_space.worst, top, CELL_LIMIT, np.inf,
            )  # fmt: skip
            total, count = free_space.pieces.total, len(found.nodes)
            left = left[nodes_of(found.keys, found.values, left, total, count) < 0]
            yield _ends(free_space, found, float(least[row]), top, depth)


def _least(free_space: FreeSpace, cells: IntArray) -> FloatArray:
    """Least sigma (n,) of cells."""
    found = births(free_space.pieces, free_space.z, cells, free_space.cap, free_space.worst)
    return found.value[:, BIRTH_SIGMA]


def _ends(free_space: FreeSpace, found: Explored, least: float, top: float, depth: float) -> Ends:
    pieces, z = free_space.pieces, free_space.z
    born = visited_births(
        pieces, z, found.nodes, found.edges, found.edge_value, free_space.cap, free_space.worst
    )
    low: FloatArray = born.value[:, BIRTH_SIGMA]
    sigma = found.edge_value[:, PASS_SIGMA]
    used = (found.edges[:, EDGE_TO] >= 0) & (sigma < top)
    tree = merge(low.copy(), found.edges[used], sigma[used], top)
    deep = tree.lows[:, LOW_DEPTH] > depth
    pairs = tree.merges[deep][:, [MERGE_KEEP, MERGE_LOSE]].tolist()
    nodes = sorted({int(np.argmin(low)), *(node for pair in pairs for node in pair)})
    place = {node: k for k, node in enumerate(nodes)}
    level = np.inf if found.outcome != Ending.ESCAPED else float(found.level)
    return Ends(
        least,
        tuple(_bottom(free_space, found, born, tree, node) for node in nodes),
        tuple(
            Meeting(place[keep], place[lose], at)
            for (keep, lose), at in zip(pairs, tree.lows[deep, LOW_LEVEL].tolist(), strict=True)
        ),
        level,
    )


def _bottom(
    free_space: FreeSpace, found: Explored, born: Births, tree: Merges, node: int
) -> Bottom:
    """The least hands of a cell, and those of all cells that it slides to."""
    pieces = free_space.pieces
    low: FloatArray = born.value[:, BIRTH_SIGMA]
    top = low[node] + DEPTH_CUT * pieces.diameter
    own = find_at(tree.parent, tree.stamp, node, top)
    beside = np.flatnonzero((low <= top) & (born.where[:, BORN_FINGER] >= 0))
    beside = np.array(
        [k for k in beside.tolist() if find_at(tree.parent, tree.stamp, k, top) == own], np.int64
    )
    hands = middles_on_facets(
        pieces, free_space.z, found.nodes[beside], born.where[beside, BORN_FINGER],
        born.where[beside, BORN_SLOT], born.value[beside, BIRTH_WX:],
    )  # fmt: skip
    return Bottom(float(low[node]), hands[:, 0] + 1j * hands[:, 1], hands[:, 2] + 1j * hands[:, 3])
