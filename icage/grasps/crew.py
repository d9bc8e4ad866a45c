"""The work of the grasp search in chunks over the cores; the same whatever their number.

The kernels release Python's lock, so threads do: nothing is started, copied or sent.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Literal, TypeAlias, TypeVar

import numpy as np

from icage.arrays import FloatArray, IntArray
from icage.grasps.evaluator import GraspEvaluator
from icage.grasps.findings import Findings

_BATCH = 16
"""Chunks between two looks at the cells: the same for any number of threads."""

_CHUNK = 48
"""Candidates between two looks at the clock: some 10 to 100 ms of one core."""

Progress: TypeAlias = Callable[[str, int, int, float | None], None]
"""Called with the stage, what is done of it and all of it, and the best score so far."""

Ended: TypeAlias = Literal["out of time", "interrupted"]

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
        self.compared = self.tried = 0
        self.best: float | None = None

    def __enter__(self) -> Crew:
        return self

    def __exit__(self, *_: object) -> None:
        self._threads.shutdown(cancel_futures=True)

    def map(
        self, work: Callable[[Given], Done], given: list[Given], stage: str, before: int = 0,
        total: int | None = None,
    ) -> Iterator[Done]:  # fmt: skip
        """What came of each, in order; of a stage of ``total``, ``before`` of which are done."""
        total = len(given) if total is None else total
        for done, answer in enumerate(self._threads.map(work, given), before + 1):
            yield answer
            self._progress(stage, done, total, self.best)
            self._look_at_the_clock()

    def grasps(
        self, evaluator: GraspEvaluator, triples: IntArray, points: FloatArray, stage: str,
        keep: list[Findings], most_cells: float = math.inf,
    ) -> IntArray:  # fmt: skip
        """Rows of the candidates that are cages; these go into ``keep`` as soon as they are there.

        No further candidates are looked at after ``most_cells`` cells; how many were is in
        ``tried``.
        """
        chunks = [slice(k, k + _CHUNK) for k in range(0, len(triples), _CHUNK)]
        rows: list[IntArray] = []
        cells = 0
        self.tried = 0
        for begin in range(0, len(chunks), _BATCH):
            batch = chunks[begin : begin + _BATCH]
            answers = self._threads.map(
                evaluator.tried, [triples[c] for c in batch], [points[c] for c in batch]
            )
            for chunk, answer in zip(batch, answers, strict=True):
                rows.append(answer.rows + chunk.start)
                keep.append(answer.found)
                cells += answer.cells
                self._note(answer.found)
                done = min(chunk.stop, len(triples))
                self.compared += done - chunk.start
                self.tried = done
                self._progress(stage, done, len(triples), self.best)
                self._look_at_the_clock()
            if cells > most_cells:
                break
        return np.concatenate(rows) if rows else np.empty(0, np.int64)

    def climbs(
        self, work: Callable[[Given], tuple[Findings, int]], given: list[Given], stage: str,
        keep: list[Findings],
    ) -> Iterator[Findings]:  # fmt: skip
        """What came of each climb, in order; kept as soon as it is there."""
        for found, compared in self.map(work, given, stage):
            self.compared += compared
            self._note(found)
            keep.append(found)
            yield found

    def start_again(self) -> None:
        """From here on scores mean something else."""
        self.best = None

    def note(self, some: list[Findings]) -> None:
        """Grasps that came by ``map``."""
        for found in some:
            self._note(found)

    def _note(self, found: Findings) -> None:
        if len(found):
            top = float(found.score.max())
            self.best = top if self.best is None else max(self.best, top)

    def _look_at_the_clock(self) -> None:
        """Nobody is served by an end before the first grasp."""
        late = self._end is not None and time.monotonic() > self._end
        if late and self.best is not None:
            raise OutOfTimeError
