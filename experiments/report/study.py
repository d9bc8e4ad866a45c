"""The report of a study: rates over every input, failures, how it is made again."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import numpy as np

from experiments.io.arrow_table import Table as Rows
from experiments.io.intervals import wilson
from experiments.io.outcome_words import END_WORDS, NOT_CLOSED, VERDICT_WORDS
from experiments.io.own_files import DamagedError
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
from experiments.report.files import picture
from experiments.report.given import Given
from experiments.report.rows import occurrences, one_of, taken
from experiments.report.shell import quoted, replay_trial
from experiments.report.source import Source
from experiments.study.inputs.variables import VARIABLES, label
from experiments.study.report.method import method
from experiments.study.report.names import display, merged
from experiments.study.report.results_md import LONGEST
from experiments.study.report.summary import sentence
from experiments.study.run.command import command_line
from experiments.study.run.document import fingerprint, parsed_document
from experiments.study.run.finished import is_finished
from experiments.study.run.folder import TRIALS, StudyFolder
from icage.errors import InputError

_PICTURES: Final = (
    ("map.svg", "Where the hand may stand", "The share of closings that ended in the target."),
    ("rates.svg", "Rates over every input", "Closings in the target, with Wilson's intervals."),
    ("indices.svg", "What matters most", "Sobol indices with bootstrap intervals."),
)

_MOST_INPUTS: Final = 6
"""Inputs of a failed trial that are shown; the table of trials has all."""

_ENDS: Final = {**END_WORDS, **NOT_CLOSED}


def study_report(source: Source, page: Path) -> Report:
    """The page of a finished study; ``page`` is where it will lie."""
    document = source.document
    case, config = parsed_document(document)  # every value of it checked
    whole = Given(document, str(source.file))
    if not is_finished(document):
        raise InputError(
            f"{source.named!r} holds a study that is not finished; "
            f"`icage study --resume --out {quoted(source.named)}` goes on with it"
        )
    found = whole.part("found")
    rows = _rows(source, found)
    conditions = _conditions(whole, found)
    try:
        answer = f"{_sentence(found, case.name)}."
        made = [line.removeprefix("- ") for line in method(document)]
        again = command_line(document)
    except (KeyError, TypeError, ValueError, AttributeError, IndexError) as error:
        raise DamagedError(f"{str(source.file)!r} is no study's document: {error!r}") from error
    unit = whole.text("unit")
    sections = [
        Section("Outcomes", tuple(_outcomes(found, conditions))),
        Section("Rates over every input", tuple(_variables(found, unit, conditions))),
        Section("Closings that failed", tuple(_failed(source, found, rows, list(config.vary)))),
        Section("Pictures", tuple(_pictures(source.folder))),
        Section("Method", tuple(Words(line) for line in made)),
        Section("Made with", tuple(_made(whole, again))),
    ]
    return Report(
        title=case.name,
        kind="study",
        held=None,
        answer=answer,
        facts=(
            ("seed", str(config.seed)),
            ("trials", str(found.count("trials"))),
            ("time step", f"{config.time_step:g} s"),
            ("friction", _friction(whole)),
            ("deepest finger", _deepest(whole, found)),
            ("diameter", f"{whole.number('diameter'):.6g} {unit}"),
        ),
        sections=tuple(section for section in sections if section.parts),
    )


def _sentence(found: Given, name: str) -> str:
    """The bottom line, from the counts."""
    one = found.part("independent")
    target, trials = one.share("target", "trials")
    if not trials:
        return f"No trial of {name} was run"
    rate = {"target_rate": target / trials, "target_rate_95": wilson(target, trials)}
    return sentence({**found.values, **rate}, name)


def _rows(source: Source, found: Given) -> Rows | None:
    """The whole table if it is there and this study's."""
    folder = StudyFolder(source.folder, fingerprint(source.document))
    table = folder.finished()
    if table is None:
        return None
    if table.num_rows != found.count("trials"):
        raise DamagedError(f"{str(source.folder / TRIALS)!r} has other trials than study.json")
    there = occurrences(table["outcome"])
    if there != {word: count for word, count in _counts(found).items() if count}:
        raise DamagedError(f"{str(source.folder / TRIALS)!r} has other outcomes than study.json")
    return table


