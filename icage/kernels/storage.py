"""Growing arrays, a hash table and a heap for the search: numba's own are slower or heavier."""

# pyright: basic
from __future__ import annotations

import numpy as np

from icage.kernels.compiled import compiled, compiled_borrowing

_MIX = np.uint64(0x9E3779B97F4A7C15)


@compiled_borrowing
def hash_slot(keys, key):
    """Index of ``key`` in the open-addressing table, or of the free place where it belongs."""
    mask = len(keys) - 1
    mixed = np.uint64(key) * _MIX
    at = np.int64(mixed >> np.uint64(20)) & mask
    while keys[at] != -1 and keys[at] != key:
        at = (at + 1) & mask
    return at


@compiled
def rehashed(keys, values):
    """The same table, twice as large."""
    bigger = np.full(2 * len(keys), -1, np.int64)
    store = np.empty(2 * len(keys), np.int64)
    for at in range(len(keys)):
        if keys[at] != -1:
            to = hash_slot(bigger, keys[at])
            bigger[to] = keys[at]
            store[to] = values[at]
    return bigger, store


@compiled
def longer(array):
    """A copy with room for twice as many rows."""
    rows, columns = array.shape
    larger = np.empty((2 * rows, columns), array.dtype)
    for a in range(rows):
        for b in range(columns):
            larger[a, b] = array[a, b]
    return larger


@compiled
def put_first(out, values, count):
    """``out[:count] = values[:count]``; a slice takes a second to compile, for its errors."""
    for a in range(count):
        out[a] = values[a]


@compiled
def stable_order(values):
    """Indices (n,) that sort numbers; equal ones stay as they are."""
    return np.argsort(values, kind="mergesort")


@compiled_borrowing
def heap_push(value, item, size, v, t):
    """Push (v, t) on a heap ordered by value, then by item (insertion order breaks ties)."""
    at = size
    while at > 0:
        up = (at - 1) >> 1
        if value[up] < v or (value[up] == v and item[up] < t):
            break
        value[at] = value[up]
        item[at] = item[up]
        at = up
    value[at] = v
    item[at] = t


@compiled_borrowing
def heap_pop(value, item, size):
    """Remove the least of ``size`` entries (read it at index 0 first)."""
    last = size - 1
    v = value[last]
    t = item[last]
    at = 0
    while True:
        down = 2 * at + 1
        if down >= last:
            break
        right = down + 1
        if right < last and (
            value[right] < value[down] or (value[right] == value[down] and item[right] < item[down])
        ):
            down = right
        if v < value[down] or (v == value[down] and t < item[down]):
            break
        value[at] = value[down]
        item[at] = item[down]
        at = down
    value[at] = v
    item[at] = t
