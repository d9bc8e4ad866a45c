"""The report of physics as the judge of what friction leaves (``experiments.jams``)."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Sequence
from pathlib import Path

from experiments.io.intervals import wilson
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
from experiments.report.given import Given
from experiments.report.shell import quoted
from experiments.report.source import Source
from experiments.study.report.names import percent
from models import CASES, FRICTION, HARD

_FOLDERS = {"": ("cases", CASES), "friction/": ("friction", FRICTION), "hard/": ("hard", HARD)}


def jams_report(source: Source, page: Path) -> Report:
    """The page of ``python -m experiments.jams --json``."""
    document = Given(source.document, str(source.file))
    cases = document.parts("cases")
    failures = document.texts("failures")
    config = document.part("config")
    below = [run for _, run in _runs(cases) if run.text("side") == "below"]
    target, trials = _sum(below)
    low, high = wilson(target, trials)
    seeds = ", ".join(sorted({str(case.count("seed")) for case in cases})) or "-"
    mus = sorted({run.number("mu") for _, run in _runs(cases)})
    deepest = max((run.number("penetration") for _, run in _runs(cases)), default=None)
    settings = (
        f"Seed {seeds}, time step {config.number('time_step'):g} s, deepest finger "
        f"{'-' if deepest is None else f'{deepest:.2g}'} diameters, friction mu in its column. "
        "Lengths in object diameters, sigma in sigma_0; intervals are Wilson's at 95 %."
    )
    sections = [
        Section("Closings from both sides of the level", tuple(_closings(cases, settings))),
        Section("Jams that limit the level", tuple(_jams(cases, settings))),
        Section("What did not hold", tuple(_failed(cases, failures))),
        Section("Left out", tuple(_skipped(document))),
        Section("Made with", tuple(_made(document))),
    ]
    return Report(
        title="Physics as the judge of sigma_first(mu)",
        kind="jams",
        held=not failures,
        answer=(
            f"{target} of {trials} closings that began below the level sigma_first(mu) that "
            f"friction leaves ended in the target (95 %: {percent(low)} to {percent(high)}), on "
            f"{len(cases)} case{'' if len(cases) == 1 else 's'}."
        ),
        facts=(
            ("seed", seeds),
            ("cases", str(len(cases))),
            ("time step", f"{config.number('time_step'):g} s"),
            ("friction", f"{mus[0]:g} to {mus[-1]:g}" if mus else "-"),
            ("deepest finger", "-" if deepest is None else f"{deepest:.2g} diameters"),
        ),
        sections=tuple(section for section in sections if section.parts),
    )


def _runs(cases: Sequence[Given]) -> Iterator[tuple[Given, Given]]:
    for case in cases:
        for run in case.parts("closings"):
            yield case, run


def _sum(runs: Sequence[Given]) -> tuple[int, int]:
    shares = [run.share("target", "trials") for run in runs]
    return sum(share[0] for share in shares), sum(share[1] for share in shares)


def _closings(cases: Sequence[Given], settings: str) -> Iterator[Part]:
    rows: list[tuple[Cell, ...]] = []
    for case, run in _runs(cases):
        target, trials = run.share("target", "trials")
        rows.append((
            Cell(case.text("case")), number_cell(run.number("mu")), Cell(run.text("side")),
            count_cell(trials), count_cell(target), *rate_cells(target, trials),
            count_cell(run.count("from_afar")), count_cell(run.count("stray")),
            number_cell(run.number("residual"), 2), number_cell(run.number("penetration"), 2),
            count_cell(case.count("seed")),
        ))  # fmt: skip
    heads = (
        Column("case"), Column("friction mu", "number"), Column("began"),
        Column("trials", "number"), Column("target", "number"), *RATES,
        Column("from afar", "number"), Column("stray", "number"), Column("residual", "number"),
        Column("deepest / diameter", "number"), Column("seed", "number"),
    )  # fmt: skip
    beside = (
        f"{settings} From afar: began outside the tolerance of the target. Stray: ended where no "
        "forces within the cones balance; residual: the largest left over, in drive forces."
    )
    bars: list[tuple[str, list[Given]]] = []
    for mu in sorted({run.number("mu") for _, run in _runs(cases)}):
        for side in ("below", "above"):
            mine = [
                run for _, run in _runs(cases)
                if run.text("side") == side and run.number("mu") == mu
            ]  # fmt: skip
            if mine:
                bars.append((f"mu {mu:g}, from {side}", mine))
    yield Chart(
        "Closings that ended in the target, all cases", "%",
        tuple(rate_bar(name, *_sum(mine)) for name, mine in bars), ends=(0.0, 100.0),
    )  # fmt: skip
    yield Table.cut("Closings by case, friction and side", heads, rows, beside, "the JSON")


def _jams(cases: Sequence[Given], settings: str) -> Iterator[Part]:
    rows: list[tuple[Cell, ...]] = []
    for case in cases:
        for jam in case.parts("jams"):
            off = jam.maybe_number("off")
            weak, strong = (
                jam.part(key).share("stuck", "trials") for key in ("weaker", "stronger")
            )
            shares = [found / of if of else None for found, of in (weak, strong)]
            rows.append((
                Cell(case.text("case")), number_cell(jam.number("sigma"), 6),
                count_cell(jam.count("touching")), number_cell(jam.number("foretold"), 5),
                *(number_cell(jam.maybe_number(key), 5) for key in ("slips_at", "sticks_at")),
                Cell("-") if off is None else Cell(f"{100.0 * off:+.1f} %", off),
                Cell(f"{weak[0]} of {weak[1]}", shares[0]),
                Cell(f"{strong[0]} of {strong[1]}", shares[1]),
                number_cell(jam.number("penetration"), 2), count_cell(case.count("seed")),
            ))  # fmt: skip
    heads = (
        Column("case"), Column("sigma / sigma_0", "number"), Column("contacts", "number"),
        Column("holds from mu, foretold", "number"), Column("slips at", "number"),
        Column("sticks at", "number"), Column("off", "number"),
        Column("stuck at 0.9 of it", "number"), Column("stuck at 1.1", "number"),
        Column("deepest / diameter", "number"), Column("seed", "number"),
    )  # fmt: skip
    if rows:
        yield Table.cut("Limiting jams", heads, rows, settings, "the JSON")


def _failed(cases: Sequence[Given], failures: Sequence[str]) -> Iterator[Part]:
    if not failures:
        yield Words("Everything held: there is no failure to list.")
    shown = failures[:MOST_FAILURES]
    if shown:
        rows = tuple((Cell(line),) for line in shown)
        left = len(failures) - len(shown)
        yield Table("Failures", (Column("what"),), rows, "", left, "the JSON")
    again = tuple((Cell(case.text("case")), count_cell(case.count("seed")),
                   Cell(_again(case))) for case in cases[:MOST_FAILURES])  # fmt: skip
    if again:
        heads = (Column("case"), Column("seed", "number"), Column("judges it again", "command"))
        yield Table(
            "Every case again", heads, again,
            "With `--trials` and `--attacks` as they were; from a checkout.",
            len(cases) - len(again), "the JSON",
        )  # fmt: skip


def _again(case: Given) -> str:
    name = case.text("case")
    return f"python -m experiments.jams {quoted(_path(name))} --seed {case.count('seed')}"


def _path(name: str) -> str:
    """A shipped case's file in a checkout; the name itself for any other."""
    for prefix, (folder, place) in _FOLDERS.items():
        stem = name.removeprefix(prefix)
        if name.startswith(prefix) and "/" not in stem and (place / f"{stem}.json").is_file():
            return f"models/{folder}/{stem}.json"
    return name


def _skipped(document: Given) -> Iterator[Part]:
    skipped = document.parts("skipped")
    for one in skipped[:MOST_FAILURES]:
        yield Words(f"{one.text('case')}: {one.text('why')}.")
    if len(skipped) > MOST_FAILURES:
        yield Words(f"{len(skipped) - MOST_FAILURES} more are in the JSON.")


def _made(document: Given) -> Iterator[Part]:
    versions = document.part("versions")
    yield Words(f"{versions_words({k: versions.text(k) for k in versions.values})}.")
    yield Command(shlex.join(["python", "-m", "experiments.jams"]), "Judges every shipped case.")
