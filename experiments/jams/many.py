"""Many cases, and all of it again with other settings of the engine."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

from experiments.cases.with_discs import physical_case
from experiments.jams.run import Judged, judge
from experiments.jams.settings import CHANGED, Changed, change
from icage.case import Case
from icage.errors import InputError

Report = Callable[[str, int, int], None]
Skipped = tuple[str, str]
"""A case and why it was left out."""


def judge_many(
    cases: Mapping[str, Case], trials: int, attacks: int, seed: int, report: Report
) -> tuple[list[Judged], list[Skipped]]:
    """Every case that physics can close, with discs if its fingers are points."""
    rows: list[Judged] = []
    skipped: list[Skipped] = []
    for k, (name, case) in enumerate(cases.items()):
        report("cases", k, len(cases))
        try:
            rows.append(judge(name, physical_case(case), trials, attacks, seed))
        except InputError as error:
            skipped.append((name, str(error)))
    report("cases", len(cases), len(cases))
    return rows, skipped


def with_settings(rows: list[Judged], report: Report) -> list[Changed]:
    """All jams and closings of a run again, with one setting changed after the other."""
    found: list[Changed] = []
    for k, name in enumerate(CHANGED):
        report("settings", k, len(CHANGED))
        found.append(Changed.joined(name, [_again(name, row) for row in rows]))
    report("settings", len(CHANGED), len(CHANGED))
    return found


def _again(name: str, row: Judged) -> Changed:
    measured = [
        (jam.jam.placement, jam.foretold, jam.measured.sticks)
        for jam in row.jams
        if math.isfinite(jam.measured.sticks)
    ]
    levels = {level.mu: level for level in row.levels}
    return change(name, row.physical, measured, levels, list(row.ends))
