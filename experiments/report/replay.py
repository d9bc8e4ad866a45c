"""The report of a replay, or of the closings that a regression kept."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from experiments.io.arrow_table import Table as Rows
from experiments.io.intervals import rate_upper, wilson
from experiments.io.outcome_words import END_WORDS
from experiments.io.own_files import DamagedError
from experiments.io.parquet_files import read_table, words_of
from experiments.report.content import (
    MOST_FAILURES,
    RATES,
    Cell,
    Chart,
    Column,
    Command,
    Part,
    Report,
    Section,
    Table,
    Words,
    count_cell,
    number_cell,
    rate_bar,
    rate_cells,
    versions_words,
)
from experiments.report.files import film, picture
from experiments.report.given import Given
from experiments.report.rows import occurrences, one_of, taken
from experiments.report.shell import quoted, replay_trial
from experiments.report.source import Source
from experiments.study.report.names import percent

TRIALS, REGIONS, VIDEO = "trials.parquet", "regions.svg", "replay.mp4"
_FORMAT: Final = b"icage-trials/1"

_OUTCOMES: Final = tuple(END_WORDS)
_NOT_SETTLED: Final = ("timed_out", "diverged")
_REACHED: Final = ("target",)
_KNOWN: Final = ("target", "other_grasp")

_COLUMNS: Final = (
    "run", "grasp", "set", "trial", "seed", "verdict", "outcome", "penetration_max",
    "penetration_rest",
)  # fmt: skip

_SETS: Final = {"guaranteed": "guaranteed", "rest": "rest of the cage", "outside": "outside"}

DEEPEST_MOVING, DEEPEST_AT_REST = 1e-3, 1e-5
"""[diameter] Limits of ``experiments.replay.run``; a test holds the two together."""

LONGEST_CHART: Final = 40
"""Runs of a chart."""


def replay_report(source: Source, page: Path) -> Report:
    """The page of a replay; ``page`` is where it will lie."""
    document = Given(source.document, str(source.file))
    runs = document.parts("runs")
    if not runs:
        raise DamagedError(f"{document.where}: there are no runs")
    counts = [run.counts(_OUTCOMES, "trials") for run in runs]
    failures = [line for run in runs for line in run.texts("failures")]
    name, seed = document.text("name"), document.count("seed")
    rows = _rows(source.folder, runs, counts)
    sections = [
        Section("Closings", tuple(_closings(runs, counts, seed))),
        Section("What did not hold", tuple(_failed(source, runs, failures, rows))),
        Section("Pictures", tuple(_pictures(source.folder, page))),
        Section("Made with", tuple(_made(document, runs, source))),
    ]
    return Report(
        title=name,
        kind="replay",
        held=not failures,
        answer=_answer(name, runs, counts, len(failures)),
        facts=_facts(runs, seed, document),
        sections=tuple(section for section in sections if section.parts),
    )


def _answer(
    name: str, runs: Sequence[Given], counts: Sequence[dict[str, int]], failures: int
) -> str:
    pairs = list(zip(runs, counts, strict=True))
    sure = [found for run, found in pairs if run.text("set") == "guaranteed"]
    caged = [found for run, found in pairs if run.text("set") in ("guaranteed", "rest")]
    target, trials = sum(f["target"] for f in sure), sum(sum(f.values()) for f in sure)
    out, of = sum(f["escaped"] for f in caged), sum(sum(f.values()) for f in caged)
    low, high = wilson(target, trials)
    words = (
        f"{target} of {trials} closings from the guaranteed sets of {name} ended in the target "
        f"grasp (95 %: {percent(low)} to {percent(high)}), and {out or 'none'} of {of} from its "
        f"cages escaped"
    )
    if not out and of:
        words += f" (rate below {percent(rate_upper(0, of))} at 95 %, Clopper-Pearson)"
    if failures:
        words += f"; {failures} promise{'s' if failures > 1 else ''} did not hold"
    return f"{words}."


def _facts(runs: Sequence[Given], seed: int, document: Given) -> tuple[tuple[str, str], ...]:
    first, unit = runs[0], runs[0].text("unit")
    deepest = [v for run in runs if (v := run.maybe_number("penetration_max")) is not None]
    return (
        ("seed", str(seed)),
        ("trials", str(sum(run.count("trials") for run in runs))),
        ("time step", f"{first.number('time_step'):g} s"),
        ("friction", _friction(runs)),
        ("deepest finger", f"{max(deepest):.3g} {unit}" if deepest else "-"),
        ("diameter", f"{first.number('diameter'):.6g} {unit}"),
    )


def _friction(runs: Sequence[Given]) -> str:
    known = {run.part("config").number("friction") if run.has("config") else None for run in runs}
    words = ["not recorded" if mu is None else f"{mu:g}" for mu in sorted(known, key=str)]
    return ", ".join(words)


def _closings(runs: Sequence[Given], counts: Sequence[dict[str, int]], seed: int) -> Iterator[Part]:
    heads = (
        Column("grasp"), Column("set"), Column("trials", "number"), Column("target", "number"),
        *RATES, Column("deepest / diameter", "number"), Column("at rest / diameter", "number"),
        Column("friction", "number"), Column("time step [s]", "number"),
        Column("other grasp", "number"), Column("escaped", "number"),
        Column("elsewhere", "number"), Column("sigma_first / sigma_0", "number"),
        Column("sigma_max / sigma_0", "number"),
    )  # fmt: skip
    rows = [_run(run, found) for run, found in zip(runs, counts, strict=True)]
    beside = (
        f"Seed {seed}; intervals are Wilson's at 95 %. Deepest: of a finger in the object, while "
        "closing and at rest. From the guaranteed set closing can end only in the target; from the "
        "rest of the cage other grasps are within reach, and nothing may escape. Elsewhere: "
        "jammed, in a grasp that was not planned, or not settled."
    )
    yield Table.cut("Closings by grasp and set", heads, rows, beside, "replay.json")
    bars = [
        rate_bar(f"{run.text('grasp')}, {_set(run)}", found["target"], sum(found.values()))
        for run, found in zip(runs, counts, strict=True)
    ]
    yield Chart(
        "Closings that ended in the target grasp", "%", tuple(bars[:LONGEST_CHART]),
        ends=(0.0, 100.0), left_off=len(bars[LONGEST_CHART:]),
    )  # fmt: skip


def _set(run: Given) -> str:
    name = run.text("set")
    return _SETS.get(name, name)


def _run(run: Given, found: dict[str, int]) -> tuple[Cell, ...]:
    plan, size = run.part("plan"), run.positive("diameter")
    config = run.maybe_part("config")
    return (
        Cell(run.text("grasp")),
        Cell(_set(run)),
        count_cell(sum(found.values())),
        count_cell(found["target"]),
        *rate_cells(found["target"], sum(found.values())),
        *(_share(run, key, size) for key in ("penetration_max", "penetration_rest_max")),
        number_cell(None if config is None else config.number("friction")),
        number_cell(run.number("time_step")),
        *(count_cell(found[key]) for key in ("other_grasp", "escaped")),
        count_cell(sum(found[key] for key in ("jammed", "unmatched", *_NOT_SETTLED))),
        *(_ratio(plan, key) for key in ("sigma_first", "sigma_max")),
    )


def _ratio(plan: Given, key: str) -> Cell:
    level = plan.maybe_number(key)
    if level is None:
        return Cell("never")
    ratio = level / plan.positive("sigma_0")
    return Cell(f"{ratio:.5f}", ratio)


def _share(run: Given, key: str, size: float) -> Cell:
    value = run.maybe_number(key)
    return number_cell(None if value is None else value / size, 2)


def _rows(folder: Path, runs: Sequence[Given], counts: Sequence[dict[str, int]]) -> Rows | None:
    """The table of trials, if it is there and is this replay's."""
    path = folder / TRIALS
    if not path.exists():
        return None
    table = read_table(path)
    if words_of(table).get(b"format") != _FORMAT:
        raise DamagedError(f"{str(path)!r} is no table of a replay")
    missing = [name for name in _COLUMNS if name not in table.column_names]
    if missing:
        raise DamagedError(f"{str(path)!r} has no column {missing[0]!r}")
    number = _column(table, "run")
    for k, found in enumerate(counts):
        there = occurrences(table["outcome"], number == k)
        if there != {word: count for word, count in found.items() if count}:
            raise DamagedError(f"{str(path)!r} has other trials than {runs[k].where} tells of")
    if table.num_rows != sum(sum(found.values()) for found in counts):
        raise DamagedError(f"{str(path)!r} has trials of other runs")
    return table


