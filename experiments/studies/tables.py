"""The tables of docs/studies.md, from the committed results.

python -m experiments.studies.tables [DIR]
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from experiments.studies.__main__ import OUT, ready
from experiments.study.results_md import table
from experiments.study.shown import percent


def found_in(folder: Path) -> dict[str, dict[str, Any]]:
    """Name to document of every finished study of ``ready()``, in its order."""
    documents: dict[str, dict[str, Any]] = {}
    for one in ready():
        path = folder / one.name / "study.json"
        if path.exists():
            document = json.loads(path.read_text(encoding="utf-8"))
            if document["finished"]:
                documents[one.name] = document
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


def main(folder: str = str(OUT)) -> None:
    """Print all tables."""
    documents = found_in(Path(folder))
    for lines in (
        overview(documents), by_value(documents, "friction"), by_value(documents, "speed")
    ):  # fmt: skip
        print("\n".join(lines))
        print()


if __name__ == "__main__":
    main(*sys.argv[1:])
