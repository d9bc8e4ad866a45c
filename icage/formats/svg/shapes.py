"""Filled shapes of a drawing as rings of curves: svgelements read, transforms applied.

svgelements resolves groups, ``use``, styles, lengths and view boxes; the curves are built here
from its untransformed segments and its matrix, because it turns a skewed circle into the wrong
ellipse.
"""

from __future__ import annotations

import io
import math
from collections.abc import Iterator
from typing import Any, Final, cast
from xml.etree.ElementTree import fromstring

import numpy as np
import svgelements as svg

from icage.arrays import FloatArray
from icage.errors import FormatError
from icage.formats.drawings.curves import Bezier, Curve, EllipseArc
from icage.formats.drawings.fill import FillRule

Ring = list[Curve]
Shape = tuple[FillRule, list[Ring]]

MAX_CURVES: Final = 50_000
"""Lines and curves of a drawing."""

_SHOWN: Final = 60
"""Characters of a malformed attribute in the message."""

_INVISIBLE: Final = ("none", "transparent")


def drawn_shapes(content: bytes) -> Iterator[Shape]:
    """Fill rule and rings of every shape that is filled, transforms applied, y upwards."""
    try:
        document = svg.SVG.parse(io.BytesIO(content), reify=False, on_error="raise")
        elements: list[Any] = list(document.elements()) if document is not None else []
    except Exception as error:  # whatever an untyped parser throws at a malformed attribute
        raise FormatError(f"the drawing cannot be read: {_malformed(content)}") from error
    count = 0
    for element in elements:
        if not isinstance(element, svg.Shape) or not _is_filled(element):
            continue
        rings = _rings(element)
        count += sum(len(ring) for ring in rings)
        if count > MAX_CURVES:
            raise FormatError(f"the drawing has more than {MAX_CURVES} lines and curves")
        if rings:
            rule = str(cast(Any, element).values.get("fill-rule", "nonzero")).strip()
            yield ("evenodd" if rule == "evenodd" else "nonzero"), rings


def _malformed(content: bytes) -> str:
    """Which attribute the parser could not make sense of: its own words are no help."""
    readers = {"d": svg.Path, "transform": svg.Matrix, "points": svg.Polygon}
    for element in fromstring(content).iter():
        for key, reader in readers.items():
            value = element.get(key)
            if value is None:
                continue
            try:
                reader(value)
            except Exception:
                name = element.tag.rpartition("}")[2]
                short = value if len(value) <= _SHOWN else value[:_SHOWN] + "..."
                return f"<{name}> has a malformed {key}={short!r}"
    return "an attribute is malformed"


def _is_filled(shape: svg.Shape) -> bool:
    values: dict[str, Any] = cast(Any, shape).values
    if isinstance(shape, svg.SimpleLine):
        return False
    if values.get("clip-path", "none") != "none":
        raise FormatError("a shape has a clip-path, which is not supported")
    if str(values.get("visibility", "visible")).strip() in ("hidden", "collapse"):
        return False
    if any(_is_zero(values.get(key)) for key in ("opacity", "fill-opacity")):
        return False
    return str(values.get("fill", "black")).strip().lower() not in _INVISIBLE


def _is_zero(opacity: Any) -> bool:
    try:
        return float(str(opacity).strip().rstrip("%")) <= 0.0
    except ValueError:
        return False


def _rings(shape: Any) -> list[Ring]:
    """Closed rings of curves; an open subpath is closed by a line, as a fill is."""
    t = shape.transform
    linear = np.array([[t.a, t.b], [t.c, t.d]], dtype=np.float64)
    shift = np.array([t.e, t.f], dtype=np.float64)
    flip = np.array([1.0, -1.0])

    def placed(point: Any) -> FloatArray:
        return (np.array([point.x, point.y], dtype=np.float64) @ linear + shift) * flip

    def turned(offset: FloatArray) -> FloatArray:
        return (offset @ linear) * flip

    rings: list[Ring] = []
    ring: Ring = []
    for segment in shape.segments(transformed=False):
        if isinstance(segment, svg.Move | svg.Close):
            _finish(ring, rings)
            ring = []
        elif isinstance(segment, svg.Arc):
            ring.append(_arc(segment, placed, turned))
        else:
            ring.append(Bezier(np.array([placed(point) for point in _control(segment)])))
    _finish(ring, rings)
    return rings


def _control(segment: Any) -> list[Any]:
    if isinstance(segment, svg.CubicBezier):
        return [segment.start, segment.control1, segment.control2, segment.end]
    if isinstance(segment, svg.QuadraticBezier):
        return [segment.start, segment.control, segment.end]
    return [segment.start, segment.end]


def _arc(arc: Any, placed: Any, turned: Any) -> Curve:
    if arc.sweep == 0.0 or arc.rx == 0.0 or arc.ry == 0.0:
        return Bezier(np.array([placed(arc.start), placed(arc.end)]))
    rotation = float(arc.get_rotation())
    if not math.isfinite(rotation + float(arc.sweep) + float(arc.rx) + float(arc.ry)):
        raise FormatError("an arc of the drawing has numbers that are not finite")
    along = np.array([math.cos(rotation), math.sin(rotation)])
    across = np.array([-along[1], along[0]])
    start = float(arc.get_start_t())
    a, b = turned(float(arc.rx) * along), turned(float(arc.ry) * across)
    return EllipseArc(placed(arc.center), a, b, start, float(arc.sweep))


def _finish(ring: Ring, rings: list[Ring]) -> None:
    if not ring:
        return
    first, last = ring[0].at(np.zeros(1)), ring[-1].at(np.ones(1))
    rings.append([*ring, Bezier(np.vstack([last, first]))])
