"""The work of the grasp search in chunks, in this process or in several; the same either way."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import TypeAlias

import numpy as np

from icage.arrays import FloatArray, IntArray
from icage.grasps.evaluator import Found, GraspEvaluator, Job, best_first
from icage.grasps.wanted import Wanted
from icage.outline import Outline

_CHUNK = 64

_STEPS = 90


Progress: TypeAlias = Callable[[str, int, int], None]


_evaluator: GraspEvaluator | None = None


def _start_worker(outline: FloatArray, radius: float, wanted: Wanted) -> None:
    global _evaluator
    _evaluator = GraspEvaluator(Outline(outline), radius, wanted)


Done: TypeAlias = tuple[list[Found], int]
"""What came of a chunk of jobs, and how many searches were broken off in it."""


def try_chunk(jobs: list[Job]) -> Done:
    """The grasp of each job."""
    assert _evaluator is not None
    before = _evaluator.broken_off
    found = [(_evaluator.at(triple, p), p) for triple, p in jobs]
    return found, _evaluator.broken_off - before


def elsewhere_chunk(jobs: list[Job]) -> Done:
    """What each triple has anywhere: for those that have nothing where they were tried first."""
    assert _evaluator is not None
    before = _evaluator.broken_off
    found: list[Found] = []
    for triple, p in jobs:
        good = best_first(_evaluator.elsewhere(triple))
        found += good or [(None, p)]
    return found, _evaluator.broken_off - before


def improve_chunk(jobs: list[Job]) -> Done:
    """Each job's grasp made better by moving its contacts."""
    assert _evaluator is not None
    before = _evaluator.broken_off
    found = [improved(_evaluator, triple, p) for triple, p in jobs]
    return found, _evaluator.broken_off - before


def improved(evaluator: GraspEvaluator, triple: IntArray, start: FloatArray) -> Found:
    """Move the contacts of a grasp by moving P: Nelder-Mead on the score, bounded steps."""
    from scipy.optimize import minimize  # only now: scipy is slow to load

    best: list[Found] = [(evaluator.at(triple, start), start)]
    size = evaluator.outline.diameter

    def loss(p: FloatArray) -> float:
        found = evaluator.at(triple, p)
        if found is None:
            return 1.0
        if best[0][0] is None or found.score > best[0][0].score:
            best[0] = (found, p.copy())
        return -found.score

    for step in (0.03, 0.004):
        p = best[0][1]
        simplex = p + size * step * np.array([[0.0, 0.0], [1.0, 0.3], [-0.3, 1.0]])
        minimize(
            loss, p, method="Nelder-Mead",
            options={"initial_simplex": simplex, "maxfev": _STEPS // 2, "xatol": 1e-6 * size},
        )  # fmt: skip
    return best[0]


class Workers:
    """Chunks of jobs in order, in this process or in several."""

    def __init__(
        self,
        outline: Outline,
        radius: float,
        wanted: Wanted,
        workers: int,
        evaluator: GraspEvaluator,
    ) -> None:
        global _evaluator
        _evaluator = evaluator
        self.broken_off = 0
        self._pool: ProcessPoolExecutor | None = None
        if workers > 1:
            self._pool = ProcessPoolExecutor(
                workers, mp_context=get_context("spawn"), initializer=_start_worker,
                initargs=(outline.vertices, radius, wanted),
            )  # fmt: skip

    def __enter__(self) -> Workers:
        return self

    def __exit__(self, *_: object) -> None:
        if self._pool is not None:
            self._pool.shutdown(cancel_futures=True)

    def run(
        self,
        work: Callable[[list[Job]], Done],
        jobs: list[Job],
        stage: str,
        progress: Progress,
    ) -> list[Found]:
        """What came of the jobs, in their order."""
        size = 1 if work is improve_chunk else _CHUNK
        chunks = [jobs[k : k + size] for k in range(0, len(jobs), size)]
        results = self._pool.map(work, chunks) if self._pool else map(work, chunks)
        found: list[Found] = []
        for done, broken_off in results:
            found += done
            self.broken_off += broken_off
            progress(stage, len(found), len(jobs))
        return found
