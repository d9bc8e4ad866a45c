"""All cases on all cores; the same result for any number of them."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from experiments.io.workers import in_processes
from experiments.regress.baseline import (
    baseline_document,
    baseline_path,
    differences,
    read_baseline,
)
from experiments.regress.cases import EFFORTS, Effort, Entry, Level, in_folder, shipped
from experiments.regress.document import row_document
from experiments.regress.measure import measure
from experiments.regress.record import Record, record_of

Report = Callable[[str, int, int], None]
Done = tuple[dict[str, Any], Record, float]


@dataclass(frozen=True, slots=True)
class Regression:
    """A run: a document per case with what failed in it, and where the baseline is."""

    level: Level
    rows: tuple[dict[str, Any], ...]
    seconds: tuple[float, ...]
    changes: tuple[str, ...]
    """Differences to the baseline, however small the tolerance that they exceed."""
    missing: tuple[str, ...]
    """Cases that the baseline does not know."""
    records: tuple[Record, ...]
    """The closings of each case, to be run again."""

    @property
    def failed(self) -> bool:
        """Whether anything did not hold."""
        return any(row["failures"] for row in self.rows)


def regress(
    level: Level, folder: Path | None, baseline: Path | None, workers: int, report: Report
) -> Regression:
    """Measure every case and compare it with the baseline (None: the committed one).

    Raises
    ------
    InputError:
        A bad folder, case or baseline, before anything runs.
    """
    entries = shipped(level) if folder is None else in_folder(folder)
    was = read_baseline(baseline or baseline_path(level))
    documents, records, seconds = _all(entries, EFFORTS[level], workers, report)
    found = {
        row["case"]: differences(row, was[row["case"]]) for row in documents if row["case"] in was
    }
    rows = tuple(_complaining(row, found.get(row["case"], [])) for row in documents)
    changes = tuple(f"{name}: {line}" for name, lines in found.items() for line in lines)
    missing = tuple(row["case"] for row in documents if row["case"] not in was)
    return Regression(level, rows, tuple(seconds), changes, missing, tuple(records))


def _complaining(row: dict[str, Any], changes: list[str]) -> dict[str, Any]:
    """The row with its differences to the baseline among its failures."""
    return {**row, "failures": [*row["failures"], *(f"baseline: {line}" for line in changes)]}


def _all(
    entries: Sequence[Entry], effort: Effort, workers: int, report: Report
) -> tuple[list[dict[str, Any]], list[Record], list[float]]:
    workers = min(workers or os.cpu_count() or 1, len(entries))
    report("cases", 0, len(entries))
    if workers == 1:
        done: list[Done] = []
        for number, entry in enumerate(entries):
            done.append(one_case(entry, effort))
            report("cases", number + 1, len(entries))
    else:
        found: dict[str, Done] = {}
        with closing(in_processes(partial(one_case, effort=effort), entries, workers)) as pieces:
            for entry, one in pieces:
                found[entry.name] = one
                report("cases", len(found), len(entries))
        done = [found[entry.name] for entry in entries]
    rows, records, seconds = zip(*done, strict=True)
    return list(rows), list(records), list(seconds)


def one_case(entry: Entry, effort: Effort) -> Done:
    """The document of one case, its closings, and the seconds it took."""
    began = time.perf_counter()
    row = measure(entry, effort)
    return row_document(row), record_of(row), time.perf_counter() - began


def new_baseline(done: Regression) -> dict[str, Any]:
    """What would be committed of this run."""
    effort = EFFORTS[done.level]
    return baseline_document(
        list(done.rows),
        {name: getattr(effort, name) for name in ("level", "closings", "attacks", "second")},
    )
