"""Blocks where INSERTs put them, layers, units, loose ends, files by hand."""

from __future__ import annotations

import contextlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from icage.errors import FormatError
from tests.icage.formats.dxf.documents import box, by_hand, line, new, read, text_of
from tests.icage.formats.dxf.test_entities import SQUARE, STADIUM, disc, oval
from tests.icage.formats.traced_files import off_by

L_SHAPE = shapely.Polygon([(0, 0), (9, 0), (9, 3), (3, 3), (3, 7), (0, 7)])


def block_of_an_l(document: Any, name: str = "PART", layer: str = "0") -> Any:
    block = document.blocks.new(name, base_point=(1, 2))
    points = [(x + 1, y + 2) for x, y in L_SHAPE.exterior.coords[:-1]]
    block.add_lwpolyline(points, close=True, dxfattribs={"layer": layer})
    return block


@settings(max_examples=12, deadline=None)
@given(
    x=st.floats(-1e3, 1e3), y=st.floats(-1e3, 1e3), angle=st.floats(-400, 400),
    sx=st.floats(0.2, 5.0), sy=st.floats(0.2, 5.0), flips=st.tuples(st.booleans(), st.booleans()),
)  # fmt: skip
def test_an_insert_turns_scales_and_mirrors(
    tmp_path_factory: Any, x: float, y: float, angle: float, sx: float, sy: float,
    flips: tuple[bool, bool],
):  # fmt: skip
    sx, sy = (-sx if flips[0] else sx), (-sy if flips[1] else sy)
    document, space = new()
    block_of_an_l(document)
    space.add_blockref("PART", (x, y), dxfattribs={"rotation": angle, "xscale": sx, "yscale": sy})
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    turn = np.array([[c, -s], [s, c]])
    exact = shapely.transform(L_SHAPE, lambda p: (p * [sx, sy]) @ turn.T)
    found = read(tmp_path_factory.mktemp("dxf"), document)
    assert off_by(found, exact) <= 1e-9


def test_a_circle_scaled_unevenly_is_an_ellipse(tmp_path: Path):
    document, space = new()
    document.blocks.new("HOLE").add_circle((0, 0), 1)
    space.add_blockref("HOLE", (7, 7), dxfattribs={"xscale": 6, "yscale": -2, "rotation": 30})
    found = read(tmp_path, document, tolerance=1e-4)
    assert off_by(found, oval(6, 2, np.radians(30))) <= 1e-5


def test_a_block_of_blocks_seen_from_below(tmp_path: Path):
    document, space = new()
    block_of_an_l(document)
    document.blocks.new("OUTER").add_blockref("PART", (2, 3), dxfattribs={"rotation": 90})
    space.add_blockref("OUTER", (5, 5), dxfattribs={"extrusion": (0, 0, -1), "xscale": 2})
    turned = shapely.transform(L_SHAPE, lambda p: np.column_stack([-p[:, 1], p[:, 0]]))
    # From below, x is measured to the left.
    exact = shapely.transform(turned, lambda p: p * [-2, 1])
    assert off_by(read(tmp_path, document), exact) <= 1e-9


def test_an_array_is_every_copy_of_it(tmp_path: Path):
    document, space = new()
    document.blocks.new("TILE").add_lwpolyline([(0, 0), (2, 0), (2, 2), (0, 2)], close=True)
    grid = {"column_count": 4, "row_count": 3, "column_spacing": 2.0, "row_spacing": 2.0}
    space.add_blockref("TILE", (0, 0), dxfattribs={**grid, "rotation": 20})
    turn = np.radians(20)
    r = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    exact = shapely.transform(shapely.box(0, 0, 8, 6), lambda p: p @ r.T)
    assert off_by(read(tmp_path, document), exact) <= 1e-9


