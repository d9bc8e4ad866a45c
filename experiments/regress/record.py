"""Closings of a regression kept as a replay keeps them, so that any one can be run again.

``icage replay-trial DIR INDEX`` reads the folder: each set of each case is a run.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pyarrow as pa

from experiments.io.arrow_table import Table
from experiments.io.parquet_files import words_of, write_table
from experiments.io.versions import versions
from experiments.io.whole_folder import whole_folder
from experiments.regress.measure import Row
from experiments.replay.files import ALL, JSON, TRIALS, trial_table
from experiments.replay.run import Replay, run_document
from icage.formats.json_out import write_json
from icage.formats.plan_json import plan_document

Record = tuple[list[dict[str, Any]], Table | None]
"""Run documents and a row per trial, of one case."""


def record_of(row: Row) -> Record:
    """What is kept of a case; its caging regions are left out."""
    runs = tuple(closed.run for closed in row.closed)
    if not runs:
        return [], None
    documents = [
        run_document(run, plan_document(run.cage, (), run.case.name, run.case.unit)) for run in runs
    ]
    return documents, trial_table(Replay(runs, row.seed))


def write_records(records: list[Record], seed: int, folder: Path) -> None:
    """``replay.json`` and ``trials.parquet``, both or none."""
    runs: list[dict[str, Any]] = []
    tables: list[Table] = []
    for documents, table in records:
        if table is not None:
            place = table.schema.get_field_index("run")
            shifted = pa.array([len(runs) + k for k in table["run"].to_pylist()])
            tables.append(table.set_column(place, "run", shifted).unify_dictionaries())
        runs += documents
    document = {
        "format": "icage-replay/1",
        "name": "regress",
        "seed": seed,
        "versions": versions(),
        "runs": runs,
    }
    with whole_folder(folder, ALL) as staging:
        write_json(document, str(staging / JSON))
        if tables:
            whole = pa.concat_tables(tables).unify_dictionaries()
            write_table(whole, staging / TRIALS, words_of(whole))