def _counts(found: Given) -> dict[str, int]:
    outcomes = found.part("outcomes")
    counts = {key: outcomes.count(key) for key in outcomes.values}
    unknown = next((key for key in counts if key not in _ENDS), None)
    if unknown is not None:
        raise DamagedError(f"{outcomes.where}: there is no outcome {unknown!r}")
    if sum(counts.values()) != found.count("trials"):
        raise DamagedError(f"{outcomes.where}: the counts do not add up to the trials")
    return counts


def _friction(whole: Given) -> str:
    varied = whole.part("config").part("vary").maybe_part("friction")
    if varied is None:
        return "0"
    ends = varied.numbers("parameters", len(varied.values.get("parameters", ())))
    if varied.text("kind") in ("fixed", "grid", "uniform"):
        return " to ".join(dict.fromkeys(f"{end:g}" for end in (min(ends), max(ends))))
    return "varied"


def _deepest(whole: Given, found: Given) -> str:
    depth = found.maybe_number("penetration_max")
    return "-" if depth is None else f"{depth:.3g} {whole.text('unit')}"


def _conditions(whole: Given, found: Given) -> str:
    """What stands beside every rate."""
    config, size = whole.part("config"), whole.positive("diameter")
    deep, rest = (found.maybe_number(f"penetration_{key}") for key in ("max", "rest_max"))
    depths = "nothing was closed"
    if deep is not None and rest is not None:
        depths = (
            f"deepest finger {deep / size:.2g} diameters while closing, {rest / size:.2g} at rest"
        )
    return (
        f"Seed {config.count('seed')}, time step {config.number('time_step'):g} s, friction "
        f"{_friction(whole)}, {depths}; intervals are Wilson's at 95 %."
    )


def _outcomes(found: Given, conditions: str) -> Iterator[Part]:
    one = found.part("independent")
    target, closed = one.share("target", "closed")
    _, trials = one.share("closed", "trials")
    rows = [
        (Cell(name), count_cell(target), count_cell(of), *rate_cells(target, of))
        for name, of in (("of all trials", trials), ("of those that were closed", closed))
    ]
    heads = (Column("rate"), Column("target", "number"), Column("of", "number"), *RATES)
    yield Table("Closings in the target", heads, tuple(rows), conditions)
    ends = [
        (Cell(key.replace("_", " ")), count_cell(count), Cell(_ENDS[key]))
        for key, count in _counts(found).items()
        if count
    ]
    heads = (Column("outcome"), Column("trials", "number"), Column("meaning"))
    yield Table("How the trials ended", heads, tuple(ends), conditions)
    verdicts = [_verdict(row) for row in found.parts("verdicts")]
    heads = (
        Column("the planner says of the start"), Column("in the target's cage"),
        Column("trials", "number"), Column("closed", "number"), Column("target", "number"), *RATES,
        Column("other grasp", "number"), Column("escaped", "number"),
    )  # fmt: skip
    yield Table("What was planned, and what became of it", heads, tuple(verdicts), conditions)


def _verdict(row: Given) -> tuple[Cell, ...]:
    word = row.text("verdict")
    caged = "yes" if row.flag("in_cage") else "no"
    target, closed = row.share("target", "closed")
    return (
        Cell(VERDICT_WORDS.get(word, word)),
        Cell("-" if word == "collision" else caged),
        count_cell(row.count("trials")),
        count_cell(closed),
        count_cell(target),
        *rate_cells(target, closed),
        *(count_cell(row.count(key)) for key in ("other_grasp", "escaped")),
    )


