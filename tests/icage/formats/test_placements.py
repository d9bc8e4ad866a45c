from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from icage.errors import PlacementError
from icage.formats.placements_csv import parse_placements, read_placements, read_placements_stream

HEADER = "x,y,theta,sigma\n"
finite = st.floats(-1e100, 1e100)


@given(st.lists(st.tuples(finite, finite, finite, st.floats(0, 1e100)), max_size=20))
def test_every_double_comes_back_exactly(rows: list[tuple[float, float, float, float]]):
    text = HEADER + "".join(",".join(map(repr, row)) + "\n" for row in rows)
    assert parse_placements(text, "t").tolist() == [list(row) for row in rows]


def test_spaces_quotes_blank_lines_and_line_ends_do_no_harm():
    text = '\n x , y, theta,sigma\r\n1, 2 ,0.5,"3"\r\n\r\n +1.,-.2,1e-3,0\r\n'
    assert parse_placements(text, "t").tolist() == [[1, 2, 0.5, 3], [1, -0.2, 1e-3, 0]]


def test_no_rows_are_no_placements():
    assert parse_placements(HEADER, "t").shape == (0, 4)


def test_a_byte_order_mark_is_no_harm(tmp_path: Path):
    file = tmp_path / "t.csv"
    file.write_text("\ufeff" + HEADER + "1,2,3,4\n", encoding="utf-8")
    assert read_placements(file).tolist() == [[1, 2, 3, 4]]


def test_standard_input_is_read_alike():
    stream = io.BytesIO(b"x,y,theta,sigma\n1,2,3,4\n")
    assert np.array_equal(read_placements_stream(stream), [[1, 2, 3, 4]])


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ("1,2,3,-1", r"row 1 \(line 2\): sigma is -1; 0 or more"),
        ("1,2,3,4\n\n1,2,3,-1e-9", r"row 2 \(line 4\): sigma is -1e-09"),
        ("1,2,3,nan", "row 1 .*: sigma is 'nan'"),
        ("1,2,inf,4", "row 1 .*: theta is 'inf'"),
        ("1,-Infinity,3,4", "row 1 .*: y is '-Infinity'"),
        ("1e400,2,3,4", "row 1 .*: x is '1e400'; a finite number"),
        ("1e101,2,3,4", "up to 1e.100"),
        ("1,2,3", "row 1 .* has 3 columns; 4 are needed"),
        ("1,2,3,4,5", "row 1 .* has 5 columns"),
        ("1,2,,4", "row 1 .*: theta is ''"),
        ("1,2,0x10,4", "theta is '0x10'"),
        ("1_0,2,3,4", "x is '1_0'"),
        ("one,2,3,4", "x is 'one'"),
        ('"1,2,3,4', "columns"),
        ("\u0661,2,3,4", "x is "),
    ],
)
def test_bad_rows_are_named(rows: str, message: str):
    with pytest.raises(PlacementError, match=message) as caught:
        parse_placements(HEADER + rows + "\n", "t.csv")
    assert str(caught.value).startswith("t.csv, row ")
    assert str(caught.value).isprintable()


@pytest.mark.parametrize("header", ["x,y,theta", "x,y,sigma,theta", "1,2,3,4", "x;y;theta;sigma"])
def test_the_header_is_needed(header: str):
    with pytest.raises(PlacementError, match="x,y,theta,sigma is needed"):
        parse_placements(header + "\n1,2,3,4\n", "t")


@pytest.mark.parametrize("content", [b"", b"\n\n", b"\x00\x01", b"\xff\xfe\xfa", bytes(range(256))])
def test_what_is_no_table_is_an_error(tmp_path: Path, content: bytes):
    file = tmp_path / "t.csv"
    file.write_bytes(content)
    with pytest.raises(PlacementError, match="t.csv"):
        read_placements(file)


def test_folders_and_missing_files(tmp_path: Path):
    with pytest.raises(PlacementError, match="is a folder"):
        read_placements(tmp_path)
    with pytest.raises(PlacementError, match="does not exist"):
        read_placements(tmp_path / "t.csv")


def test_too_many_rows_are_refused(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("icage.formats.placements_csv.MAX_ROWS", 3)
    parse_placements(HEADER + "0,0,0,1\n" * 3, "t")
    with pytest.raises(PlacementError, match="more than 3 rows"):
        parse_placements(HEADER + "0,0,0,1\n" * 4, "t")
