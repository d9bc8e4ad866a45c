"""The table, the heap and the growing arrays of the search, against Python's own."""

from __future__ import annotations

import heapq

import numpy as np
import pytest

from icage.kernels.storage import (
    hash_slot,
    heap_pop,
    heap_push,
    longer,
    put_first,
    rehashed,
    stable_order,
)

pytestmark = pytest.mark.usefixtures("plain")


def test_the_table_is_a_dictionary_however_full_it_is() -> None:
    """Up to the last free place, so that keys have to step on, and round the end."""
    rng = np.random.default_rng(1)
    keys, values = np.full(16, -1, np.int64), np.empty(16, np.int64)
    known: dict[int, int] = {}
    for key in rng.permutation(10**6)[:15].tolist():
        at = hash_slot(keys, key)
        assert keys[at] == -1
        keys[at], values[at] = key, 7 * key
        known[key] = 7 * key
        assert {k: int(values[hash_slot(keys, k)]) for k in known} == known
        assert len({int(hash_slot(keys, k)) for k in known}) == len(known)
    assert keys[hash_slot(keys, 10**7)] == -1
    more, stored = rehashed(keys, values)
    assert len(more) == len(stored) == 32
    assert sorted(more[more != -1].tolist()) == sorted(known)
    assert {k: int(stored[hash_slot(more, k)]) for k in known} == known


def test_keys_are_spread() -> None:
    """Keys that follow each other share few places: what a search asks for is such."""
    keys = np.full(4096, -1, np.int64)
    places = [int(hash_slot(keys, key)) for key in range(2048)]
    assert min(places) >= 0
    assert max(places) < 4096
    assert len(set(places)) > 1500


def test_the_heap_gives_by_value_and_then_by_age() -> None:
    rng = np.random.default_rng(2)
    value, item = np.full(64, np.nan), np.full(64, -1)
    known: list[tuple[float, int]] = []
    for age in rng.permutation(400).tolist():
        if known and (len(known) == 64 or rng.random() < 0.45):
            assert (value[0], item[0]) == heapq.heappop(known)
            heap_pop(value, item, len(known) + 1)
        else:
            v = float(rng.integers(12))  # many ties
            heap_push(value, item, len(known), v, age)
            heapq.heappush(known, (v, age))
        inside = list(zip(value[: len(known)].tolist(), item[: len(known)].tolist(), strict=True))
        assert sorted(inside) == sorted(known)
        for k in range(1, len(inside)):
            assert inside[(k - 1) // 2] < inside[k]
        assert not known or inside[0] == known[0]


def test_arrays_grow_and_are_copied() -> None:
    rows = np.arange(12).reshape(4, 3)
    grown = longer(rows)
    assert grown.shape == (8, 3)
    assert grown.dtype == rows.dtype
    assert grown[:4].tolist() == rows.tolist()
    out = np.zeros(5)
    put_first(out, np.arange(1.0, 6.0), 3)
    assert out.tolist() == [1.0, 2.0, 3.0, 0.0, 0.0]
    assert stable_order(np.array([2.0, 1.0, 2.0, 1.0])).tolist() == [1, 3, 0, 2]
