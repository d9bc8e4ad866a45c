"""The tables of docs/studies.md, from the committed results.

python -m experiments.study.ready.tables [DIR]
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from experiments.io.arrow_table import Table
from experiments.study.ready.__main__ import OUT, ready
from experiments.study.report.names import percent
from experiments.study.report.results_md import table
from experiments.study.report.summary import NEAR_ANGLE, NEAR_POSITION
from experiments.study.run.document import fingerprint
from experiments.study.run.finished import is_finished, read_finished
from experiments.study.run.folder import TRIALS, StudyFolder, read_document


def found_in(folder: Path) -> dict[str, dict[str, Any]]:
    """Name to document of every finished study of ``ready()``, in its order."""
    documents: dict[str, dict[str, Any]] = {}
    for one in ready():
        document = read_document(folder / one.name)
        if document is not None and is_finished(document):
            documents[one.name] = read_finished(folder / one.name)
    return documents


def overview(documents: Mapping[str, Mapping[str, Any]]) -> Iterator[str]:
    """A row per study."""
    head = ("study", "trials", "not closed", "in the target, of those closed", "95 %", "elsewhere")
    rows: list[Sequence[str]] = []
    for name, document in documents.items():
        found = document["found"]
        interval = found["target_rate_of_closed_95"]
        elsewhere = {
            k: v
            for k, v in found["outcomes"].items()
            if v and k not in ("target", "collision", "not_caged", "no_shape")
        }
        rows.append((
            f"[{name}](studies/{name}/results.md)", str(found["trials"]),
            str(found["trials"] - found["closed"]),
            _of_closed(found),
            " to ".join(percent(end) for end in interval) if interval else "",
            ", ".join(f"{v} {k.replace('_', ' ')}" for k, v in elsewhere.items()) or "none",
        ))  # fmt: skip
    yield from table(head, rows)


def _of_closed(found: Mapping[str, Any]) -> str:
    """Counts of the independent closings, which the interval is of."""
    one = found["independent"]
    return f"{one['target']} of {one['closed']}"


def by_value(documents: Mapping[str, Mapping[str, Any]], variable: str) -> Iterator[str]:
    """Rates over a variable on a grid, a column per study that has it."""
    columns = {
        name: {b["mean"]: b for b in document["found"]["variables"][variable]["bins"]}
        for name, document in documents.items()
        if name.startswith(variable) and variable in document["found"]["variables"]
    }
    if not columns:
        return
    values = sorted({value for bins in columns.values() for value in bins})
    names = [name.removeprefix(f"{variable}-").replace("-", " ") for name in columns]
    rows: list[Sequence[str]] = []
    for value in values:
        cells = [bins.get(value) for bins in columns.values()]
        shares = ["" if b is None else f"{b['target']} of {b['trials']}" for b in cells]
        rows.append((f"{value:g}", *shares))
    yield from table((variable, *names), rows)


def nearby(folder: Path, study: str, over: str, position: float, angle: float) -> Iterator[str]:
    """Closings per value of ``over`` that ended within ``position`` [diameter], ``angle`` [rad]."""
    columns: dict[str, dict[float, list[bool]]] = {}
    for one in ready():
        trials = _trials(folder / one.name) if one.file == study else None
        if trials is not None:
            size = read_finished(folder / one.name)["diameter"]
            names = (over, "position_error", "angle_error")
            cells = columns.setdefault(one.name.removeprefix(f"{study}-").replace("-", " "), {})
            for value, off, turn in zip(*(trials[k].to_pylist() for k in names), strict=True):
                cells.setdefault(value, []).append(off <= position * size and turn <= angle)
    values = sorted({value for cells in columns.values() for value in cells})
    lines = [
        (f"{v:g}", *(f"{sum(cells[v])} of {len(cells[v])}" for cells in columns.values()))
        for v in values
    ]
    yield from table((over, *columns), lines)


def by_two(folder: Path, study: str, rows: str, columns: str) -> Iterator[str]:
    """Closings of a study over two variables on grids: a line per value of ``rows`` and tool."""
    grids: dict[str, dict[tuple[float, float], list[bool]]] = {}
    for one in ready():
        trials = _trials(folder / one.name) if one.file == study else None
        if trials is not None:
            names = (rows, columns, "outcome")
            cells = grids.setdefault(one.name.removeprefix(f"{study}-"), {})
            for a, b, outcome in zip(*(trials[k].to_pylist() for k in names), strict=True):
                cells.setdefault((a, b), []).append(outcome == "target")
    if not grids:
        return
    pairs = sorted({pair for cells in grids.values() for pair in cells})
    over = sorted({b for _, b in pairs})
    head = [f"{name}, {columns.replace('_', ' ')} {b:g}" for name in grids for b in over]
    lines = [
        (f"{math.degrees(a):.4g} deg", *(
            f"{sum(cells[a, b])} of {len(cells[a, b])}" for cells in grids.values() for b in over
        ))
        for a in sorted({a for a, _ in pairs})
    ]  # fmt: skip
    yield from table((rows, *head), lines)


def _trials(folder: Path) -> Table | None:
    """The table of a finished study, as the study wrote it; None if it is not there."""
    if not (folder / TRIALS).exists():
        return None
    return StudyFolder(folder, fingerprint(read_finished(folder))).finished()


def main(folder: str = str(OUT)) -> None:
    """Print all tables."""
    documents = found_in(Path(folder))
    for lines in (
        overview(documents), by_value(documents, "friction"), by_value(documents, "speed"),
        nearby(Path(folder), "friction", "friction", NEAR_POSITION, NEAR_ANGLE),
        by_two(Path(folder), "tilt", "tilt", "table_friction"),
    ):  # fmt: skip
        print("\n".join(lines))
        print()


if __name__ == "__main__":
    main(*sys.argv[1:])