def test_layer_zero_of_a_block_is_the_layer_of_its_insert(tmp_path: Path):
    document, space = new()
    document.layers.add("CUT")
    document.layers.add("NOTES")
    block_of_an_l(document)
    space.add_blockref("PART", (0, 0), dxfattribs={"layer": "CUT"})
    space.add_circle((0, 0), 100, dxfattribs={"layer": "NOTES"})
    assert off_by(read(tmp_path, document, layers=("cut",)), L_SHAPE) <= 1e-9
    assert off_by(read(tmp_path, document, pick="id=PART"), L_SHAPE) <= 1e-9
    with pytest.raises(FormatError, match="no layer 'CUTS'; the drawing has .*'CUT', 'NOTES'"):
        read(tmp_path, document, layers=("CUTS",))


@pytest.mark.parametrize("hide", ["freeze", "off"])
def test_hidden_layers_and_entities_are_not_read(tmp_path: Path, hide: str):
    document, space = new()
    layer = document.layers.add("HIDDEN")
    getattr(layer, hide)()
    space.add_lwpolyline([(0, 0), (10, 0), (10, 10), (0, 10)], close=True)
    space.add_circle((0, 0), 100, dxfattribs={"layer": "HIDDEN"})
    space.add_circle((0, 0), 100, dxfattribs={"invisible": 1})
    space.add_circle((0, 0), 100, dxfattribs={"layer": "Defpoints"})
    assert off_by(read(tmp_path, document), SQUARE) <= 1e-9
    with pytest.raises(FormatError, match="the layer 'HIDDEN' is"):
        read(tmp_path, document, layers=("HIDDEN",))


def test_a_frozen_insert_hides_all_and_one_that_is_off_only_its_own(tmp_path: Path):
    document, space = new()
    layer = document.layers.add("PLACED")
    document.layers.add("SHOWN")
    block_of_an_l(document, layer="SHOWN").add_circle((0, 0), 50)
    space.add_blockref("PART", (0, 0), dxfattribs={"layer": "PLACED"})
    layer.off()
    assert off_by(read(tmp_path, document), L_SHAPE) <= 1e-9
    layer.on()
    layer.freeze()
    with pytest.raises(FormatError, match="shows no lines"):
        read(tmp_path, document)


def test_paper_space_is_not_read_and_said(tmp_path: Path):
    document, _ = new()
    document.paperspace().add_circle((0, 0), 5)
    with pytest.raises(FormatError, match=r"model space is empty; .*'Layout1' has 1 entities"):
        read(tmp_path, document)


@pytest.mark.parametrize("binary", [False, True])
@pytest.mark.parametrize("version", ["R12", "R2000", "R2004", "R2007", "R2013", "R2018"])
def test_every_version_is_read(tmp_path: Path, version: str, binary: bool):
    document, space = new(version)
    document.layers.add("Maß")
    points = [(0, 0, 0), (20, 0, 1), (20, 10, 0), (0, 10, 1)]
    space.add_polyline2d(points, format="xyb", close=True, dxfattribs={"layer": "Maß"})
    path = tmp_path / "made.dxf"
    document.saveas(path, fmt="bin" if binary else "asc")
    unit = "mm" if version == "R12" else None
    found = read(tmp_path, path.read_bytes(), tolerance=3e-3, unit=unit, layers=("MAß",))
    assert off_by(found, STADIUM) <= 1.01e-4
    assert found.unit == "mm"


@pytest.mark.parametrize(
    ("insunits", "unit", "width"),
    [(1, "mm", 254.0), (2, "m", 3.048), (4, "mm", 10.0), (5, "cm", 10.0),
     (6, "m", 10.0), (14, "cm", 100.0)],
)  # fmt: skip
def test_the_header_has_a_unit_that_is_doubted(
    tmp_path: Path, insunits: int, unit: str, width: float
):
    document, space = new(units=insunits)
    space.add_lwpolyline([(0, 0), (10, 0), (10, 10), (0, 10)], close=True)
    found = read(tmp_path, document)
    assert found.unit == unit
    assert found.outline.vertices.max() == pytest.approx(width, rel=1e-12)
    assert any("often wrong" in note for note in found.notes)
    taken = read(tmp_path, document, unit="mm")
    assert taken.outline.vertices.max() == pytest.approx(10.0, rel=1e-12)
    assert "not the header's" in taken.size_from
    assert taken.notes == ()


