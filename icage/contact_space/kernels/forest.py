"""Minima and merges of a graph whose nodes have births and whose edges have levels."""

# pyright: basic
from __future__ import annotations

import numpy as np

from icage.kernels.compiled import compiled


@compiled
def root_of(parent, node):
    """Root of a node, with path halving."""
    while parent[node] != node:
        parent[node] = parent[parent[node]]
        node = parent[node]
    return node


@compiled
def persistence(births, edges, values, below):
    """Merges of components, by the elder rule, over all edges under a level.

    Returns (merges (m, 3) = node of the elder minimum, node of the younger one, edge; levels (m,);
    minimum (r,) = node of the least minimum of each node's final component). The younger minimum
    ends at the merge: its depth is the level less its birth.
    """
    n = len(births)
    parent = np.arange(n)
    oldest = np.arange(n)
    merges = np.empty((n, 3), np.int64)
    levels = np.empty(n)
    count = 0
    for e in np.argsort(values, kind="mergesort"):
        if values[e] >= below:
            break
        if edges[e, 1] < 0:
            continue
        a, b = root_of(parent, edges[e, 0]), root_of(parent, edges[e, 1])
        if a == b:
            continue
        old, young = oldest[a], oldest[b]
        if births[young] < births[old]:
            old, young = young, old
        merges[count, 0], merges[count, 1], merges[count, 2] = old, young, e
        levels[count] = values[e]
        count += 1
        parent[b] = a
        oldest[a] = old
    minimum = np.empty(n, np.int64)
    for node in range(n):
        minimum[node] = oldest[root_of(parent, node)]
    return merges[:count], levels[:count], minimum
