"""Tables as bytes that another process may send: believed only as far as they are checked."""

from __future__ import annotations

from typing import Any, Final

import pyarrow as pa

from experiments.io.arrow_table import Schema, Table

ROOM: Final = (1 << 20, 1 << 16)
"""[byte] A table may have so many, and so many more for each row that is expected."""


class TableBytesError(ValueError):
    """Bytes are not the table that was asked for; says why."""


def bytes_of(table: Table) -> bytes:
    """A table as an Arrow stream."""
    sink = pa.BufferOutputStream()
    plain: Any = table
    with pa.ipc.new_stream(sink, plain.schema) as stream:
        stream.write_table(plain)
    return bytes(sink.getvalue())


def table_in(data: Any, schema: Schema, rows: int | None = None, most: int = 0) -> Table:
    """The table of an Arrow stream: with these columns and so many rows, each value a whole one.

    Parameters
    ----------
    rows:
        How many there are; None: 1 up to ``most``.

    Raises
    ------
    TableBytesError:
        It is none, or another one.
    """
    wanted = most if rows is None else rows
    if not isinstance(data, bytes):
        raise TableBytesError(f"{type(data).__name__} instead of bytes")
    if len(data) > ROOM[0] + ROOM[1] * wanted:
        raise TableBytesError(f"{len(data)} bytes for {wanted} rows")
    try:
        with pa.ipc.open_stream(data) as stream:
            found: Any = stream.schema
            if not found.equals(schema, check_metadata=False):
                raise TableBytesError("its columns are others")
            table: Any = stream.read_all()
        table.validate(full=True)
    except (pa.ArrowException, ValueError, OSError, MemoryError) as error:
        if isinstance(error, TableBytesError):
            raise
        raise TableBytesError(f"it is no Arrow table: {error}") from error
    count = table.num_rows
    if not (count == rows if rows is not None else 1 <= count <= most):
        raise TableBytesError(f"{count} rows instead of {wanted}")
    return table
