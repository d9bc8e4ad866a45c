"""Tables on the disk: whole or not at all, with words that say whose they are and a digest."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, Final

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from experiments.io.arrow_table import Table
from experiments.io.own_files import DamagedError, open_own, unreadable
from icage.formats.whole_files import whole_file

MOST_ROWS: Final = 20_000_000
"""Rows of a table that is read, unless it may have fewer."""

_DIGEST: Final = b"icage-digest"

_AT_ONCE: Final = 1 << 16
"""[row] Looked at together for the digest: it does not hang on it."""


def write_table(
    table: Table, path: Path, words: Mapping[bytes, bytes], *, for_long: bool = True
) -> None:
    """Write a table, on the disk before it gets its name; ``words`` are kept with it.

    What is not there ``for_long`` is written plainly, in half the time.

    Raises
    ------
    OutputError:
        The disk is full, or the folder may not be written to; nothing of it is left.
    """
    kept = {**words, _DIGEST: digest(table).encode()}
    with whole_file(path) as part, part.open("wb") as stream:
        pq.write_table(
            table.replace_schema_metadata(kept), stream,
            compression="zstd" if for_long else "none", use_dictionary=for_long,
            write_statistics=for_long, write_page_checksum=True,
        )  # fmt: skip
        stream.flush()
        os.fsync(stream.fileno())
    sync_folder(path.parent)


def read_table(path: Path, most: int = MOST_ROWS) -> Table:
    """A table of at most ``most`` rows, as it was written.

    Raises
    ------
    UnreadableError:
        The system does not let it be read: it may be whole.
    DamagedError:
        It is no table of ours, or not as it was written.
    """
    with open_own(path) as stream:
        try:
            file = pq.ParquetFile(stream, page_checksum_verification=True)
            if file.metadata.num_rows > most:
                raise DamagedError(f"it says that it has {file.metadata.num_rows} rows")
            table: Table = file.read()
            found = digest(table)
        except OSError as error:
            if error.errno is not None:  # the disk's; a page that does not fit has none
                raise unreadable(path, error) from error
            raise _damaged(path, error) from error
        except (DamagedError, ValueError, KeyError, MemoryError, pa.ArrowException) as error:
            raise _damaged(path, error) from error
    if words_of(table).get(_DIGEST) != found.encode():
        raise DamagedError(f"{str(path)!r} is damaged: its rows are not those that were written")
    return table


def _damaged(path: Path, error: Exception) -> DamagedError:
    first = str(error).strip().split("\n")[0]
    return DamagedError(f"{str(path)!r} is damaged: {first}")


def words_of(table: Table) -> Mapping[bytes, bytes]:
    """What is kept with a table."""
    return table.schema.metadata or {}


def rows_and_words(path: Path) -> tuple[int, Mapping[bytes, bytes]]:
    """How many rows a table has and what is kept with it, by its own words; its rows are not read.

    Raises
    ------
    UnreadableError, DamagedError:
        As ``read_table``.
    """
    with open_own(path) as stream:
        try:
            file = pq.ParquetFile(stream)
            return int(file.metadata.num_rows), file.schema_arrow.metadata or {}
        except OSError as error:
            if error.errno is not None:
                raise unreadable(path, error) from error
            raise _damaged(path, error) from error
        except (ValueError, KeyError, MemoryError, pa.ArrowException) as error:
            raise _damaged(path, error) from error


def digest(table: Any) -> str:
    """SHA-256 of names, types and values, whatever pieces the table is in.

    >>> one = pa.table({"a": [1, None, 3]})
    >>> digest(one) == digest(pa.concat_tables([one.slice(0, 1), one.slice(1)]))
    True
    >>> digest(one) == digest(one.slice(0, 2))
    False
    """
    total = hashlib.sha256()
    for name in table.column_names:
        column = table[name]
        if pa.types.is_dictionary(column.type):
            column = column.cast(column.type.value_type)
        total.update(json.dumps([name, str(column.type), len(column)]).encode())
        for start in range(0, len(column), _AT_ONCE):
            total.update(_bytes(column.slice(start, _AT_ONCE)))
    return total.hexdigest()


def _bytes(values: Any) -> bytes:
    """Some values of a column; what lies under a null does not count."""
    kind = values.type
    if pa.types.is_floating(kind) or pa.types.is_integer(kind) or pa.types.is_boolean(kind):
        empty = False if pa.types.is_boolean(kind) else pa.scalar(0, kind)
        known = np.packbits(values.is_valid().to_numpy(zero_copy_only=False)).tobytes()
        return known + values.fill_null(empty).to_numpy(zero_copy_only=False).tobytes()
    return json.dumps(values.to_pylist(), default=repr).encode()


def sync_folder(folder: Path) -> None:
    """Have the disk know the new name: after a power cut it is there or it is not."""
    with suppress(OSError):  # some systems open no folders
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)