def _variables(found: Given, unit: str, conditions: str) -> Iterator[Part]:
    for name in found.part("variables").values:
        if name not in VARIABLES:
            raise DamagedError(f"{found.where}: there is no input {name!r}")
        one = found.part("variables").part(name)
        bins = [_bin(b) for b in one.parts("bins")]
        factor, shown = display(VARIABLES[name], unit)
        head = f"{label(name)} [{shown}]" if shown else label(name)
        lines = [Given(b, one.where) for b in merged(bins, LONGEST)]
        rows = [_line(line, factor) for line in lines]
        heads = (
            Column(head, "number"), Column("trials", "number"), Column("closed", "number"),
            Column("target", "number"), *RATES,
        )  # fmt: skip
        yield Table(f"{label(name)}: {VARIABLES[name].help}", heads, tuple(rows), conditions)
        bars = [
            rate_bar(_range(line, factor), *line.share("target", "closed"))
            for line in lines
            if line.count("closed")
        ]
        title = f"Closings in the target over {label(name)}" + (f" [{shown}]" if shown else "")
        yield Chart(title, "%", tuple(bars), ends=(0.0, 100.0))


def _bin(one: Given) -> dict[str, Any]:
    trials, closed, target = (one.count(key) for key in ("trials", "closed", "target"))
    if not target <= closed <= trials or not trials:
        raise DamagedError(f"{one.where}: {target} in the target, of {closed} closed, of {trials}")
    ends = {key: one.number(key) for key in ("low", "high", "mean")}
    return {**ends, "trials": trials, "closed": closed, "target": target, "rate_95": None}


def _line(line: Given, factor: float) -> tuple[Cell, ...]:
    target, closed = line.share("target", "closed")
    return (
        Cell(_range(line, factor), factor * line.number("mean")),
        *(count_cell(line.count(key)) for key in ("trials", "closed", "target")),
        *rate_cells(target, closed),
    )


def _range(line: Given, factor: float) -> str:
    low, high = (f"{factor * line.number(end) + 0.0:.4g}" for end in ("low", "high"))
    return low if low == high else f"{low} to {high}"


def _pictures(folder: Path) -> Iterator[Part]:
    for name, title, words in _PICTURES:
        yield from picture(folder, name, title, words)


def _failed(source: Source, found: Given, rows: Rows | None, varied: list[str]) -> Iterator[Part]:
    failed = found.count("failed")
    if not failed:
        yield Words("Every closing ended in the target: there is no failure to list.")
        return
    if rows is None:
        numbers = found.values.get("failed_trials")
        listed = numbers if isinstance(numbers, list) else []
        shown = ", ".join(str(k) for k in listed[:MOST_FAILURES] if isinstance(k, int))
        yield Words(
            f"{failed} closings did not end in the target, the first of them trials {shown}. "
            f"{TRIALS} is not there: made again by the command below, it lets any of them be "
            "played with `icage replay-trial DIR TRIAL`."
        )
        return
    fine = one_of(rows["outcome"], ("target", *NOT_CLOSED))
    places = np.flatnonzero(~fine)
    if len(places) != failed:
        raise DamagedError(f"{found.where}: failed is {failed}, the table has {len(places)}")
    kept = places[:MOST_FAILURES]
    names = [name for name in varied if name in rows.column_names][:_MOST_INPUTS]
    listed = taken(rows, kept)
    heads = (
        Column("trial", "number"), Column("seed", "number"), Column("ended"),
        *(Column(name.replace("_", " "), "number") for name in names),
        Column("planned"), Column("off by", "number"), Column("deepest", "number"),
        Column("plays it again", "command"),
    )  # fmt: skip
    cells = tuple(_trial(source, row, names) for row in listed)
    beside = "With `--video FILE.mp4` it is filmed. Lengths in the case's unit, angles in rad."
    yield Table("Failed trials", heads, cells, beside, len(places) - len(kept), TRIALS)


def _trial(source: Source, row: dict[str, Any], names: list[str]) -> tuple[Cell, ...]:
    return (
        count_cell(row["trial"]),
        count_cell(row["seed"]),
        Cell(_ENDS[row["outcome"]]),
        *(number_cell(row[name]) for name in names),
        Cell(str(row.get("verdict", "-"))),
        *(number_cell(row.get(key), 3) for key in ("position_error", "penetration_max")),
        Cell(replay_trial(source.named, row["trial"])),
    )


def _made(whole: Given, again: str) -> Iterator[Part]:
    versions = whole.part("versions")
    yield Words(f"{versions_words({k: versions.text(k) for k in versions.values})}.")
    yield Command(again, "Makes the same study again, to the last bit on the same versions.")
