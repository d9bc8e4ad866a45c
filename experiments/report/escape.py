"""The report of attacks on a cage."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Final

from experiments.report.content import (
    RATES,
    UPPER,
    Bar,
    Cell,
    Chart,
    Column,
    Command,
    Line,
    Part,
    Report,
    Section,
    Table,
    Words,
    count_cell,
    number_cell,
    rate_cells,
    upper_cell,
)
from experiments.report.given import Given
from experiments.report.shell import of_case
from experiments.report.source import Source

_ANSWERS: Final = {
    "ok": "as planned",
    "failed": "NOT as planned",
    "too_thin_for_physics": "too thin a cage for physics to judge",
    "no_derived_case": "not attacked: discs find no grasp where the point fingers have theirs",
}

_SIDES: Final = ("below", "above")


def escape_report(source: Source, page: Path) -> Report:
    """The page of ``icage escape``."""
    document = Given(source.document, str(source.file))
    failures = document.texts("failures")
    name, unit, size = document.text("case"), document.text("unit"), document.positive("diameter")
    sections = [
        Section("Attacks", tuple(_attacks(document, unit, size))),
        Section("Where escapes begin", tuple(_measured(document, unit, size))),
        Section("What did not hold", tuple(_failed(document, failures))),
        Section("Settings", tuple(_settings(document))),
    ]
    return Report(
        title=name,
        kind="escape",
        held=not failures,
        answer=_answer(document, name),
        facts=(
            ("seed", str(document.count("seed"))),
            ("sigma_0", f"{document.number('sigma_0'):.6g} {unit}"),
            ("sigma_max", _level(document, "sigma_max", unit)),
            ("time step", _or(document.maybe_number("time_step"), " s")),
            ("friction", _or(document.maybe_number("friction"), "", "not recorded")),
            ("deepest finger", f"{document.number('penetration_max'):.3g} {unit}"),
        ),
        sections=tuple(section for section in sections if section.parts),
    )


def _answer(document: Given, name: str) -> str:
    verdict = document.text("verdict")
    runs = [r for a in _attackers(document) if (r := a.maybe_part("below")) is not None]
    shares = [run.share("escapes", "attacks") for run in runs]
    out, tried = (sum(share[k] for share in shares) for k in (0, 1))
    guided = document.part("attackers").maybe_part("guided")
    above = None if guided is None else guided.maybe_part("above")
    words = f"{out or 'None'} of {tried} attacks below sigma_max got {name} out of the hand"
    if above is not None:
        led, of = above.share("escapes", "attacks")
        words += f", and {led} of {of} along the plan's way out above it did"
    return f"{words}: {_ANSWERS.get(verdict, verdict)}."


def _attackers(document: Given) -> list[Given]:
    attackers = document.part("attackers")
    return [attackers.part(name) for name in attackers.values]


def _or(value: float | None, unit: str, none: str = "-") -> str:
    return none if value is None else f"{value:g}{unit}"


def _level(document: Given, key: str, unit: str) -> str:
    level = document.maybe_number(key)
    return "never escapes" if level is None else f"{level:.6g} {unit}"


def _beside(document: Given) -> str:
    friction, step = (document.maybe_number(key) for key in ("friction", "time_step"))
    return (
        f"Seed {document.count('seed')}, time step {_or(step, ' s')}, "
        f"friction {_or(friction, '', 'not recorded')}. Deepest: of a finger inside the object, "
        "which is a false opening of that order; overrun: how far the stop gave way, over sigma."
    )


def _attacks(document: Given, unit: str, size: float) -> Iterator[Part]:
    rows: list[tuple[Cell, ...]] = []
    attackers = document.part("attackers")
    for name in attackers.values:
        for side in _SIDES:
            run = attackers.part(name).maybe_part(side)
            if run is None:
                continue
            out, tried = run.share("escapes", "attacks")
            level = document.maybe_number(f"level_{side}")
            rows.append((
                Cell(name), Cell(f"{side} sigma_max"), number_cell(level, 6), count_cell(tried),
                count_cell(out), *rate_cells(out, tried),
                upper_cell(out, tried) if side == "below" else Cell("-"),
                count_cell(run.count("diverged")),
                number_cell(run.number("penetration_max") / size, 2),
                number_cell(run.number("stop_overrun"), 2),
            ))  # fmt: skip
    heads = (
        Column("attacker"), Column("held"), Column(f"opening [{unit}]", "number"),
        Column("attacks", "number"), Column("escapes", "number"), *RATES, UPPER,
        Column("diverged", "number"), Column("deepest / diameter", "number"),
        Column("overrun", "number"),
    )  # fmt: skip
    if rows:
        yield Table.cut("Attacks by attacker and side", heads, rows, _beside(document), "the JSON")
    why = document.maybe_text("why")
    if why is not None:
        yield Words(f"{why}.")


def _measured(document: Given, unit: str, size: float) -> Iterator[Part]:
    rows: list[tuple[Cell, ...]] = []
    bars: list[Bar] = []
    attackers = document.part("attackers")
    for name in attackers.values:
        found = attackers.part(name).maybe_part("measured")
        if found is None:
            continue
        low, high = found.number("low"), found.maybe_number("high")
        out, tried = found.share("escapes", "attacks")
        end = "no escape seen" if high is None else f"{high:.6g}"
        rows.append((
            Cell(name), number_cell(low, 6), Cell(end, high),
            number_cell(found.maybe_number("high_seen"), 6), count_cell(tried), count_cell(out),
            number_cell(found.number("penetration_max") / size, 2),
        ))  # fmt: skip
        bars.append(Bar(name, low, None, high, f"{low:.6g} to {end}"))
    if not rows:
        return
    heads = (
        Column("attacker"), Column(f"held at [{unit}]", "number"),
        Column(f"out at [{unit}]", "number"), Column(f"least opening seen [{unit}]", "number"),
        Column("attacks", "number"), Column("escapes", "number"),
        Column("deepest / diameter", "number"),
    )  # fmt: skip
    lines = [
        Line(level, name)
        for key, name in (("sigma_max", "sigma_max"),)
        if (level := document.maybe_number(key)) is not None
    ]
    yield Chart("Openings between which escapes begin", unit, tuple(bars), tuple(lines))
    yield Table.cut("Measured sigma_max", heads, rows, _beside(document), "the JSON")


def _failed(document: Given, failures: list[str]) -> Iterator[Part]:
    if not failures:
        yield Words("Everything that was planned held: there is no failure to list.")
    yield from (Words(f"{line}.") for line in failures)
    yield Command(
        of_case("icage escape", document, _options(document)),
        f"Attacks again with seed {document.count('seed')}, the same on any number of threads.",
    )


def _options(document: Given) -> list[str]:
    runs = [run for a in _attackers(document) if (run := a.maybe_part("below")) is not None]
    most = [str(max(run.count("attacks") for run in runs))] if runs else []
    return [*(["--attacks", *most] if most else []), "--seed", str(document.count("seed"))]


def _settings(document: Given) -> Iterator[Part]:
    for key, words in (
        ("derived", "The case has point fingers: attacked are discs, planned afresh."),
        (
            "another_grasp",
            "No disc fits at the case's own grasp: another of that hand is attacked.",
        ),
    ):
        if document.has(key) and document.flag(key):
            yield Words(words)
    for key, count in (("solref", 2), ("solimp", 5)):
        if document.has(key):
            values = " ".join(f"{value:g}" for value in document.numbers(key, count))
            yield Words(f"Contacts of the engine, {key}: {values}.")
    versions = document.maybe_part("versions")
    if versions is not None:
        words = ", ".join(f"{name} {versions.text(name)}" for name in versions.values)
        yield Words(f"{words}.")