def _column(table: Rows, name: str) -> Any:
    return table[name].to_numpy()


def _failed(
    source: Source, runs: Sequence[Given], failures: Sequence[str], rows: Rows | None
) -> Iterator[Part]:
    if not failures:
        yield Words("Everything that was promised held: there is no failure to list.")
        return
    for line in failures[:MOST_FAILURES]:
        yield Words(f"{line}.")
    if len(failures) > MOST_FAILURES:
        yield Words(f"{len(failures) - MOST_FAILURES} more sentences are in {source.file.name}.")
    if rows is None:
        yield Words(f"{TRIALS} is not there, so that single trials cannot be listed or played.")
        return
    found = _failed_rows(runs, rows)
    cells = [_trial(source, row, index) for index, row in found[1]]
    heads = (
        Column("trial", "number"), Column("grasp"), Column("set"), Column("seed", "number"),
        Column("planned"), Column("ended"), Column("deepest", "number"),
        Column("plays it again", "command"),
    )  # fmt: skip
    if cells:
        yield Table(
            "Trials that failed", heads, tuple(cells),
            "Trial: the row of trials.parquet, from 0. With `--video FILE.mp4` it is filmed.",
            found[0] - len(cells), TRIALS,
        )  # fmt: skip


def _failed_rows(runs: Sequence[Given], rows: Rows) -> tuple[int, list[tuple[int, dict[str, Any]]]]:
    """How many trials failed, and the first of them with their place in the table."""
    number, depth, at_rest = (
        np.asarray(_column(rows, name), dtype=np.float64)
        for name in ("run", "penetration_max", "penetration_rest")
    )
    reached, known = (one_of(rows["outcome"], words) for words in (_REACHED, _KNOWN))
    moving = one_of(rows["outcome"], ("escaped", *_NOT_SETTLED))
    bad = np.zeros(rows.num_rows, dtype=np.bool_)
    for k, run in enumerate(runs):
        mine, size, which = number == k, run.positive("diameter"), run.text("set")
        if which in ("guaranteed", "rest"):
            bad |= mine & ~(reached if which == "guaranteed" else known)
        bad |= mine & (depth > DEEPEST_MOVING * size)  # null is no number, and no depth
        bad |= mine & ~moving & (at_rest > DEEPEST_AT_REST * size)
    places = np.flatnonzero(bad)
    kept = places[:MOST_FAILURES]
    listed = taken(rows, kept)
    return len(places), list(zip(kept.tolist(), listed, strict=True))


