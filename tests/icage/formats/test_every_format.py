"""A law over all formats: a polygon written to a file comes back, wherever it lay."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from icage import load
from tests.icage.formats.dxf.documents import by_hand, line, new, text_of
from tests.icage.formats.mesh.test_mesh import prism, stl_of
from tests.icage.formats.traced_files import off_by, traced_bytes

Written = tuple[str, "str | bytes", dict[str, Any]]


def as_polyline(shape: shapely.Polygon, rng: np.random.Generator) -> Written:
    document, space = new()
    space.add_lwpolyline(shape.exterior.coords[:-1], close=True)
    return "a.dxf", text_of(document), {}


def as_loose_lines(shape: shapely.Polygon, rng: np.random.Generator) -> Written:
    """In any order and direction, with six decimals."""
    points = np.round(shapely.get_coordinates(shape), 6)
    edges = [(*points[k], *points[k + 1]) for k in range(len(points) - 1)]
    turned = [edge if rng.random() < 0.5 else (*edge[2:], *edge[:2]) for edge in edges]
    return "a.dxf", by_hand("".join(line(*turned[k]) for k in rng.permutation(len(edges)))), {}


def as_silhouette(shape: shapely.Polygon, rng: np.random.Generator) -> Written:
    triangles = prism(shape).triangles
    return "a.ply", ply_of(triangles[rng.permutation(len(triangles))]), {}


def as_section(shape: shapely.Polygon, rng: np.random.Generator) -> Written:
    low = np.append(shapely.get_coordinates(shape).min(axis=0), 0.0)
    return "a.stl", stl_of(prism(shape).triangles - low), {"section": 5.0 * rng.random()}


def as_wkt(shape: shapely.Polygon, rng: np.random.Generator) -> Written:
    return "a.wkt", shapely.to_wkt(shape, rounding_precision=-1), {}


def as_geojson(shape: shapely.Polygon, rng: np.random.Generator) -> Written:
    return "a.geojson", shapely.to_geojson(shape), {}


def ply_of(triangles: np.ndarray) -> str:
    rows = "\n".join(f"{x!r} {y!r} {z!r}" for x, y, z in triangles.reshape(-1, 3).tolist())
    faces = "\n".join(f"3 {3 * k} {3 * k + 1} {3 * k + 2}" for k in range(len(triangles)))
    return (
        f"ply\nformat ascii 1.0\nelement vertex {3 * len(triangles)}\nproperty double x\n"
        f"property double y\nproperty double z\nelement face {len(triangles)}\n"
        f"property list uchar int vertex_indices\nend_header\n{rows}\n{faces}\n"
    )


@pytest.mark.parametrize(
    "write", [as_polyline, as_loose_lines, as_silhouette, as_section, as_wkt, as_geojson]
)
@settings(max_examples=6, deadline=None)
@given(seed=st.integers(0, 10_000), n=st.integers(3, 30), far=st.sampled_from([0.0, 10.0, 1e4]))
def test_a_polygon_comes_back_wherever_it_lay(
    tmp_path_factory: Any,
    write: Callable[[shapely.Polygon, np.random.Generator], Written],
    seed: int,
    n: int,
    far: float,
):
    rng = np.random.default_rng(seed)
    u = rng.uniform(0, 7) + 2.0 * np.pi * (np.arange(n) + 0.8 * rng.random(n)) / n
    star = rng.uniform(10, 30, n) * np.array([np.cos(u), np.sin(u)])
    shape = shapely.Polygon(star.T + far * rng.normal(size=2))
    name, content, reading = write(shape, rng)
    tolerance = 1e-5 * max(np.ptp(shapely.get_coordinates(shape), axis=0))
    found = traced_bytes(
        tmp_path_factory.mktemp("law"), name, content, unit="mm", tolerance=tolerance, **reading
    )
    assert off_by(found, shape) <= 1.1e-5
    assert found.outline.area == pytest.approx(shape.area, rel=1e-4)
    assert found.symmetric_difference <= tolerance * shape.length


def test_load_takes_every_format(tmp_path: Path):
    shape = shapely.Polygon([(0, 0), (40, 0), (40, 10), (10, 10), (10, 30), (0, 30)])
    rng = np.random.default_rng(0)
    for write in (as_polyline, as_silhouette, as_section, as_wkt, as_geojson):
        name, content, reading = write(shape, rng)
        path = tmp_path / name
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        case = load(path, unit="mm", **reading)
        assert case.unit == "mm"
        assert case.outline.area == pytest.approx(shape.area)
