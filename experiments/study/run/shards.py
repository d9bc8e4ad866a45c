"""Run a study: what is missing of it, shard by shard, on threads or on a cluster; then sum up."""

from __future__ import annotations

import math
from collections.abc import Callable, Generator
from contextlib import closing
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import pyarrow as pa

from experiments.io.arrow_table import Table
from experiments.io.intervals import stopped_at
from experiments.io.pieces import in_threads
from experiments.study.run.folder import StudyFolder
from experiments.study.run.missing_trials import missing
from experiments.study.run.rows import table_of, target_trials
from experiments.study.run.shard import Study, run_trials
from sim.world.engine import no_log

SHARD: Final = 2000
"""[trial] In a shard at most, unless asked otherwise: a second or two of work. Half as many cost a
hundredth of the speed, in files and in whatever is done once a shard."""

ON_A_CLUSTER: Final = 500
"""[trial] In a shard of a cluster, of which nobody knows how many work there."""

_FEWEST: Final = 250
"""[trial] In a shard at least: below that files cost more than threads that wait at the end."""

Span = tuple[int, int]
"""First and last trial."""

Report = Callable[[int, int], None]
"""Progress: (trials done, all)."""

Backend = Callable[[Study, list[Span]], Generator[tuple[Span, Table]]]
"""Runs spans and yields their tables, in any order. Closed early, it stops."""


@dataclass(frozen=True, slots=True)
class Stopped:
    """How long a study was: ``at`` trials, and why no more."""

    early: bool
    at: int
    why: str


def shard_size(total: int, threads: int) -> int:
    """How many trials a shard gets that nobody has asked for: two shards a thread or more.

    >>> shard_size(100_000, 2), shard_size(3_000, 2), shard_size(300, 8)
    (2000, 750, 250)
    """
    return min(SHARD, max(_FEWEST, math.ceil(total / (2 * threads))))


def run_study(
    study: Study, folder: StudyFolder, backend: Backend, size: int, report: Report
) -> tuple[Table, Stopped]:
    """Run what is missing, keep it shard by shard, and write the whole table.

    The table is the same whatever ran before, in whatever order and in shards of whatever size.
    """
    done = folder.finished()
    if done is not None:
        stop = _stop(study, target_trials(done))
        if done.num_rows >= (stop.at if stop else study.design.total):
            folder.clear()
            length = stop or _whole(study)
            table = done.slice(0, length.at)
            if table.num_rows < done.num_rows:
                folder.finish(table)
            return table, length
        folder.reopen(done)
    reached = _Prefix(study)
    spans: list[Span] = []
    tables: dict[int, Table] = {}
    for span, table in folder.shards():
        spans.append(span)
        tables[span[0]] = table.replace_schema_metadata(None)
        reached.add(span[0], target_trials(table))
    total = study.design.total
    report(reached.known, total)
    if reached.stop is None:
        todo = missing(spans, total, size)
        with closing(backend(study, todo)) as pieces:
            for (first, _), table in pieces:
                folder.keep(table, first)
                tables[first] = table  # as it is on the disk, for whoever goes on after a kill
                reached.add(first, target_trials(table))
                report(reached.known, total)
                if reached.stop is not None:
                    break
    length = reached.stop or _whole(study)
    pieces = [tables[first].slice(0, max(length.at - first, 0)) for first in sorted(tables)]
    table = pa.concat_tables(pieces).replace_schema_metadata(None)
    _check_whole(table, length.at)
    folder.finish(table)
    return table, length


def _whole(study: Study) -> Stopped:
    total = study.design.total
    why = "all trials that were asked for"
    if total > study.config.trials:
        why = "base points are rounded up to a power of two"
    if study.config.until_half_width is not None:
        why += f"; the half width is not down to {study.config.until_half_width:g} yet"
    return Stopped(False, total, why)


def _stop(study: Study, reached: Any) -> Stopped | None:
    wanted, total = study.config.until_half_width, study.design.total
    if wanted is None:
        return None
    at = stopped_at(reached[:total], wanted)
    if at is None:
        return None
    enough = f"the half width is at most {wanted:g}"
    if at == total:
        return Stopped(False, at, f"all trials that were asked for; {enough}")
    return Stopped(True, at, enough)


class _Prefix:
    """What is known of the first trials without a gap: only that decides when to stop."""

    def __init__(self, study: Study) -> None:
        self._study = study
        self._ahead: dict[int, Any] = {}
        self._reached: list[Any] = []
        self._length = 0
        self.known = 0
        self.stop: Stopped | None = None

    def add(self, first: int, reached: Any) -> None:
        """Note which trials of a shard ended in the target."""
        self._ahead[first] = reached
        self.known += len(reached)
        grown = False
        while self._length in self._ahead:
            piece = self._ahead.pop(self._length)
            self._reached.append(piece)
            self._length += len(piece)
            grown = True
        if grown and self._study.config.until_half_width is not None:
            self.stop = _stop(self._study, np.concatenate(self._reached))


def _check_whole(table: Table, count: int) -> None:
    """Nothing lost, nothing twice: trials 0..count-1, each once."""
    if not np.array_equal(table["trial"].to_numpy(), np.arange(count)):
        raise RuntimeError("the shards of this study do not hold every trial exactly once")


def on_threads(threads: int) -> Backend:
    """Shards on a pool of threads of this process; the engine and our kernels share the cores."""

    def backend(study: Study, spans: list[Span]) -> Generator[tuple[Span, Table]]:
        with no_log():
            yield from in_threads(lambda span: shard_table(study, span), spans, threads)

    return backend


def shard_table(study: Study, span: Span) -> Table:
    """The table of trials first..last."""
    trials = np.arange(span[0], span[1] + 1)
    return table_of(study, run_trials(study, trials))