def _trial(source: Source, row: dict[str, Any], index: int) -> tuple[Cell, ...]:
    return (
        count_cell(index),
        Cell(str(row["grasp"])),
        Cell(_SETS.get(row["set"], str(row["set"]))),
        count_cell(int(row["seed"])),
        Cell(str(row["verdict"])),
        Cell(END_WORDS.get(row["outcome"], str(row["outcome"]))),
        number_cell(row["penetration_max"], 2),
        Cell(replay_trial(source.named, index)),
    )


def _pictures(folder: Path, page: Path) -> Iterator[Part]:
    yield from film(folder, VIDEO, page)
    yield from picture(
        folder, REGIONS, "The object, the target grasp and its caging regions",
        "Where each finger's centre may be in the cage of the first grasp.",
    )  # fmt: skip


def _made(document: Given, runs: Sequence[Given], source: Source) -> Iterator[Part]:
    versions = document.part("versions")
    yield Words(f"{versions_words({k: versions.text(k) for k in versions.values})}.")
    if document.text("name") == "regress":
        yield Command("icage regress --out DIR", "Makes all of it again.")
        return
    most = max(run.count("trials") for run in runs)
    yield Command(
        f"icage replay {quoted(document.text('name'))} --trials {most} "
        f"--seed {document.count('seed')} --out DIR",
        "Makes it again, if the case is a shipped one or a file of that name.",
    )
