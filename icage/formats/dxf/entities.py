"""What each kind of DXF entity draws: chains of curves in the coordinates that hold it.

Arcs and ellipses stay arcs, splines become Bezier pieces; the curves' vectors have three
coordinates here. Objects with their own system (OCS: arcs, polylines, hatches with an extrusion
direction) are turned into the world's. [DXF2012]
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any, Final, TypeAlias

import numpy as np

from icage.arrays import FloatArray
from icage.errors import FormatError
from icage.formats.drawings.curves import Bezier, Curve, EllipseArc
from icage.formats.drawings.drawing import Ring
from icage.formats.drawings.rational import RationalBezier
from icage.formats.dxf.splines import bezier_pieces, fitted

Chains: TypeAlias = "list[Ring]"

NO_OUTLINE: Final = frozenset(
    [
        "TEXT", "MTEXT", "ATTRIB", "ATTDEF", "DIMENSION", "ARC_DIMENSION",
        "LARGE_RADIAL_DIMENSION", "LEADER", "MULTILEADER", "MLEADER", "TOLERANCE", "POINT",
        "XLINE", "RAY", "VIEWPORT", "ACAD_TABLE", "LIGHT", "SUN", "CAMERA", "SEQEND",
    ]
)  # fmt: skip
"""Annotation and construction: left out, and said so."""

_STRAIGHT: Final = 1e-9
"""A bulge below it is an edge: the arc would be off by half of that times its chord."""

_FULL: Final = 2.0 * math.pi

_CURVE_FIT_FRAME: Final = 16
"""Flag of a vertex that is only the frame of a spline-fit polyline."""


def chains_of(entity: Any) -> tuple[Chains, str]:
    """The chains that an entity draws, and a warning or "".

    Raises
    ------
    FormatError:
        Not understood; the message ends a sentence that begins with the entity's name.
    """
    draw = _DRAW.get(entity.dxftype())
    if draw is None:
        raise FormatError("is not read: explode it, or leave its layer out with --layers")
    return draw(entity)


def _line(entity: Any) -> tuple[Chains, str]:
    a, b = _vector(entity.dxf.start), _vector(entity.dxf.end)
    return ([] if (a == b).all() else [(_edge(a, b),)]), ""


def _circle(entity: Any) -> tuple[Chains, str]:
    return [(_turned(entity, _arc(entity, 0.0, _FULL)),)], ""


def _circular_arc(entity: Any) -> tuple[Chains, str]:
    start = math.radians(entity.dxf.start_angle)
    sweep = _sweep(start, math.radians(entity.dxf.end_angle))
    return [(_turned(entity, _arc(entity, start, sweep)),)], ""


def _arc(entity: Any, start: float, sweep: float) -> EllipseArc:
    radius = float(entity.dxf.radius)
    if not radius > 0.0:
        raise FormatError(f"has the radius {radius:g}; above 0 is needed")
    return _ellipse_arc(_vector(entity.dxf.center), [radius, 0.0, 0.0], _UP, 1.0, start, sweep)


def _ellipse(entity: Any) -> tuple[Chains, str]:
    start = float(entity.dxf.start_param)
    up = _vector(entity.dxf.extrusion)
    arc = _ellipse_arc(
        _vector(entity.dxf.center), _vector(entity.dxf.major_axis), up / _length(up),
        float(entity.dxf.ratio), start, _sweep(start, float(entity.dxf.end_param)),
    )  # fmt: skip
    return [(arc,)], ""


def _spline(entity: Any) -> tuple[Chains, str]:
    control = np.array([tuple(point) for point in entity.control_points]).reshape(-1, 3)
    note = ""
    degree, knots = int(entity.dxf.degree), np.array(entity.knots, dtype=float)
    weights = np.array(entity.weights, dtype=float)
    if not len(control):
        points = np.array([tuple(point) for point in entity.fit_points]).reshape(-1, 3)
        if len(points) < 2:
            raise FormatError("has neither control points nor fit points")
        ends = [entity.dxf.get(name) for name in ("start_tangent", "end_tangent")]
        tangents = None if None in ends else np.array([tuple(end) for end in ends])
        knots, control = fitted(points, tangents)
        degree, weights = 3, np.zeros(0)
        note = "a SPLINE has fit points only: the cubic through them that most programs draw"
    return [_pieces(degree, knots, control, weights)], note


def _lwpolyline(entity: Any) -> tuple[Chains, str]:
    rows = np.array([tuple(row) for row in entity.get_points("xyb")]).reshape(-1, 3)
    wide = float(entity.dxf.get("const_width", 0.0)) > 0.0 or bool(
        np.any([row[2:4] for row in entity.lwpoints])
    )
    points = np.column_stack([rows[:, :2], np.full(len(rows), float(entity.dxf.elevation))])
    chain = _bulged(points, rows[:, 2].tolist(), bool(entity.closed))
    return _turned_chain(entity, chain), _WIDE if wide else ""


def _polyline(entity: Any) -> tuple[Chains, str]:
    if entity.is_poly_face_mesh or entity.is_polygon_mesh:
        raise FormatError("is a mesh, which is not read: export STL, or leave its layer out")
    vertices = [v for v in entity.vertices if not v.dxf.flags & _CURVE_FIT_FRAME]
    points = np.array([tuple(v.dxf.location) for v in vertices]).reshape(-1, 3)
    if entity.is_3d_polyline:
        return _some(_bulged(points, [0.0] * len(points), bool(entity.is_closed))), ""
    points[:, 2] = _vector(entity.dxf.get("elevation", (0.0, 0.0, 0.0)))[2]
    bulges = [float(v.dxf.bulge) for v in vertices]
    chain = _bulged(points, bulges, bool(entity.is_closed))
    return _turned_chain(entity, chain), _WIDE if entity.has_width else ""


def _filled_corners(entity: Any) -> tuple[Chains, str]:
    corners = np.array([tuple(point) for point in entity.wcs_vertices()]).reshape(-1, 3)
    return _some(_bulged(corners, [0.0] * len(corners), True)), ""


def _hatch(entity: Any) -> tuple[Chains, str]:
    up = float(_vector(entity.dxf.elevation)[2])
    chains: Chains = []
    for path in entity.paths.paths:
        if hasattr(path, "vertices"):
            rows = np.array([tuple(row) for row in path.vertices]).reshape(-1, 3)
            points = np.column_stack([rows[:, :2], np.full(len(rows), up)])
            chains += _some(_bulged(points, rows[:, 2].tolist(), bool(path.is_closed)))
        else:
            chains += [(curve,) for edge in path.edges for curve in _hatch_edge(edge, up)]
    return [chain for one in chains for chain in _turned_chain(entity, one)], ""


def _hatch_edge(edge: Any, up: float) -> Ring:
    kind = edge.EDGE_TYPE
    if kind == "LineEdge":
        a, b = _vector((*edge.start, up)), _vector((*edge.end, up))
        return () if (a == b).all() else (_edge(a, b),)
    if kind == "SplineEdge":
        control = np.array([(*point, up) for point in edge.control_points]).reshape(-1, 3)
        return _pieces(
            int(edge.degree), np.array(edge.knot_values), control, np.array(edge.weights)
        )
    centre = _vector((*edge.center, up))
    if kind == "ArcEdge":
        start = math.radians(edge.start_angle)
        sweep = _sweep(start, math.radians(edge.end_angle))
        return (_ellipse_arc(centre, [edge.radius, 0.0, 0.0], _UP, 1.0, start, sweep),)
    start = float(edge.start_param)
    whole = abs(edge.end_angle - edge.start_angle) >= 360.0 - 1e-9
    sweep = _FULL if whole else _sweep(start, float(edge.end_param))
    major = [*edge.major_axis, 0.0]
    return (_ellipse_arc(centre, major, _UP, float(edge.ratio), start, sweep),)


_WIDE: Final = "a polyline has a drawn width, which is left out: its middle line counts"

_UP: Final = np.array([0.0, 0.0, 1.0])

_DRAW: Final[dict[str, Callable[[Any], tuple[Chains, str]]]] = {
    "LINE": _line,
    "CIRCLE": _circle,
    "ARC": _circular_arc,
    "ELLIPSE": _ellipse,
    "SPLINE": _spline,
    "LWPOLYLINE": _lwpolyline,
    "POLYLINE": _polyline,
    "SOLID": _filled_corners,
    "TRACE": _filled_corners,
    "3DFACE": _filled_corners,
    "HATCH": _hatch,
}


def moved(curve: Curve, turn: FloatArray, shift: FloatArray) -> Curve:
    """The curve under p -> p @ turn + shift; affine maps take each kind to itself."""
    if isinstance(curve, EllipseArc):
        return EllipseArc(
            curve.centre @ turn + shift, curve.a @ turn, curve.b @ turn, curve.start, curve.sweep
        )
    if isinstance(curve, RationalBezier):
        return RationalBezier(curve.control @ turn + shift, curve.weights)
    assert isinstance(curve, Bezier)
    return Bezier(curve.control @ turn + shift)


def vectors_of(curve: Curve) -> FloatArray:
    """(k, 3) = points that bound the curve: control points, or the box of an ellipse."""
    if isinstance(curve, EllipseArc):
        c, a, b = curve.centre, curve.a, curve.b
        return np.array([c + a + b, c + a - b, c - a + b, c - a - b])
    assert isinstance(curve, Bezier | RationalBezier)
    return curve.control


def _turned(entity: Any, curve: Curve) -> Curve:
    """From the entity's own system into the world's."""
    ocs = entity.ocs()
    if not ocs.transform:
        return curve
    axes = np.array([tuple(ocs.ux), tuple(ocs.uy), tuple(ocs.uz)])
    return moved(curve, axes, np.zeros(3))


def _turned_chain(entity: Any, chain: Ring) -> Chains:
    return _some(tuple(_turned(entity, curve) for curve in chain))


def _some(chain: Ring) -> Chains:
    return [chain] if chain else []


def _bulged(points: FloatArray, bulges: Sequence[float], closed: bool) -> Ring:
    """Edges and arcs through points (k, 3): a bulge is the tangent of a quarter of the sweep."""
    if closed and len(points):
        points = np.vstack([points, points[:1]])
    steps = zip(pairwise(points), bulges, strict=False)
    return tuple(_step(a, b, bulge) for (a, b), bulge in steps if (a != b).any())


def _step(a: FloatArray, b: FloatArray, bulge: float) -> Curve:
    if not math.isfinite(bulge):
        raise FormatError(f"has the bulge {bulge}; a finite number is needed")
    if abs(bulge) <= _STRAIGHT:
        return _edge(a, b)
    chord = b - a
    left = np.array([-chord[1], chord[0], 0.0])
    centre = (a + b) / 2.0 + left * (1.0 - bulge**2) / (4.0 * bulge)
    radius = a - centre
    across = np.array([-radius[1], radius[0], 0.0])
    return EllipseArc(centre, radius, across, 0.0, 4.0 * math.atan(bulge))


def _edge(a: FloatArray, b: FloatArray) -> Bezier:
    return Bezier(np.array([a, b]))


def _pieces(degree: int, knots: FloatArray, control: FloatArray, weights: FloatArray) -> Ring:
    if not len(weights) or (weights == weights[0]).all():
        return tuple(Bezier(piece) for piece in _shown(bezier_pieces(degree, knots, control)))
    if len(weights) != len(control) or not (np.isfinite(weights).all() and weights.min() > 0.0):
        raise FormatError("has weights that are not above 0, one for each control point")
    homogeneous = np.column_stack([control * weights[:, None], weights])
    pieces = _shown(bezier_pieces(degree, knots, homogeneous))
    return tuple(RationalBezier(row[:, :3] / row[:, 3:], row[:, 3]) for row in pieces)


def _shown(pieces: list[FloatArray]) -> list[FloatArray]:
    """Without those that are one point."""
    return [piece for piece in pieces if (piece != piece[0]).any()]


def _ellipse_arc(
    centre: FloatArray, major: Any, up: FloatArray, ratio: float, start: float, sweep: float
) -> EllipseArc:
    a = _vector(major)
    return EllipseArc(centre, a, np.cross(up, a) * ratio, start, sweep)


def _sweep(start: float, end: float) -> float:
    """Counterclockwise from start to end, a whole turn where they are the same direction."""
    sweep = math.fmod(end - start, _FULL)
    if sweep <= 1e-9:
        sweep += _FULL
    return min(sweep, _FULL)


def _vector(value: Any) -> FloatArray:
    return np.array(tuple(value), dtype=float)


def _length(vector: FloatArray) -> float:
    return float(np.linalg.norm(vector)) or 1.0
