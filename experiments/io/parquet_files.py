"""Tables on the disk: whole or not at all, with words that say whose they are."""

from __future__ import annotations

import os
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from experiments.io.arrow_table import Table
from icage.formats.whole_files import whole_file


def write_table(table: Table, path: Path, words: Mapping[bytes, bytes]) -> None:
    """Write a table, on the disk before it gets its name; ``words`` are kept with it.

    Raises
    ------
    OutputError:
        The disk is full, or the folder may not be written to; nothing of it is left.
    """
    with whole_file(path) as part, part.open("wb") as stream:
        pq.write_table(
            table.replace_schema_metadata(words), stream,
            compression="zstd", write_page_checksum=True,
        )  # fmt: skip
        stream.flush()
        os.fsync(stream.fileno())
    sync_folder(path.parent)


def read_table(path: Path) -> Table | None:
    """A table, every page of it as it was written; else None."""
    try:
        table: Table = pq.read_table(path, page_checksum_verification=True)
    except (OSError, ValueError, pa.ArrowException):
        return None
    return table


def words_of(table: Table) -> Mapping[bytes, bytes]:
    """What is kept with a table."""
    return table.schema.metadata or {}


def sync_folder(folder: Path) -> None:
    """Have the disk know the new name: after a power cut it is there or it is not."""
    with suppress(OSError):  # some systems open no folders
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)
