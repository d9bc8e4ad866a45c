"""The report of a regression: the planner against physics, a row a case."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final

from experiments.io.own_files import DamagedError
from experiments.regress.table import HEAD, LEGEND, bottom_line, table
from experiments.report.content import (
    MOST_FAILURES,
    RATES,
    UPPER,
    Cell,
    Column,
    Command,
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
from experiments.report.source import Source

_LEVELS: Final = ("fast", "default", "full")
_ATTACKERS: Final = ("random", "guided", "rigid")


def regress_report(source: Source, page: Path) -> Report:
    """The page of ``icage regress --json``."""
    document = Given(source.document, str(source.file))
    level = document.text("level")
    if level not in _LEVELS:
        raise DamagedError(f"{document.where}: there is no level {level!r}")
    rows = document.parts("cases")
    plain = [row.values for row in rows]
    try:
        answer = f"{bottom_line(plain)}."
        lines = table(plain)[1:]
        if not all(isinstance(text, str) for line in lines for text in line):  # pyright: ignore
            raise TypeError("a name is no text")
    except (
        KeyError,
        TypeError,
        ValueError,
        AttributeError,
        IndexError,
        ZeroDivisionError,
    ) as error:
        raise DamagedError(f"{document.where} is no regression's document: {error!r}") from error
    failures = [(row, line) for row in rows for line in row.texts("failures")]
    beside = f"{_settings(rows)} {LEGEND}"
    sections = [
        Section("Rates", tuple(_rates(rows))),
        Section("What did not hold", tuple(_failed(failures, level))),
        Section(
            "Cases", (Table.cut("Every case", _heads(), _cells(lines), beside, source.file.name),)
        ),
    ]
    return Report(
        title=f"Planner against physics ({level})",
        kind="regress",
        held=not failures,
        answer=answer,
        facts=(
            ("seed", ", ".join(sorted({str(row.count("seed")) for row in rows})) or "-"),
            ("cases", str(len(rows))),
            ("time step", _time_step(rows)),
            ("friction", "0, but where it is named"),
            ("deepest finger", _deepest(rows)),
        ),
        sections=tuple(sections),
    )


def _heads() -> tuple[Column, ...]:
    texts = ("case", "discs", "held", "verdict")
    return tuple(Column(name, "text" if name in texts else "number") for name in HEAD)


def _cells(lines: Sequence[tuple[str, ...]]) -> list[tuple[Cell, ...]]:
    return [tuple(Cell(text, _leading(text)) for text in line) for line in lines]


def _leading(text: str) -> float | None:
    """The share or the number that a cell begins with."""
    first = text.split()[0] if text.split() else ""
    counts = first.split("/")
    try:
        return float(counts[0])
    except ValueError:
        return None


def _attacks(rows: Sequence[Given]) -> list[Given]:
    return [part for row in rows if (part := row.maybe_part("attacks")) is not None]


def _time_step(rows: Sequence[Given]) -> str:
    steps = {step for run in _attacks(rows) if (step := run.maybe_number("time_step")) is not None}
    return ", ".join(f"{step:g} s" for step in sorted(steps)) or "-"


def _deepest(rows: Sequence[Given]) -> str:
    depths = [run.number("penetration") for run in _attacks(rows)]
    depths += [one.number("penetration") for _, _, one in _closings(rows)]
    return f"{max(depths):.2g} diameters" if depths else "-"


def _settings(rows: Sequence[Given]) -> str:
    seeds = ", ".join(sorted({str(row.count("seed")) for row in rows}))
    return (
        f"Seed {seeds or '-'}, time step {_time_step(rows)}, friction only where it is named, "
        f"deepest finger {_deepest(rows)}."
    )


def _closings(rows: Sequence[Given]) -> Iterator[tuple[Given, str, Given]]:
    for row in rows:
        sets = row.part("closings")
        for name in sets.values:
            yield row, name, sets.part(name)


def _rates(rows: Sequence[Given]) -> Iterator[Part]:
    lines: list[tuple[Cell, ...]] = []
    beside = _settings(rows)
    for name in ("guaranteed", "rest", "outside"):
        runs = [one for _, which, one in _closings(rows) if which == name]
        shares = [run.share("target", "trials") for run in runs]
        found, of = (sum(share[k] for share in shares) for k in (0, 1))
        deep = max((run.number("penetration") for run in runs), default=None)
        if of:
            lines.append((
                Cell(f"closings, {name}: in the target"), count_cell(found), count_cell(of),
                *rate_cells(found, of), Cell("-"), number_cell(deep, 2), Cell("0", 0.0),
            ))  # fmt: skip
    for side in ("below", "above"):
        for name in _ATTACKERS:
            runs = [
                run
                for one in _attacks(rows)
                if one.text("verdict") != "too_thin_for_physics"
                and (attacker := one.maybe_part(name)) is not None
                and (run := attacker.maybe_part(side)) is not None
            ]
            shares = [run.share("escapes", "attacks") for run in runs]
            found, of = (sum(share[k] for share in shares) for k in (0, 1))
            deep = max((run.number("penetration") for run in runs), default=None)
            if of:
                bound = upper_cell(found, of) if side == "below" else Cell("-")
                lines.append((
                    Cell(f"{name} attacks {side} sigma_max: escapes"), count_cell(found),
                    count_cell(of), *rate_cells(found, of), bound,
                    number_cell(deep, 2), Cell("0", 0.0),
                ))  # fmt: skip
    rubbed = [run for row in rows if row.has("friction") for run in row.parts("friction")]
    for mu in sorted({run.number("mu") for run in rubbed}):
        runs = [run for run in rubbed if run.number("mu") == mu]
        shares = [run.share("target", "trials") for run in runs]
        found, of = (sum(share[k] for share in shares) for k in (0, 1))
        deep = max(run.number("penetration") for run in runs)
        lines.append((
            Cell("closings with friction: within the tolerance"), count_cell(found), count_cell(of),
            *rate_cells(found, of), Cell("-"), number_cell(deep, 2), number_cell(mu),
        ))  # fmt: skip
    heads = (
        Column("of what"), Column("count", "number"), Column("of", "number"), *RATES, UPPER,
        Column("deepest / diameter", "number"), Column("friction", "number"),
    )  # fmt: skip
    yield Table("Rates over all cases", heads, tuple(lines), beside)


def _failed(failures: Sequence[tuple[Given, str]], level: str) -> Iterator[Part]:
    option = "" if level == "default" else f" --{level}"
    again = f"icage regress{option}"
    if not failures:
        yield Words("Everything held: there is no failure to list.")
    else:
        shown = failures[:MOST_FAILURES]
        rows = tuple((Cell(row.text("case")), count_cell(row.count("seed")), Cell(line),
                      Cell(again)) for row, line in shown)  # fmt: skip
        heads = (
            Column("case"), Column("seed", "number"), Column("what"),
            Column("measures it again", "command"),
        )  # fmt: skip
        left = len(failures) - len(shown)
        yield Table("Failures", heads, rows, "", left, "the JSON")
    yield Command(
        f"{again} --out DIR",
        "Measures all cases again with the same seed (of another folder of cases, with its "
        "`--cases`), and keeps every closing in DIR: `icage report DIR` lists those that failed "
        "with the command that plays each.",
    )
