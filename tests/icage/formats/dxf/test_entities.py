"""Every kind of entity against the area that it must enclose."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from ezdxf.math import BSpline, Vec3, fit_points_to_cad_cv
from ezdxf.math import rational_bspline_from_arc as circle_as_spline

from icage.errors import FormatError
from tests.icage.formats.dxf.documents import new, read, text_of
from tests.icage.formats.traced_files import off_by

FINE = 1e-5


def disc(radius: float, cx: float = 0.0, cy: float = 0.0, n: int = 6_000) -> shapely.Polygon:
    u = np.linspace(0.0, 2.0 * np.pi, n, endpoint=False)
    return shapely.Polygon(np.column_stack([cx + radius * np.cos(u), cy + radius * np.sin(u)]))


def oval(rx: float, ry: float, turn: float = 0.0) -> shapely.Polygon:
    return shapely.transform(disc(1.0), lambda p: (p * [rx, ry]) @ _rotation(turn).T)


def _rotation(angle: float) -> np.ndarray:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s], [s, c]])


SQUARE = shapely.box(0, 0, 10, 10)
HALF_DISC = shapely.intersection(disc(5.0), shapely.box(-9, 0, 9, 9))
STADIUM = shapely.union_all([shapely.box(0, 0, 20, 10), disc(5, 0, 5), disc(5, 20, 5)])


def circle(space: Any) -> None:
    space.add_circle((3, 4), 5)


def arcs(space: Any) -> None:
    space.add_arc((0, 0), 5, 350, 100)
    space.add_arc((0, 0), 5, 100, 350)


def half(space: Any) -> None:
    space.add_arc((0, 0), 5, 0, 180)
    space.add_line((-5, 0), (5, 0))


def half_in_mirrored_system(space: Any) -> None:
    # An extrusion of -z: x is measured to the left, so the arc runs the other way.
    space.add_arc((0, 0), 5, 0, 180, dxfattribs={"extrusion": (0, 0, -1)})
    space.add_line((-5, 0), (5, 0))


def ellipse(space: Any) -> None:
    space.add_ellipse((1, 2), major_axis=(0, 8), ratio=0.25)


def half_ellipse(space: Any) -> None:
    space.add_ellipse((0, 0), (5, 0), 1.0, 0, math.pi)
    space.add_line((-5, 0), (5, 0))


def half_ellipse_downwards(space: Any) -> None:
    # Seen from below, the minor axis is the other way.
    space.add_ellipse((0, 0), (-5, 0), 1.0, 0, math.pi, dxfattribs={"extrusion": (0, 0, -1)})
    space.add_line((-5, 0), (5, 0))


def bulges(space: Any) -> None:
    points = [(0, 0, 0), (20, 0, 1), (20, 10, 0), (0, 10, 1)]
    space.add_lwpolyline(points, format="xyb", close=True)


def bulges_clockwise(space: Any) -> None:
    points = [(0, 10, 0), (20, 10, -1), (20, 0, 0), (0, 0, -1)]
    space.add_lwpolyline(points, format="xyb", close=True)


def bulges_in_mirrored_system(space: Any) -> None:
    points = [(0, 0, 0), (-20, 0, -1), (-20, 10, 0), (0, 10, -1)]
    space.add_lwpolyline(
        points, format="xyb", close=True, dxfattribs={"extrusion": (0, 0, -1), "elevation": 3}
    )


def old_polyline(space: Any) -> None:
    points = [(0, 0, 0), (20, 0, 1), (20, 10, 0), (0, 10, 1)]
    space.add_polyline2d(points, format="xyb", close=True)


def polyline_in_space(space: Any) -> None:
    space.add_polyline3d([(0, 0, 7), (10, 0, 7), (10, 10, 7), (0, 10, 7)], close=True)


def rational(space: Any) -> None:
    space.add_spline().apply_construction_tool(circle_as_spline((0, 0), 5, 0, 360))


def rational_half(space: Any) -> None:
    space.add_spline().apply_construction_tool(circle_as_spline((0, 0), 5, 0, 180, segments=3))
    space.add_line((-5, 0), (5, 0))


def solid(space: Any) -> None:
    space.add_solid([(0, 0), (10, 0), (0, 10), (10, 10)])


def trace(space: Any) -> None:
    space.add_trace([(0, 0), (10, 0), (0, 10), (10, 10)])


def face(space: Any) -> None:
    space.add_3dface([(0, 0), (10, 0), (10, 10), (0, 10)])


def hatch_of_points(space: Any) -> None:
    hatch = space.add_hatch(color=1)
    hatch.paths.add_polyline_path([(0, 0, 0), (20, 0, 1), (20, 10, 0), (0, 10, 1)], is_closed=True)


def hatch_of_edges(space: Any) -> None:
    edges = space.add_hatch(color=1).paths.add_edge_path()
    edges.add_line((0, 0), (20, 0))
    edges.add_arc((20, 5), 5, -90, 90)
    edges.add_line((20, 10), (0, 10))
    edges.add_ellipse((0, 5), (5, 0), 1.0, 90, 270)


def hatch_clockwise(space: Any) -> None:
    edges = space.add_hatch(color=1).paths.add_edge_path()
    edges.add_arc((0, 0), 5, 0, 180, ccw=False)
    edges.add_line((-5, 0), (5, 0))


@pytest.mark.parametrize(
    ("draw", "exact"),
    [
        (circle, disc(5)),
        (arcs, disc(5)),
        (half, HALF_DISC),
        (half_in_mirrored_system, HALF_DISC),
        (ellipse, oval(2, 8)),
        (half_ellipse, HALF_DISC),
        (half_ellipse_downwards, HALF_DISC),
        (bulges, STADIUM),
        (bulges_clockwise, STADIUM),
        (bulges_in_mirrored_system, STADIUM),
        (old_polyline, STADIUM),
        (polyline_in_space, SQUARE),
        (rational, disc(5)),
        (rational_half, HALF_DISC),
        (solid, SQUARE),
        (trace, SQUARE),
        (face, SQUARE),
        (hatch_of_points, STADIUM),
        (hatch_of_edges, STADIUM),
        (hatch_clockwise, HALF_DISC),
    ],
    ids=lambda value: getattr(value, "__name__", ""),
)
def test_a_kind_of_entity_encloses_its_area(
    tmp_path: Path, draw: Callable[[Any], None], exact: shapely.Polygon
):
    document, space = new()
    draw(space)
    width = max(exact.bounds[2] - exact.bounds[0], exact.bounds[3] - exact.bounds[1])
    found = read(tmp_path, document, tolerance=FINE * width)
    assert off_by(found, exact) <= 1.01 * FINE
    assert found.unit == "mm"
    assert found.size_from == "from the header's mm ($INSUNITS)"


@pytest.mark.parametrize("degree", [2, 3, 4, 5])
@pytest.mark.parametrize("kind", ["clamped", "periodic", "weighted"])
def test_a_spline_is_where_de_boor_puts_it(tmp_path: Path, degree: int, kind: str):
    rng = np.random.default_rng(degree)
    u = np.linspace(0.0, 2.0 * np.pi, 9, endpoint=False)
    corners = (4.0 + rng.random((9, 1))) * np.column_stack([np.cos(u), np.sin(u)])
    document, space = new()
    if kind == "periodic":
        control = np.vstack([corners, corners[:degree]])
        knots = np.arange(len(control) + degree + 1.0)
        spline = space.add_spline()
        spline.dxf.degree = degree
        spline.control_points, spline.knots = [(*point, 0) for point in control], knots
    else:
        control = np.vstack([corners, corners[:1]])
        weights = rng.uniform(0.3, 3.0, len(control)).tolist() if kind == "weighted" else None
        tool = BSpline([Vec3(*point) for point in control], degree + 1, weights=weights)
        spline = space.add_spline().apply_construction_tool(tool)
        knots = np.array(spline.knots)
    tool = BSpline(
        [Vec3(*point) for point in control], degree + 1, list(knots), list(spline.weights) or None
    )
    times = np.linspace(knots[degree], knots[-degree - 1] - 1e-9, 4_000)
    exact = shapely.Polygon([(p.x, p.y) for p in tool.points(times)])
    found = read(tmp_path, document, tolerance=1e-3)
    assert exact.is_valid
    assert off_by(found, exact) <= 2.5e-4


def test_a_spline_through_points_goes_through_them(tmp_path: Path):
    points = np.array([(0, 0), (10, 0), (12, 8), (5, 12), (-2, 6), (0, 0)], dtype=float)
    document, space = new()
    space.add_spline(fit_points=points)
    found = read(tmp_path, document, tolerance=1e-3)
    assert any("fit points" in note for note in found.notes)
    curve = fit_points_to_cad_cv([(*point, 0.0) for point in points])
    low = np.array([point.xyz[:2] for point in curve.approximate(5_000)]).min(axis=0)
    ring = found.outline.polygon.exterior
    assert shapely.distance(ring, shapely.points(points - low)).max() <= 2e-3


def _mesh(space: Any) -> None:
    with space.add_mesh().edit_data() as data:
        data.vertices = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
        data.faces = [(0, 1, 2)]


@pytest.mark.parametrize(
    ("draw", "why"),
    [
        (lambda s: s.add_line((0, 0, 0), (1, 1, 5)), "LINE .* is not parallel to the xy plane"),
        (
            lambda s: s.add_circle((0, 0), 1, dxfattribs={"extrusion": (1, 0, 1)}),
            "CIRCLE .* is not parallel",
        ),
        (_mesh, "MESH .* is not read"),
        (lambda s: s.add_wipeout([(0, 0), (1, 0), (1, 1)]), "WIPEOUT .* is not read"),
        (lambda s: s.add_mline([(0, 0), (1, 1)]), "MLINE .* is not read"),
        (lambda s: s.add_polymesh((3, 3)), "POLYLINE .* is a mesh"),
        (lambda s: s.add_circle((0, 0), -1), "CIRCLE .* has the radius -1"),
        (lambda s: s.add_circle((0, 1e13), 1), "CIRCLE .* beyond 1e"),
    ],
)
def test_what_is_no_plane_curve_is_refused_by_its_name(
    tmp_path: Path, draw: Callable[[Any], Any], why: str
):
    document, space = new()
    space.add_lwpolyline([(0, 0), (10, 0), (10, 10)], close=True)
    draw(space)
    with pytest.raises(FormatError, match=why):
        read(tmp_path, document)


@pytest.mark.parametrize(
    ("kind", "subclasses"),
    [
        ("REGION", "AcDbModelerGeometry"),
        ("3DSOLID", "AcDbModelerGeometry AcDb3dSolid"),
        ("BODY", "AcDbModelerGeometry"),
        ("SURFACE", "AcDbModelerGeometry AcDbSurface"),
        ("PLANESURFACE", "AcDbModelerGeometry AcDbSurface AcDbPlaneSurface"),
        ("HELIX", "AcDbSpline AcDbHelix"),
        ("PDFUNDERLAY", "AcDbUnderlayReference"),
        ("OLE2FRAME", "AcDbOle2Frame"),
        ("SHAPE", "AcDbShape"),
        ("ACAD_PROXY_ENTITY", "AcDbProxyEntity"),
        ("NEVER_HEARD_OF", "AcDbNeverHeardOf"),
    ],
)
def test_a_kind_that_is_not_known_is_refused_by_its_name(
    tmp_path: Path, kind: str, subclasses: str
):
    document, space = new()
    space.add_lwpolyline([(0, 0), (10, 0), (10, 10), (0, 10)], close=True)
    markers = "".join(f"100\n{name}\n" for name in subclasses.split())
    entity = f"0\n{kind}\n5\nFFF1\n100\nAcDbEntity\n8\nsolids\n{markers}"
    start, middle, end = text_of(document).partition("  0\nENDSEC\n  0\nSECTION\n  2\nOBJECTS\n")
    assert middle
    text = start + entity + middle + end
    with pytest.raises(FormatError, match=f"{kind} FFF1 on layer 'solids' is not read"):
        read(tmp_path, text)
    assert off_by(read(tmp_path, text, layers=("0",)), SQUARE) <= 1e-9


def test_annotation_is_left_out_and_named(tmp_path: Path):
    document, space = new()
    space.add_lwpolyline([(0, 0), (10, 0), (10, 10), (0, 10)], close=True)
    space.add_text("part 7").set_placement((200, 300))
    space.add_point((500, 500))
    space.add_linear_dim((0, -20), (0, 0), (10, 0)).render()
    found = read(tmp_path, document)
    assert off_by(found, SQUARE) <= 1e-9
    assert "left out, as no outline: 1 DIMENSION, 1 POINT, 1 TEXT" in found.notes
