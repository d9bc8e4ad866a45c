"""A tree of boxes: which of many things may meet one, without a look at all of them.

Node k has the children 2 k and 2 k + 1, thing k of n is node n + k, and node 1 is round them all.
Things that follow each other, as edges of a ring do, are near each other, so nothing is sorted.
"""

# pyright: basic
from __future__ import annotations

import numpy as np

from icage.kernels.compiled import compiled, compiled_borrowing

DEEP = 128
"""Nodes that wait while a tree is gone through, at most: two for each of its levels."""


@compiled
def empty_tree(count):
    """Boxes (2 count, 4) = west, south, east, north, all of them inside out: nothing in them."""
    tree = np.empty((2 * count, 4))
    for k in range(2 * count):
        tree[k, 0], tree[k, 1], tree[k, 2], tree[k, 3] = np.inf, np.inf, -np.inf, -np.inf
    return tree


@compiled_borrowing
def put_in(tree, thing, x, y):
    """Widen the box of a thing so that a point is in it."""
    node = len(tree) // 2 + thing
    tree[node, 0], tree[node, 1] = min(tree[node, 0], x), min(tree[node, 1], y)
    tree[node, 2], tree[node, 3] = max(tree[node, 2], x), max(tree[node, 3], y)


@compiled_borrowing
def close_tree(tree):
    """Fill in the boxes above the things'."""
    for k in range(len(tree) // 2 - 1, 0, -1):
        a, b = 2 * k, 2 * k + 1
        tree[k, 0], tree[k, 1] = min(tree[a, 0], tree[b, 0]), min(tree[a, 1], tree[b, 1])
        tree[k, 2], tree[k, 3] = max(tree[a, 2], tree[b, 2]), max(tree[a, 3], tree[b, 3])


@compiled_borrowing
def next_in_box(tree, stack, waiting, box):
    """The next thing whose box meets this one (4,), or -1, and how many nodes wait after it.

    ``waiting`` nodes stand in ``stack`` (DEEP,): at first one, node 1.
    """
    count = len(tree) // 2
    while waiting > 0:
        waiting -= 1
        node = stack[waiting]
        if (
            tree[node, 0] > box[2]
            or tree[node, 2] < box[0]
            or tree[node, 1] > box[3]
            or tree[node, 3] < box[1]
        ):
            continue
        if node >= count:
            return node - count, waiting
        stack[waiting], stack[waiting + 1] = 2 * node + 1, 2 * node
        waiting += 2
    return -1, 0
