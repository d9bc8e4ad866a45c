"""Loose ends of lines: which of them are one point, and where the others are. Our own."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final, NamedTuple

import numpy as np
from scipy.spatial import KDTree

from icage.arrays import FloatArray, IntArray
from icage.errors import FormatError

MAX_PAIRS: Final = 2_000_000
"""Pairs of ends within the gap."""


class Joined(NamedTuple):
    """Lines with their ends joined.

    Attributes
    ----------
    paths:
        The lines, each (k, 2); ends that are one point are equal to the last digit.
    loose:
        (m, 2) = ends that met no other.
    """

    paths: list[FloatArray]
    loose: FloatArray


def joined(paths: Sequence[FloatArray], gap: float) -> Joined:
    """Make one point of ends that are nearer to each other than ``gap``, the middle of them.

    Pairs are taken in the order of their distance, and only while one of the two is still loose.
    So many edges shorter than the gap, of a circle say, are not drawn together into one point.

    Raises
    ------
    FormatError:
        Too many ends are that near to each other.
    """
    open_ = [k for k, path in enumerate(paths) if not (path[0] == path[-1]).all()]
    if not open_:
        return Joined(list(paths), np.zeros((0, 2)))
    ends = np.vstack([paths[k][[0, -1]] for k in open_])
    places, where, degree = np.unique(ends, axis=0, return_inverse=True, return_counts=True)
    loose = degree == 1
    cluster = _clusters(places, loose, gap)
    count = np.bincount(cluster)
    middle = np.column_stack([np.bincount(cluster, column) for column in places.T])
    middle /= np.maximum(count, 1)[:, None]
    # A place alone in its cluster keeps its last digit.
    moved = np.where((count[cluster] > 1)[:, None], middle[cluster], places)[where.ravel()]
    result = list(paths)
    for row, k in enumerate(open_):
        result[k] = paths[k].copy()
        result[k][[0, -1]] = moved[2 * row : 2 * row + 2]
    alone = loose & (count[cluster] == 1)
    return Joined(result, places[alone])


def where_loose(loose: FloatArray) -> str:
    """How many ends are loose and where the nearest two are, in words."""
    if len(loose) < 2:
        return f"{len(loose)} loose end" + "s" * (len(loose) != 1)
    found: Any = KDTree(loose).query(loose, k=2)
    distances, others = found
    first = int(distances[:, 1].argmin())
    a, b = loose[first], loose[int(others[first, 1])]
    return (
        f"{len(loose)} loose ends, the nearest two {distances[first, 1]:.4g} apart, "
        f"at ({a[0]:.6g}, {a[1]:.6g}) and ({b[0]:.6g}, {b[1]:.6g})"
    )


def _clusters(places: FloatArray, loose: np.ndarray, gap: float) -> IntArray:
    """(n,) = the number of the cluster that each place belongs to."""
    tree, some = KDTree(places), np.flatnonzero(loose)
    parent = np.arange(len(places))
    if len(some):
        few = KDTree(places[some])
        if int(few.count_neighbors(tree, gap)) > MAX_PAIRS:
            raise FormatError(
                f"more than {MAX_PAIRS} pairs of ends of lines are nearer to each other than the "
                f"gap of {gap:.3g} units of the file; give a smaller gap"
            )
        found: Any = few.sparse_distance_matrix(tree, gap, output_type="ndarray")
        a, b = some[found["i"]], found["j"]
        order = np.argsort(found["v"], kind="stable")
        still = loose.copy()
        for i, j in zip(a[order].tolist(), b[order].tolist(), strict=True):
            if i != j and (still[i] or still[j]):
                parent[_root(parent, i)] = _root(parent, j)
                still[i] = still[j] = False
    return np.array([_root(parent, k) for k in range(len(places))])


def _root(parent: IntArray, k: int) -> int:
    while parent[k] != k:
        parent[k] = parent[parent[k]]
        k = int(parent[k])
    return k
