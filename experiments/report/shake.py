"""The report of a closed hand that was shaken."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

from experiments.report.content import (
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
    number_cell,
    versions_words,
)
from experiments.report.given import Given
from experiments.report.shell import of_case
from experiments.report.source import Source


def shake_report(source: Source, page: Path) -> Report:
    """The page of ``icage shake``."""
    document = Given(source.document, str(source.file))
    failures = document.texts("failures")
    name, unit, size = document.text("name"), document.text("unit"), document.positive("diameter")
    shaken = document.maybe_part("shake")
    config = document.part("config")
    deepest = None if shaken is None else shaken.number("penetration_max")
    sections = [
        Section("Pushes", tuple(_pushes(document, shaken, unit, size))),
        Section("Contacts", tuple(_contacts(document))),
        Section("Play", tuple(_play(document))),
        Section("What did not hold", tuple(_failed(document, failures))),
        Section("Made with", tuple(_made(document))),
    ]
    return Report(
        title=name,
        kind="shake",
        held=not failures and document.flag("held"),
        answer=_answer(document, name, unit, shaken),
        facts=(
            ("seed", str(document.count("seed"))),
            ("sigma_0", f"{document.number('sigma_0'):.6g} {unit}"),
            ("time step", f"{config.number('time_step'):g} s"),
            ("friction", f"{config.number('friction'):g}"),
            ("deepest finger", "-" if deepest is None else f"{deepest:.3g} {unit}"),
            ("finger radius", f"{document.number('finger_radius'):.4g} {unit}"),
        ),
        sections=tuple(section for section in sections if section.parts),
    )


def _answer(document: Given, name: str, unit: str, shaken: Given | None) -> str:
    closing = document.part("closing").text("outcome").replace("_", " ")
    if shaken is None:
        return f"The hand did not close into the target grasp of {name}: {closing}."
    far, turn = _farthest(shaken)
    limit = document.part("criterion")
    return (
        f"The closed hand {'holds' if document.flag('held') else 'does NOT hold'} {name}: pushed "
        f"and shaken it moved by at most {far:.2g} {unit} and turned by at most {turn:.2g} rad "
        f"(held: up to {limit.number('displacement'):.3g} {unit} and {limit.number('rotation'):g} "
        "rad)."
    )


def _farthest(shaken: Given) -> tuple[float, float]:
    every = [*shaken.parts("pushes"), shaken.part("random")]
    return max(one.number("displacement") for one in every), max(
        one.number("rotation") for one in every
    )


def _pushes(document: Given, shaken: Given | None, unit: str, size: float) -> Iterator[Part]:
    if shaken is None:
        return
    limit = document.part("criterion")
    pushes = [(_name(one), one) for one in shaken.parts("pushes")]
    named = [*pushes, ("random shake", shaken.part("random"))]
    rows = [
        (Cell(name), number_cell(one.number("displacement"), 3),
         number_cell(one.number("displacement") / size, 2), number_cell(one.number("rotation"), 3))
        for name, one in named
    ]  # fmt: skip
    config = document.part("config")
    beside = (
        f"Seed {document.count('seed')}, time step {config.number('time_step'):g} s, friction "
        f"{config.number('friction'):g}, deepest finger "
        f"{shaken.number('penetration_max') / size:.2g} diameters. Forces in shares of the closing "
        "force."
    )
    heads = (
        Column("push"), Column(f"moved [{unit}]", "number"), Column("over the diameter", "number"),
        Column("turned [rad]", "number"),
    )  # fmt: skip
    shares = [
        100.0 * one.number("displacement") / limit.positive("displacement") for _, one in named
    ]
    bars = [
        Bar(name, 0.0, share, share, f"{share:.2g} %")
        for (name, _), share in zip(named, shares, strict=True)
    ]
    yield Chart(
        "How far the object moved, in shares of what counts as held", "%", tuple(bars),
        (Line(100.0, "held up to here"),), (0.0, max(110.0, *shares)),
    )  # fmt: skip
    yield Table("What moved under which push", heads, tuple(rows), beside)


def _name(push: Given) -> str:
    torque = push.number("torque")
    if torque:
        return f"torque {'+' if torque > 0.0 else '-'}"
    x, y = push.numbers("force", 2)
    return f"force at {round(math.degrees(math.atan2(y, x))) % 360} degrees"


def _contacts(document: Given) -> Iterator[Part]:
    kinds = document.texts("contact_types")
    yield Words(
        "Fingers rest on: "
        + ", ".join(f"{k} {kind.replace('_', ' ')}" for k, kind in enumerate(kinds, 1))
        + "."
    )
    found = document.maybe_part("form_closure")
    if found is None:
        return
    order = "first order (form closure)" if found.flag("closed") else "second order only"
    agrees = "as" if found.flag("agrees_with_planner") else "NOT as"
    yield Words(
        f"Held to {order}: wrenches of rank {found.count('rank')}, {agrees} the planner's contacts "
        "ask for."
    )


def _play(document: Given) -> Iterator[Part]:
    if not document.has("play"):
        return
    rows: list[tuple[Cell, ...]] = []
    for one in document.parts("play"):
        low, high = one.numbers("measured", 2)
        where = "yes" if one.flag("on_edges") else "no"
        rows.append((
            number_cell(one.number("delta")), number_cell(low, 5), number_cell(high, 5),
            number_cell(one.number("law"), 5), Cell(where),
        ))  # fmt: skip
    heads = (
        Column("opened by delta", "number"), Column("turns to [rad]", "number"),
        Column("and to [rad]", "number"), Column("acos(1 / (1 + delta))", "number"),
        Column("on its edges"),
    )  # fmt: skip
    yield Table("Play of a hand a little larger", heads, tuple(rows))


def _failed(document: Given, failures: list[str]) -> Iterator[Part]:
    if not failures:
        yield Words("Everything held: there is no failure to list.")
    yield from (Words(f"{line}.") for line in failures)
    seed = str(document.count("seed"))
    yield Command(
        of_case("icage shake", document, ["--seed", seed]), f"Shakes again with seed {seed}."
    )


def _made(document: Given) -> Iterator[Part]:
    versions = document.part("versions")
    yield Words(f"{versions_words({k: versions.text(k) for k in versions.values})}.")
