"""Basins of the cells of one hand's free space, and where they end.

A cell whose least point is a pass belongs to the basin behind it: it is there from the level on at
which that pass opens, and ends nothing. What is left are the basins of minima and the passes
between them, of which the least spanning forest decides. [docs/decisions/0014-whole-sublevels.md]
"""

# pyright: basic
from __future__ import annotations

from typing import NamedTuple

import numpy as np

from icage.kernels.compiled import compiled
from icage.kernels.union_find import root_of


class Basins(NamedTuple):
    """The basin (n,) of every cell, -1 where none; the lowest cell (b,) of each, ascending."""

    of: np.ndarray
    lowest: np.ndarray


class Ends(NamedTuple):
    """Where basins end, by the elder rule.

    ``merged`` (b,) is the level at which the component of which a basin is the deepest meets a
    deeper one, that of the basin ``elder`` (b,); inf and -1: never.
    """

    merged: np.ndarray
    elder: np.ndarray


@compiled
def basins_of(low, which, lower, upper, sigma):
    """Basins of cells born at ``low`` (n,), of which ``which`` (n,) is the least pass, or -1."""
    n = len(low)
    parent = np.empty(n, np.int32)
    for k in range(n):
        e = which[k]
        parent[k] = k
        if e >= 0 and sigma[e] == low[k]:
            other = upper[e] if lower[e] == k else lower[e]
            # of two cells with one least point between them the first one keeps it
            if which[other] != e or sigma[e] != low[other] or other < k:
                parent[k] = other
    lowest = np.empty(n, np.int32)
    for k in range(n):
        lowest[k] = k
    for k in range(n):
        root = root_of(parent, k)
        if low[k] == low[root] and k < lowest[root]:
            lowest[root] = k
    deepest = np.empty(n, np.int32)
    count = 0
    for k in range(n):
        if low[k] < np.inf and lowest[root_of(parent, k)] == k:
            deepest[count] = k
            count += 1
    deepest = deepest[:count].copy()
    lowest[:] = -1
    for b in range(count):
        lowest[root_of(parent, deepest[b])] = b
    of = np.empty(n, np.int32)
    for k in range(n):
        of[k] = lowest[root_of(parent, k)]
    return Basins(of, deepest)


@compiled
def least_forest(of, count, lower, upper, sigma):
    """Passes of the least spanning forest of basins, in order of their numbers. [Boruvka1926]

    Of equal passes the first one counts as the least.
    """
    parent = np.arange(count).astype(np.int32)
    left = np.empty(len(sigma), np.int32)
    n = 0
    for e in range(len(sigma)):
        if of[lower[e]] != of[upper[e]]:
            left[n] = e
            n += 1
    least = np.empty(count, np.int32)
    sigma_of = np.empty(count)
    chosen = np.empty(count, np.int32)
    total = 0
    while n > 0:
        least[:] = -1
        sigma_of[:] = np.inf
        kept = 0
        for r in range(n):
            e = left[r]
            a, b = root_of(parent, of[lower[e]]), root_of(parent, of[upper[e]])
            if a == b:
                continue
            left[kept] = e
            kept += 1
            if sigma[e] < sigma_of[a]:
                least[a], sigma_of[a] = e, sigma[e]
            if sigma[e] < sigma_of[b]:
                least[b], sigma_of[b] = e, sigma[e]
        n = kept
        for k in range(count):
            e = least[k]
            if e < 0:
                continue
            a, b = root_of(parent, of[lower[e]]), root_of(parent, of[upper[e]])
            if a != b:
                parent[max(a, b)] = min(a, b)
                chosen[total] = e
                total += 1
    return np.sort(chosen[:total])


@compiled
def ends_of_basins(low, basins, lower, upper, sigma, order):
    """Merges of all basins over passes taken in ``order``. [Kruskal1956]"""
    n = len(basins.lowest)
    parent = np.arange(n)
    size = np.ones(n, np.int32)
    deepest = np.arange(n)
    merged = np.full(n, np.inf)
    elder = np.full(n, -1)
    for e in order:
        a = root_of(parent, basins.of[lower[e]])
        b = root_of(parent, basins.of[upper[e]])
        if a == b:
            continue
        keep, lose = deepest[a], deepest[b]
        born, other = low[basins.lowest[keep]], low[basins.lowest[lose]]
        if other < born or (other == born and lose < keep):
            keep, lose = lose, keep
        merged[lose] = sigma[e]
        elder[lose] = keep
        if size[a] < size[b]:
            a, b = b, a
        parent[b] = a
        size[a] += size[b]
        deepest[a] = keep
    return Ends(merged, elder)
