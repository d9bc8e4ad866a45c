"""Placements of the hand from a table: CSV with the header ``x,y,theta,sigma``."""

from __future__ import annotations

import csv
import io
import math
import re
from pathlib import Path
from typing import BinaryIO, Final

import numpy as np

from icage.arrays import FloatArray
from icage.errors import FormatError, PlacementError
from icage.formats.files import decode, read_bytes

COLUMNS: Final = ("x", "y", "theta", "sigma")

MAX_BYTES: Final = 200_000_000
"""Largest table read."""

MAX_ROWS: Final = 1_000_000

LARGEST: Final = 1e100
"""Largest absolute number of a row: farther ones overflow when squared."""

_NUMBER = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?", re.ASCII)


def read_placements(path: Path) -> FloatArray:
    """Placements (k, 4) = x, y, theta [rad], sigma from a CSV file.

    Raises
    ------
    PlacementError:
        The file cannot be read or a row, which is named, is not usable.
    """
    try:
        text = decode(read_bytes(path, MAX_BYTES, "a table of placements"), str(path))
    except FormatError as error:
        raise PlacementError(str(error)) from error
    return parse_placements(text, str(path))


def read_placements_stream(stream: BinaryIO) -> FloatArray:
    """The same from an open stream, standard input say."""
    content = stream.read(MAX_BYTES + 1)
    if len(content) > MAX_BYTES:
        raise PlacementError(
            f"standard input has more than {MAX_BYTES / 1e6:g} MB, the most allowed"
        )
    try:
        text = decode(content, "standard input")
    except FormatError as error:
        raise PlacementError(str(error)) from error
    return parse_placements(text, "standard input")


def parse_placements(text: str, where: str) -> FloatArray:
    r"""Placements (k, 4) from the text of a table; blank lines are passed over.

    Examples
    --------
    >>> parse_placements("x,y,theta,sigma\n1,2,0,0.5\n", "the example").tolist()
    [[1.0, 2.0, 0.0, 0.5]]
    """
    reader = csv.reader(io.StringIO(text, newline=""), skipinitialspace=True)
    rows: list[list[float]] = []
    header: list[str] | None = None
    try:
        for cells in reader:
            if not any(cell.strip() for cell in cells):
                continue
            if header is None:
                header = _checked_header(cells, where)
                continue
            if len(rows) >= MAX_ROWS:
                raise PlacementError(f"{where} has more than {MAX_ROWS} rows, the most allowed")
            rows.append(_row(cells, f"{where}, row {len(rows) + 1} (line {reader.line_num})"))
    except csv.Error as error:
        raise PlacementError(f"{where}, line {reader.line_num}: not CSV: {error}") from error
    if header is None:
        raise PlacementError(f"{where} has no header; {','.join(COLUMNS)} is needed")
    return np.array(rows, dtype=np.float64).reshape(len(rows), 4)


def _checked_header(cells: list[str], where: str) -> list[str]:
    names = [cell.strip() for cell in cells]
    if tuple(names) != COLUMNS:
        found = ascii(",".join(names))
        raise PlacementError(f"{where}: the header is {found[:60]}; {','.join(COLUMNS)} is needed")
    return names


def _row(cells: list[str], place: str) -> list[float]:
    if len(cells) != len(COLUMNS):
        raise PlacementError(
            f"{place} has {len(cells)} columns; {len(COLUMNS)} are needed ({','.join(COLUMNS)})"
        )
    numbers: list[float] = []
    for name, cell in zip(COLUMNS, cells, strict=True):
        text = cell.strip()
        number = float(text) if _NUMBER.fullmatch(text) else math.nan
        if not abs(number) <= LARGEST:
            raise PlacementError(
                f"{place}: {name} is {ascii(text)[:40]}; a finite number "
                f"up to {LARGEST:g} is needed"
            )
        numbers.append(number)
    if numbers[3] < 0.0:
        raise PlacementError(f"{place}: sigma is {numbers[3]:g}; 0 or more is needed")
    return numbers
