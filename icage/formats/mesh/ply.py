"""PLY meshes, text and binary, faces of any number of corners. [Turk1994]"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

import numpy as np

from icage.arrays import FloatArray, IntArray
from icage.errors import FormatError
from icage.formats.drawings.drawing import Drawing
from icage.formats.drawings.reading import Reading
from icage.formats.mesh.reader import seen
from icage.formats.mesh.triangles import MAX_TRIANGLES, corners, fans

MAX_ROWS: Final = 3 * MAX_TRIANGLES
"""Of an element."""

_TYPES: Final = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2",
    "ushort": "u2", "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4",
    "float": "f4", "float32": "f4", "double": "f8", "float64": "f8",
}  # fmt: skip

_ORDERS: Final = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}

_CORNERS: Final = ("vertex_indices", "vertex_index")


@dataclass(slots=True)
class Element:
    """A table of the file: its rows, and name, type and, for a list, type of the count."""

    name: str
    rows: int
    properties: list[tuple[str, str, str | None]] = field(default_factory=list)


def read(content: bytes, reading: Reading) -> Drawing:
    """The drawing that a mesh in a PLY file makes. Raises FormatError."""
    order, elements, body = _header(content)
    source = _Text(body) if order == "" else _Binary(body, order)
    vertices: FloatArray | None = None
    faces: IntArray | None = None
    for element in elements:
        names = [name for name, _, _ in element.properties]
        if element.name == "vertex":
            plain = all(count is None for _, _, count in element.properties)
            if not plain or not {"x", "y", "z"} <= set(names):
                raise FormatError(
                    "the vertices of the PLY file need the properties x, y and z, and no lists"
                )
            _, table = source.table(element, None)
            vertices = np.column_stack([table[names.index(axis)] for axis in "xyz"])
        elif element.name == "face":
            lists_of = [name for name, _, count in element.properties if count is not None]
            own = next((name for name in lists_of if name in _CORNERS), None)
            if own is None:
                raise FormatError("the faces of the PLY file have no list of vertex_indices")
            lists, _ = source.table(element, own)
            assert lists is not None
            faces = fans(*lists)
        elif element.name == "tristrips":
            raise FormatError("the PLY file has triangle strips, which are not read: export STL")
        else:
            source.table(element, None)
    if vertices is None or faces is None:
        raise FormatError("the PLY file has no faces: a mesh is needed, not points alone")
    return seen(corners(vertices, faces), reading)


def _header(content: bytes) -> tuple[str, list[Element], bytes]:
    head, end, body = content[:100_000].partition(b"end_header")
    if not content.startswith(b"ply") or not end:
        raise FormatError("this is no PLY file: it does not begin with a header of its kind")
    start = len(head) + len(end)
    newline = content.find(b"\n", start)
    body = content[newline + 1 :] if newline >= 0 else b""
    order: str | None = None
    elements: list[Element] = []
    for line in head.decode("latin-1").splitlines():
        words = line.split()
        try:
            if words[:1] == ["format"]:
                order = _ORDERS[words[1]]
            elif words[:1] == ["element"]:
                elements.append(Element(words[1], int(words[2])))
                if not 0 <= elements[-1].rows <= MAX_ROWS:
                    raise FormatError(
                        f"the PLY file says that it has {words[2][:20]} rows of {words[1]!r}; "
                        f"at most {MAX_ROWS} are allowed"
                    )
            elif words[:2] == ["property", "list"]:
                elements[-1].properties.append((words[4], _TYPES[words[3]], _TYPES[words[2]]))
            elif words[:1] == ["property"]:
                elements[-1].properties.append((words[2], _TYPES[words[1]], None))
        except (LookupError, ValueError) as error:
            raise FormatError(f"the header of the PLY file has {line.strip()[:60]!r}") from error
    if order is None:
        raise FormatError("the header of the PLY file states no format")
    return order, elements, body


_Lists = tuple[IntArray, IntArray]
"""How many entries the list of each row has, and all entries one after the other."""


class _Binary:
    """Rows of bytes, taken from the front."""

    def __init__(self, body: bytes, order: str) -> None:
        self._body, self._order, self._at = body, order, 0

    def table(self, element: Element, own: str | None) -> tuple[_Lists | None, list[FloatArray]]:
        """The list called ``own`` of every row, and the columns that are no lists."""
        if not element.rows:
            empty = np.zeros(0, dtype=np.int64)
            return ((empty, empty) if own else None), [np.zeros(0) for _ in element.properties]
        if all(count is None for _, _, count in element.properties):
            rows = self._rows(self._row(element, []), element.rows)
            return None, [rows[f"f{k}"].astype(float) for k in range(len(element.properties))]
        return self._with_lists(element, own), []

    def _row(self, element: Element, sizes: list[int]) -> np.dtype[np.void]:
        fields: list[tuple[str, str] | tuple[str, str, tuple[int]]] = []
        for k, (_, kind, count) in enumerate(element.properties):
            if count is None:
                fields.append((f"f{k}", self._order + kind))
            else:
                fields.append((f"n{k}", self._order + count))
                fields.append((f"f{k}", self._order + kind, (sizes[k],)))
        return np.dtype(fields)

    def _rows(self, row: np.dtype[np.void], count: int) -> np.ndarray:
        if self._at + count * row.itemsize > len(self._body):
            raise FormatError("the PLY file is cut off: its header promises more rows")
        rows = np.frombuffer(self._body, row, count, self._at)
        self._at += count * row.itemsize
        return rows

    def _with_lists(self, element: Element, own: str | None) -> _Lists | None:
        """Runs of rows whose lists have the same lengths are read at once."""
        counts: list[IntArray] = []
        entries: list[IntArray] = []
        done, runs = 0, 0
        while done < element.rows:
            sizes = self._sizes(element)
            row = self._row(element, sizes)
            left = (len(self._body) - self._at) // row.itemsize
            if left < 1:
                raise FormatError("the PLY file is cut off: its header promises more rows")
            step = min(left, element.rows - done, 64 if runs else element.rows)
            rows = np.frombuffer(self._body, row, step, self._at)
            same = np.ones(step, dtype=bool)
            for k, (_, _, count) in enumerate(element.properties):
                if count is not None:
                    same &= rows[f"n{k}"] == sizes[k]
            step = step if same.all() else int(same.argmin())
            for k, (name, _, _) in enumerate(element.properties):
                if name == own:
                    counts.append(np.full(step, sizes[k], dtype=np.int64))
                    entries.append(rows[f"f{k}"][:step].astype(np.int64).ravel())
            self._at += step * row.itemsize
            done, runs = done + step, runs + 1
        return (np.concatenate(counts), np.concatenate(entries)) if own else None

    def _sizes(self, element: Element) -> list[int]:
        """Lengths of the lists of the next row; 0 for what is none."""
        at, sizes = self._at, [0] * len(element.properties)
        for k, (_, kind, count) in enumerate(element.properties):
            if count is not None:
                width = np.dtype(count).itemsize
                size = np.frombuffer(self._body[at : at + width], self._order + count)
                if not len(size) or size[0] < 0 or not float(size[0]).is_integer():
                    raise FormatError("the PLY file is cut off or has a list of no length")
                sizes[k], at = int(size[0]), at + width
            at += np.dtype(kind).itemsize * (1 if count is None else sizes[k])
            if at > len(self._body):
                raise FormatError("the PLY file is cut off: its header promises more rows")
        return sizes


class _Text:
    """Rows of numbers as text, taken from the front; lines do not matter."""

    def __init__(self, body: bytes) -> None:
        words = body.split()
        try:
            self._numbers = np.array(words, dtype="S").astype(float) if words else np.zeros(0)
        except ValueError as error:
            raise FormatError(f"the PLY file has text where numbers are due ({error})") from error
        self._at = 0

    def table(self, element: Element, own: str | None) -> tuple[_Lists | None, list[FloatArray]]:
        """As of ``_Binary``."""
        width = len(element.properties)
        if all(count is None for _, _, count in element.properties):
            rows = self._next(element.rows * width).reshape(element.rows, width)
            return None, list(rows.T)
        counts: list[int] = []
        entries: list[FloatArray] = []
        for _ in range(element.rows):
            for name, _, count in element.properties:
                size = 1 if count is None else float(self._next(1)[0])
                if not (size >= 0.0 and float(size).is_integer()):
                    raise FormatError(f"the PLY file has a list of length {size:g}")
                values = self._next(int(size))
                if name == own:
                    counts.append(int(size))
                    entries.append(values)
        if own is None:
            return None, []
        flat = np.concatenate(entries) if entries else np.zeros(0)
        if not (np.abs(flat) <= MAX_ROWS).all():
            raise FormatError("the PLY file has a face with a vertex that is not there")
        return (np.array(counts, dtype=np.int64), flat.astype(np.int64)), []

    def _next(self, count: int) -> FloatArray:
        if self._at + count > len(self._numbers):
            raise FormatError("the PLY file is cut off: its header promises more rows")
        self._at += count
        return self._numbers[self._at - count : self._at]
