"""Minima and merges of a graph whose nodes have births and whose edges have levels."""

# pyright: basic
from __future__ import annotations

from typing import NamedTuple

import numpy as np

from icage.contact_space.kernels.columns import (
    EDGE_FROM,
    EDGE_TO,
    MERGE_EDGE,
    MERGE_ELDER,
    MERGE_YOUNGER,
)
from icage.kernels.compiled import compiled
from icage.kernels.storage import stable_order
from icage.kernels.union_find import root_of


class Persistence(NamedTuple):
    """Merges (m, 3) = node of the elder minimum, node of the younger one, edge; their levels (m,).

    ``minimum`` (r,) is the node of the least minimum of each node's final component.
    """

    merges: np.ndarray
    levels: np.ndarray
    minimum: np.ndarray


@compiled
def persistence(births, edges, values, below):
    """Merges of components, by the elder rule, over all edges under a level.

    The younger minimum ends at the merge: its depth is the level less its birth.
    """
    n = len(births)
    parent = np.arange(n)
    oldest = np.arange(n)
    merges = np.empty((n, 3), np.int64)
    levels = np.empty(n)
    count = 0
    for e in stable_order(values):
        if values[e] >= below:
            break
        if edges[e, EDGE_TO] < 0:
            continue
        a, b = root_of(parent, edges[e, EDGE_FROM]), root_of(parent, edges[e, EDGE_TO])
        if a == b:
            continue
        old, young = oldest[a], oldest[b]
        if births[young] < births[old]:
            old, young = young, old
        merges[count, MERGE_ELDER], merges[count, MERGE_YOUNGER] = old, young
        merges[count, MERGE_EDGE] = e
        levels[count] = values[e]
        count += 1
        parent[b] = a
        oldest[a] = old
    minimum = np.empty(n, np.int64)
    for node in range(n):
        minimum[node] = oldest[root_of(parent, node)]
    return Persistence(merges[:count], levels[:count], minimum)
