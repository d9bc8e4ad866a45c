"""STL meshes, binary and text.

Read here and not by a library: those at hand take what they can of a damaged file and say nothing.
"""

from __future__ import annotations

import re
from typing import Final

import numpy as np

from icage.arrays import FloatArray
from icage.errors import FormatError
from icage.formats.drawings.drawing import Drawing
from icage.formats.drawings.reading import Reading
from icage.formats.mesh.reader import seen
from icage.formats.mesh.triangles import check_count, checked

_HEADER: Final = 84
_TRIANGLE: Final = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("color", "<u2")])
_VERTEX: Final = re.compile(rb"\bvertex[ \t]+(\S+)[ \t]+(\S+)[ \t]+(\S+)", re.IGNORECASE)


def read(content: bytes, reading: Reading) -> Drawing:
    """The drawing that a mesh in an STL file makes. Raises FormatError."""
    return seen(checked(_triangles(content)), reading)


def _triangles(content: bytes) -> FloatArray:
    """(n, 3, 3) corners. Binary files may begin with "solid", too: what tells is the length."""
    count = int.from_bytes(content[80:84], "little") if len(content) >= _HEADER else 0
    if len(content) >= _HEADER and len(content) == _HEADER + count * _TRIANGLE.itemsize:
        check_count(count)
        return np.frombuffer(content, _TRIANGLE, count, _HEADER)["corners"].astype(float)
    if content[:1000].lstrip()[:5].lower() == b"solid" and b"\0" not in content[:1000]:
        return _text(content)
    held = (len(content) - _HEADER) // _TRIANGLE.itemsize
    raise FormatError(
        f"the STL file says that it has {count} triangles, but its length is that of {held}: it "
        "is damaged or cut off"
    )


def _text(content: bytes) -> FloatArray:
    # Names after "solid" and "endsolid" may be any words.
    body = re.sub(rb"(?im)^[ \t]*(?:end)?solid\b[^\r\n]*", b"", content)
    if re.search(rb"(?i)\bendsolid\b", content) is None:
        raise FormatError("the STL file is cut off: it has no endsolid")
    facets = len(re.findall(rb"(?i)\bendfacet\b", body))
    check_count(facets)
    found = _VERTEX.findall(body)
    said = len(re.findall(rb"(?i)\bvertex\b", body))
    if len(found) != 3 * facets or said != len(found):
        raise FormatError(
            f"the STL file has {facets} facets and {len(found)} vertices of three numbers; every "
            "facet needs three"
        )
    try:
        return np.array(found, dtype="S").astype(float).reshape(-1, 3, 3)
    except ValueError as error:
        raise FormatError(f"a vertex of the STL file is not three numbers ({error})") from error
