"""Columns of words of a table of trials, without a Python object a row: there may be millions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute

from icage.arrays import BoolArray, IntArray

_pc: Any = pyarrow.compute


def occurrences(column: Any, rows: BoolArray | None = None) -> dict[str, int]:
    """How often each word of a column stands there, in all rows or in some (n,).

    >>> occurrences(pa.chunked_array([["target", "escaped", "target"]]))
    {'target': 2, 'escaped': 1}
    """
    if rows is not None:
        column = column.filter(pa.array(rows))
    found = _pc.value_counts(column.cast(pa.string())).to_pylist()
    return {one["values"]: one["counts"] for one in found}


def one_of(column: Any, words: Sequence[str]) -> BoolArray:
    """(n,) whether each is one of these words.

    >>> one_of(pa.chunked_array([["target", "escaped"]]), ("target",)).tolist()
    [True, False]
    """
    found = _pc.is_in(column.cast(pa.string()), value_set=pa.array(list(words), pa.string()))
    return np.asarray(found.to_numpy(zero_copy_only=False), dtype=np.bool_)


def taken(rows: Any, places: IntArray) -> list[dict[str, Any]]:
    """Some rows of a table, a dictionary each."""
    return rows.take(pa.array(places)).to_pylist()