def test_a_file_by_hand_has_no_unit_and_is_read_with_one(tmp_path: Path):
    with pytest.raises(FormatError, match="states no size .*--unit"):
        read(tmp_path, by_hand(box()))
    for text in (by_hand(box()), by_hand(box()).replace("\n", "\r\n")):
        found = read(tmp_path, text, unit="mm")
        assert found.outline.area == pytest.approx(800.0)
    header = "9\n$INSUNITS\n70\n5\n"
    assert read(tmp_path, by_hand(box(), header)).unit == "cm"


def test_loose_edges_are_chained_with_the_gap(tmp_path: Path):
    drawn = (
        line(0, 0, 40, 0) + line(40.05, 0, 40, 20) + line(40, 20, 0, 20.03) + line(0, 20, 0, 0.04)
    )
    found = read(tmp_path, by_hand(drawn), unit="mm", gap=0.1)
    assert off_by(found, shapely.box(0, 0, 40, 20)) <= 2e-3
    with pytest.raises(FormatError, match=r"6 loose ends, the nearest two 0.03 apart, at \(0, 20"):
        read(tmp_path, by_hand(drawn), unit="mm", gap=0.01)


def test_an_open_contour_around_a_closed_one_is_told(tmp_path: Path):
    hole = "0\nCIRCLE\n8\n0\n10\n20\n20\n10\n40\n3\n"
    drawn = line(0, 0, 40, 0) + line(41, 0, 40, 20) + line(40, 20, 0, 20) + line(0, 20, 0, 0)
    found = read(tmp_path, by_hand(drawn + hole), unit="mm")
    assert any("2 loose ends, the nearest two 1 apart" in note for note in found.notes)


def test_contours_inside_the_outline_are_told(tmp_path: Path):
    document, space = new()
    space.add_lwpolyline([(0, 0), (10, 0), (10, 10), (0, 10)], close=True)
    space.add_line((5, -0.0), (5, 10))  # from edge to edge: no contour of its own
    space.add_circle((2.5, 5), 1)
    space.add_circle((7.5, 5), 2)
    space.add_circle((7.5, 5), 1)
    found = read(tmp_path, document)
    assert off_by(found, SQUARE) <= 1e-9
    assert "2 closed contours inside the outline left out: the outer ring counts" in found.notes


def test_a_circle_of_lines_shorter_than_the_gap_stays_a_circle(tmp_path: Path):
    u = np.linspace(0.0, 2.0 * np.pi, 3_001)
    x, y = np.round(20 * np.cos(u), 4), np.round(20 * np.sin(u), 4)
    drawn = "".join(line(x[k], y[k], x[k + 1], y[k + 1]) for k in range(3_000))
    found = read(tmp_path, by_hand(drawn), unit="mm", gap=1.0)
    assert off_by(found, disc(20)) <= 1.1e-3


def test_a_file_with_faults_of_structure_is_repaired_and_said(tmp_path: Path):
    document, space = new()
    space.add_circle((0, 0), 5)
    text = text_of(document)
    broken = text.replace("  0\nENDSEC\n  0\nSECTION\n  2\nOBJECTS", "  0\nSECTION\n  2\nOBJECTS")
    assert broken != text
    found = read(tmp_path, broken)
    assert any("repaired" in note for note in found.notes)
    assert off_by(found, disc(5)) <= 1.1e-3
    # A number that is none is not guessed from the digits in it.
    with pytest.raises(FormatError, match='invalid floating point value "x5"'):
        read(tmp_path, text.replace(" 40\n5.0", " 40\nx5"))


def test_nothing_is_said_on_standard_error(tmp_path: Path, capfd: pytest.CaptureFixture[str]):
    document, space = new()
    space.add_circle((0, 0), 5)
    text = text_of(document).replace("AcDbCircle", "AcDbNothing")
    for content in (text, by_hand(box())):
        with contextlib.suppress(FormatError):
            read(tmp_path, content, unit="mm")
    assert capfd.readouterr() == ("", "")
