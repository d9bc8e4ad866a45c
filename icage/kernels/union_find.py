"""Who is joined with whom: a forest of parents."""

# pyright: basic
from __future__ import annotations

from icage.kernels.compiled import compiled


@compiled
def root_of(parent, node):
    """Root of a node, with path halving."""
    while parent[node] != node:
        parent[node] = parent[parent[node]]
        node = parent[node]
    return node
