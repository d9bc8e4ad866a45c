"""A table of trials without the columns of a replay is told by the first that is missing."""

from __future__ import annotations

import json
from pathlib import Path

import pyarrow as pa
import pytest

from experiments.io.parquet_files import write_table
from experiments.replay.recorded_trial import (
    _COLUMNS,
    JSON,
    TABLE_FORMAT,
    TRIALS,
    RecordingError,
    read_trial,
)


@pytest.mark.parametrize("missing", _COLUMNS)
def test_a_missing_column_is_named(tmp_path: Path, missing: str) -> None:
    document = {"format": "icage-replay/1", "versions": {}, "runs": []}
    (tmp_path / JSON).write_text(json.dumps(document))
    columns = {name: [0] for name in _COLUMNS if name != missing}
    write_table(pa.table(columns), tmp_path / TRIALS, {b"format": TABLE_FORMAT})
    with pytest.raises(RecordingError, match=f"has no column '{missing}'"):
        read_trial(tmp_path, 0)
