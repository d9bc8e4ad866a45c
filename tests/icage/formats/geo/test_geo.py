"""GeoJSON and WKT that shapely writes, and texts by hand."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from icage import load
from icage.errors import FormatError, InputError
from tests.icage.formats.traced_files import off_by, traced_bytes

PLATE = shapely.box(0, 0, 900, 600).difference(shapely.Point(400, 300).buffer(100))
FINE = 1e-6


def geometry(shape: shapely.Geometry) -> Any:
    return json.loads(shapely.to_geojson(shape))


def feature(shape: shapely.Geometry, **properties: Any) -> dict[str, Any]:
    return {"type": "Feature", "properties": properties or None, "geometry": geometry(shape)}


def collection(*features: Any) -> str:
    return json.dumps({"type": "FeatureCollection", "features": features})


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10_000), n=st.integers(3, 60), angle=st.floats(0, 7))
def test_random_polygons_come_back(tmp_path_factory: Any, seed: int, n: int, angle: float):
    rng = np.random.default_rng(seed)
    u = angle + 2.0 * np.pi * (np.arange(n) + 0.8 * rng.random(n)) / n
    shape = shapely.Polygon(
        1e3 * rng.normal(size=2) + (rng.uniform(1, 3, n) * [np.cos(u), np.sin(u)]).T
    )
    folder = tmp_path_factory.mktemp("geo")
    for name, text in (
        ("a.wkt", shapely.to_wkt(shape, rounding_precision=-1)),
        ("a.geojson", shapely.to_geojson(shape)),
        ("b.geojson", collection(feature(shape))),
        ("b.wkt", shapely.to_wkt(shapely.MultiPolygon([shape]), rounding_precision=-1)),
    ):
        found = traced_bytes(folder, name, text, unit="m", tolerance=None)
        x_low, y_low, x_high, y_high = shape.bounds
        tolerance = FINE * max(x_high - x_low, y_high - y_low)
        found = traced_bytes(folder, name, text, unit="m", tolerance=tolerance)
        assert off_by(found, shape) <= FINE
        assert found.symmetric_difference <= 1e-5 * shape.area


def test_features_are_picked_by_name_and_id(tmp_path: Path):
    small = shapely.box(2_000, 0, 2_040, 30)
    numbered = {**feature(shapely.box(5_000, 0, 5_070, 30)), "id": 7}
    text = collection(feature(PLATE, name="plate"), feature(small, id="K-2"), numbered)
    for pick, shape in (("plate", PLATE), ("K-2", small), ("7", shapely.box(0, 0, 70, 30))):
        found = traced_bytes(tmp_path, "a.geojson", text, unit="mm", pick=f"id={pick}")
        assert off_by(found, shape) <= 1e-9
    with pytest.raises(FormatError, match="3 separate filled parts"):
        traced_bytes(tmp_path, "a.geojson", text, unit="mm")
    with pytest.raises(FormatError, match="'plate', 'K-2', '7'"):
        traced_bytes(tmp_path, "a.geojson", text, unit="mm", pick="id=8")


def test_collections_points_and_nothing_are_passed_through(tmp_path: Path):
    nested = shapely.GeometryCollection([shapely.Point(1, 1), shapely.GeometryCollection([PLATE])])
    nothing = {"type": "Feature", "properties": {}, "geometry": None}
    for name, text in (
        ("a.geojson", collection(nothing, feature(nested))),
        ("a.wkt", nested.wkt),
        ("b.wkt", f"SRID=25832;{PLATE.wkt}\n\nPOINT (3 4);"),
    ):
        found = traced_bytes(tmp_path, name, text, unit="mm")
        assert off_by(found, PLATE) <= 1e-9
        assert "1 point left out: no outline" in found.notes


def test_closed_lines_are_outlines_if_asked_for(tmp_path: Path):
    ring = shapely.LineString(shapely.box(0, 0, 40, 30).exterior)
    for name, text in (("a.wkt", ring.wkt), ("a.geojson", shapely.to_geojson(ring))):
        with pytest.raises(FormatError, match="strokes only: try --strokes outline"):
            traced_bytes(tmp_path, name, text, unit="mm")
        found = traced_bytes(tmp_path, name, text, unit="mm", strokes="outline")
        assert off_by(found, shapely.box(0, 0, 40, 30)) <= 1e-9


def test_lengths_have_no_unit_and_degrees_are_suspected(tmp_path: Path):
    town = shapely.box(8.1, 48.2, 8.3, 48.4)
    with pytest.raises(FormatError, match="--unit U"):
        traced_bytes(tmp_path, "a.wkt", PLATE.wkt)
    for name, text in (("a.geojson", shapely.to_geojson(town)), ("a.wkt", f"SRID=4326;{town.wkt}")):
        found = traced_bytes(tmp_path, name, text, unit="m")
        assert any("longitude" in note for note in found.notes)
    assert traced_bytes(tmp_path, "b.wkt", PLATE.wkt, unit="mm").notes == (
        "a hole inside the outline left out: the fingers stay outside, the outer ring counts",
    )


def test_geojson_named_json_is_told_from_a_case(tmp_path: Path):
    path = tmp_path / "plate.json"
    path.write_text(shapely.to_geojson(PLATE))
    with pytest.raises(InputError, match=r"this is GeoJSON .*\*\.geojson"):
        load(path)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    ("name", "text", "why"),
    [
        ("a.wkt", "POLYGON ((0 0, 9 9, 9 0, 0 9, 0 0))", "polygon 1 is not valid: Self-inter"),
        ("a.wkt", "POLYGON ((0 0, 1 0, 1 1))", "do not form a closed"),
        ("a.wkt", "POLYGON ((0 0, 1 0, nan 1, 0 0))", "not finite"),
        ("a.wkt", "POLYGON ((0 0, 1e308 0, 1e308 1e308, 0 0))", "beyond 1e"),
        ("a.wkt", "POLYGON ((0 0, 9e200 9e200, 9e200 0, 0 9e200, 0 0))", "beyond 1e"),
        (
            "a.geojson",
            '{"type": "Polygon", "coordinates": [[[0, 0], [9e200, 9e200], [9e200, 0], '
            "[0, 9e200], [0, 0]]]}",
            "beyond 1e",
        ),
        ("a.wkt", "POLYGON ((0 0, 1 0, 1 1, 0 0)", "cut off"),
        ("a.wkt", "POLYGON ((0 0, 1 0, 1 1, 0 0)))", "closes a bracket"),
        ("a.wkt", "GEOMETRYCOLLECTION (" * 100_000, "more than 50 deep"),
        ("a.wkt", "CURVEPOLYGON (CIRCULARSTRING (0 0, 4 0, 4 4, 0 4, 0 0))", "CURVEPOLYGON"),
        ("a.wkt", 'PROJCS["x"]', "no WKT"),
        ("a.wkt", "POINT (1 2)", "nothing in the drawing is filled"),
        ("a.wkt", "POLYGON EMPTY", "nothing in the drawing is filled"),
        ("a.geojson", "[" * 100_000, "nested too deeply"),
        ("a.geojson", '{"type": "Polygon"', "not valid JSON"),
        ("a.geojson", '{"type": "Topology"}', 'the type "Topology"'),
        ("a.geojson", '{"type": "Polygon"}', "no key 'coordinates'"),
        ("a.geojson", '{"type": "Polygon", "coordinates": [[[0,0],[1,0],[1,1]]]}', "not closed"),
        ("a.geojson", '{"type": "Polygon", "coordinates": [[[0,0],[1],[1,1],[0,0]]]}', "1 numbers"),
        ("a.geojson", '{"type": "Polygon", "coordinates": [[0,0]]}', "a list is needed"),
        ("a.geojson", '{"type": "Polygon", "coordinates": [[[0,NaN]]]}', "NaN is not"),
        ("a.geojson", '{"type": "Polygon", "coordinates": [[[0,1e999]]]}', "too large"),
        ("a.geojson", '{"type": "Polygon", "coordinates": [[["0",1]]]}', "a number is needed"),
    ],
)
def test_a_text_that_is_not_understood_is_refused(tmp_path: Path, name: str, text: str, why: str):
    with pytest.raises(FormatError, match=why) as caught:
        traced_bytes(tmp_path, name, text, unit="mm")
    assert "\n" not in str(caught.value)
