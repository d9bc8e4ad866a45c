"""The work of the grasp search in chunks over the cores; the same whatever their number.

The kernels release Python's lock, so threads do: nothing is started, copied or sent.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import TypeAlias, TypeVar

import numpy as np

from icage.arrays import FloatArray, IntArray
from icage.grasps.evaluator import GraspEvaluator
from icage.grasps.findings import Findings

_CHUNK = 48
"""Candidates between two looks at the clock: some 10 to 100 ms of one core."""

Progress: TypeAlias = Callable[[str, int, int, float | None], None]
"""Called with the stage, what is done of it and all of it, and the best score so far."""

Given = TypeVar("Given")
Done = TypeVar("Done")


class OutOfTimeError(Exception):
    """The seconds that were given are over: the search ends with what there is."""


class Crew:
    """Threads, a clock, and the best so far.

    Parameters
    ----------
    seconds:
        After which ``OutOfTimeError`` is raised, between two chunks, once there is a grasp; None
        for never.
    """

    def __init__(self, workers: int, progress: Progress, seconds: float | None = None) -> None:
        self._threads = ThreadPoolExecutor(max_workers=max(1, workers))
        self._progress = progress
        self._end = None if seconds is None else time.monotonic() + seconds
        self.compared = 0
        self.best: float | None = None

    def __enter__(self) -> Crew:
        return self

    def __exit__(self, *_: object) -> None:
        self._threads.shutdown(cancel_futures=True)

    def map(
        self, work: Callable[[Given], Done], given: list[Given], stage: str, weight: int = 1
    ) -> Iterator[Done]:
        """What came of each, in order; told as ``weight`` steps each."""
        for done, answer in enumerate(self._threads.map(work, given), 1):
            yield answer
            self._progress(stage, done * weight, len(given) * weight, self.best)
            self._look_at_the_clock()

    def grasps(
        self, evaluator: GraspEvaluator, triples: IntArray, points: FloatArray, stage: str,
        keep: list[Findings],
    ) -> tuple[IntArray, Findings]:  # fmt: skip
        """The cages among candidates, and the rows that they came from.

        Each chunk is put into ``keep`` as soon as it is there, for whoever is interrupted.
        """
        chunks = [slice(k, k + _CHUNK) for k in range(0, len(triples), _CHUNK)]
        rows: list[IntArray] = []
        found: list[Findings] = []

        def work(chunk: slice) -> tuple[IntArray, Findings]:
            return evaluator.rows_of(triples[chunk], points[chunk])

        for chunk, (own, part) in zip(
            chunks, self._told(work, chunks, stage, len(triples)), strict=True
        ):
            rows.append(own + chunk.start)
            found.append(part)
            keep.append(part)
        return np.concatenate(rows) if rows else np.empty(0, np.int64), Findings.together(found)

    def climbs(
        self, work: Callable[[Given], Findings], given: list[Given], stage: str, steps: int,
        keep: list[Findings],
    ) -> Iterator[Findings]:  # fmt: skip
        """What came of each climb of so many steps, in order; kept as soon as it is there."""
        for answer in self.map(work, given, stage, steps):
            self.compared += steps
            self._note(answer)
            keep.append(answer)
            yield answer

    def _note(self, found: Findings) -> None:
        if len(found):
            top = float(found.score.max())
            self.best = top if self.best is None else max(self.best, top)

    def _told(
        self, work: Callable[[slice], tuple[IntArray, Findings]], chunks: list[slice], stage: str,
        total: int,
    ) -> Iterator[tuple[IntArray, Findings]]:  # fmt: skip
        for chunk, answer in zip(chunks, self._threads.map(work, chunks), strict=True):
            yield answer
            done = min(chunk.stop, total)
            self.compared += done - chunk.start
            self._note(answer[1])
            self._progress(stage, done, total, self.best)
            self._look_at_the_clock()

    def _look_at_the_clock(self) -> None:
        """Nobody is served by an end before the first grasp."""
        late = self._end is not None and time.monotonic() > self._end
        if late and self.best is not None:
            raise OutOfTimeError
