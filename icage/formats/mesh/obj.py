"""OBJ meshes: vertices and faces; materials and textures are not opened."""

from __future__ import annotations

from array import array
from typing import Final

import numpy as np

from icage.errors import FormatError
from icage.formats.drawings.drawing import Drawing
from icage.formats.drawings.reading import Reading
from icage.formats.files import decode
from icage.formats.mesh.reader import seen
from icage.formats.mesh.triangles import MAX_TRIANGLES, check_count, corners, fans

MAX_VERTICES: Final = 3 * MAX_TRIANGLES
"""Of a mesh."""

_CURVED: Final = frozenset(("curv", "curv2", "surf", "bzp", "bsp", "cstype", "call"))


def read(content: bytes, reading: Reading) -> Drawing:
    """The drawing that a mesh in an OBJ file makes. Raises FormatError."""
    vertices = array("d")
    count = 0
    counts: list[int] = []
    numbers: list[int] = []
    text = decode(content, "the OBJ file").replace("\\\r\n", " ").replace("\\\n", " ")
    for place, line in enumerate(text.splitlines(), start=1):
        words = line.split()
        if not words:
            continue
        if words[0] == "v":
            if len(words) < 4:
                raise FormatError(f"line {place} of the OBJ file: a vertex needs three numbers")
            try:
                vertices.extend(map(float, words[1:4]))
            except ValueError as error:
                raise FormatError(
                    f"line {place} of the OBJ file: a vertex is not three numbers ({error})"
                ) from error
            count += 1
        elif words[0] == "f":
            if len(words) < 4:
                raise FormatError(f"line {place} of the OBJ file: a face needs three vertices")
            counts.append(len(words) - 1)
            numbers += [_number(word, count, place) for word in words[1:]]
            check_count(len(counts))
        elif words[0] in _CURVED:
            raise FormatError(f"line {place} of the OBJ file: {words[0]!r} is not read: export STL")
        if count > MAX_VERTICES:
            raise FormatError(f"the mesh has more than {MAX_VERTICES} vertices; simplify it")
    points = np.array(vertices, dtype=float).reshape(-1, 3)
    faces = fans(np.array(counts, dtype=np.int64), np.array(numbers, dtype=np.int64))
    return seen(corners(points, faces), reading)


def _number(word: str, count: int, place: int) -> int:
    """The vertex of ``v/vt/vn``, from 0; a negative number counts back from the last one."""
    try:
        number = int(word.split("/", 1)[0])
    except ValueError:
        number = 0
    if number == 0 or number < -count or abs(number) > MAX_VERTICES:
        raise FormatError(f"line {place} of the OBJ file: {word[:20]!r} is no vertex")
    return number - 1 if number > 0 else count + number
