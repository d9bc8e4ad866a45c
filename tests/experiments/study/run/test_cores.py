"""A study's table is the same to the last byte, whatever the cores. The whole: benchmarks.cores."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from tests.oracles.against_itself.cores import Way, tables

ONE = Way("one core", blas=1, one_core=True, options=("--threads", "1"))
FOUR = Way("four threads", blas=4, options=("--threads", "4", "--shard", "7"))


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="no cores are chosen here")
def test_one_core_and_four_threads(tmp_path: Path):
    """With every input that gives a trial a target of its own."""
    digests = [digest for _, digest in tables(tmp_path, "wrench", 60, (ONE, FOUR))]
    assert digests[0] == digests[1]


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="no cores are chosen here")
@pytest.mark.parametrize("case", ["saw", "disc"])
def test_other_objects_resumed_too(tmp_path: Path, case: str):
    resumed = Way("resumed", first=20, blas=2, options=("--shard", "1000"))
    ways = (ONE, FOUR, resumed)
    assert len({digest for _, digest in tables(tmp_path, case, 60, ways)}) == 1


@pytest.mark.slow
def test_nannies_that_set_the_threads_of_their_workers(tmp_path: Path):
    pytest.importorskip("distributed")
    ways = (Way("here"), Way("dask", workers=2, options=("--shard", "7")))
    assert len({digest for _, digest in tables(tmp_path, "wrench", 60, ways)}) == 1
