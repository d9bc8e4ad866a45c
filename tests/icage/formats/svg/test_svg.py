from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.strategies import SearchStrategy

from icage.errors import FormatError, InputError
from icage.units import Unit
from tests.icage.formats.svg.drawings import drawing, ellipse, hausdorff, placed, read, read_svg

TRIANGLE = '<path d="M0 0 L40 0 L40 10 Z"/>'


def test_y_is_negated_and_the_box_is_where_the_contract_says(tmp_path: Path):
    outline = read(tmp_path, '<path d="M10 10 H50 V30 L10 20 Z"/>', width=80.0)
    assert {tuple(v) for v in outline.vertices.round(9)} == {(0, 40), (80, 40), (80, 0), (0, 20)}


@pytest.mark.parametrize(("width", "tolerance"), [(100.0, 5.0), (100.0, 0.1), (1e-3, 1e-8)])
def test_a_circle_honours_the_tolerance_and_keeps_its_box(
    tmp_path: Path, width: float, tolerance: float
):
    outline = read(tmp_path, '<circle cx="7" cy="-3" r="5"/>', width, tolerance)
    true = placed(ellipse(7, -3, 5, 5), width)
    assert hausdorff(outline, true) <= tolerance
    assert outline.polygon.bounds == pytest.approx((0, 0, width, width), rel=1e-12, abs=1e-12)
    # and the tolerance is used: a bound nobody comes near would be a waste of vertices
    assert hausdorff(outline, true) >= 0.2 * tolerance


@pytest.mark.parametrize(
    ("body", "curve"),
    [
        ('<ellipse cx="1" cy="2" rx="9" ry="3"/>', ellipse(1, 2, 9, 3)),
        ('<polygon points="0,0 9,0 9,5"/>', [[0, 0], [9, 0], [9, 5], [0, 0]]),
        ('<polyline points="0,0 9,0 9,5"/>', [[0, 0], [9, 0], [9, 5], [0, 0]]),
        ('<rect x="1" y="1" width="8" height="3"/>', [[1, 1], [9, 1], [9, 4], [1, 4], [1, 1]]),
        ('<path d="M0 0h9v5"/>', [[0, 0], [9, 0], [9, 5], [0, 0]]),
        (
            '<path d="M0 0A5 5 0 0 1 10 0z"/>',
            np.vstack([ellipse(5, 0, 5, 5, np.pi, 2 * np.pi), [[0, 0]]]),
        ),
        # radii too small are scaled up until the arc reaches [SVG 1.1, F.6.6]
        (
            '<path d="M0 0A1 1 0 0 1 10 0z"/>',
            np.vstack([ellipse(5, 0, 5, 5, np.pi, 2 * np.pi), [[0, 0]]]),
        ),
        (
            '<rect width="20" height="8" rx="3" ry="2"/>',
            np.vstack(
                [
                    ellipse(17, 2, 3, 2, -np.pi / 2, 0),
                    ellipse(17, 6, 3, 2, 0, np.pi / 2),
                    ellipse(3, 6, 3, 2, np.pi / 2, np.pi),
                    ellipse(3, 2, 3, 2, np.pi, 1.5 * np.pi),
                    [[17, 0]],
                ]
            ),
        ),
        # one radius given counts for both [SVG 1.1, 9.2]
        (
            '<rect width="20" height="20" rx="10"/>',
            ellipse(10, 10, 10, 10),
        ),
    ],
)
def test_every_shape_element(tmp_path: Path, body: str, curve: np.ndarray):
    outline = read(tmp_path, body, 100.0, 0.05)
    assert hausdorff(outline, placed(curve, 100.0)) <= 0.05


def test_bezier_curves(tmp_path: Path):
    t = np.linspace(0, 1, 4_001)[:, None]
    cubic = (
        (1 - t) ** 3 * [0, 0]
        + 3 * (1 - t) ** 2 * t * [0, 40]
        + 3 * (1 - t) * t**2 * np.array([60, 40])
        + t**3 * np.array([60, 0])
    )
    outline = read(tmp_path, '<path d="M0 0 C0 40 60 40 60 0 Z"/>', 60.0, 0.06)
    assert hausdorff(outline, placed(np.vstack([cubic, [[0, 0]]]), 60.0)) <= 0.06
    quadratic = 2 * (1 - t) * t * np.array([30, 50]) + t**2 * np.array([60, 0])
    outline = read(tmp_path, '<path d="M0 0 Q30 50 60 0 Z"/>', 60.0, 0.06)
    assert hausdorff(outline, placed(np.vstack([quadratic, [[0, 0]]]), 60.0)) <= 0.06


def test_nested_transforms_even_skewed_circles(tmp_path: Path):
    body = (
        '<g transform="translate(3,4) rotate(30)"><g transform="skewX(40)">'
        '<circle cx="2" cy="1" r="5" transform="scale(2,0.5)"/></g></g>'
    )
    points = ellipse(2, 1, 5, 5) * [2.0, 0.5]
    points[:, 0] += math.tan(math.radians(40)) * points[:, 1]
    c, s = math.cos(math.radians(30)), math.sin(math.radians(30))
    points = points @ np.array([[c, s], [-s, c]]) + [3, 4]
    outline = read(tmp_path, body, 100.0, 0.05)
    assert hausdorff(outline, placed(points, 100.0)) <= 0.05


def _matrix(kind: str, a: float, b: float) -> tuple[str, np.ndarray]:
    """A transform as SVG writes it, and as a 3 x 3 matrix."""
    if kind == "translate":
        return f"translate({a!r},{b!r})", np.array([[1, 0, a], [0, 1, b], [0, 0, 1]])
    if kind == "scale":
        a, b = 0.5 + abs(a) / 10, -0.5 - abs(b) / 10
        return f"scale({a!r} {b!r})", np.diag([a, b, 1.0])
    turn = math.radians(a * 9)
    c, s = math.cos(turn), math.sin(turn)
    there, back = np.eye(3), np.eye(3)
    there[:2, 2], back[:2, 2] = (b, a), (-b, -a)
    rotation = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])
    return f"rotate({a * 9!r} {b!r} {a!r})", there @ rotation @ back


number: SearchStrategy[float] = st.floats(-10, 10).map(lambda x: round(x, 3))
transforms = st.lists(
    st.builds(_matrix, st.sampled_from(["translate", "scale", "rotate"]), number, number),
    min_size=1,
    max_size=6,
)


@given(transforms, st.booleans())
@settings(max_examples=60)
def test_any_nest_of_transforms_is_their_product(tmp_path_factory, nest, in_one: bool):
    body = '<polygon points="0,0 9,0 9,5 3,1"/>'
    if in_one:
        body = f'<g transform="{" ".join(text for text, _ in nest)}">{body}</g>'
    else:
        for text, _ in reversed(nest):
            body = f'<g transform="{text}">{body}</g>'
    total = np.eye(3)
    for _, matrix in nest:
        total = total @ matrix
    corners = np.array([[0, 0, 1], [9, 0, 1], [9, 5, 1], [3, 1, 1], [0, 0, 1]]) @ total.T
    outline = read(tmp_path_factory.mktemp("svg"), body, 100.0, 1e-3)
    assert hausdorff(outline, placed(corners[:, :2], 100.0)) <= 1e-3


def test_a_view_box_changes_nothing_but_the_size(tmp_path: Path):
    plain = read(tmp_path, TRIANGLE)
    boxed = read(tmp_path, TRIANGLE, attributes='width="30mm" height="90mm" viewBox="-5 -5 90 90"')
    assert boxed.vertices == pytest.approx(plain.vertices, abs=1e-9)


@pytest.mark.parametrize(
    ("attributes", "unit", "wide"),
    [
        ('width="30mm" height="90mm" viewBox="0 0 90 270"', "mm", 40 / 3),
        ('width="3cm" viewBox="0 0 90 90" height="3cm"', "cm", 4 / 3),
        ('width="1in" height="1in" viewBox="0 0 80 80"', "m", 0.0127),
        ('width="72pt" height="72pt"', "mm", 40 * 25.4 / 96),
    ],
)
def test_a_size_the_drawing_states(tmp_path: Path, attributes: str, unit: Unit, wide: float):
    path = tmp_path / "sized.svg"
    path.write_text(drawing(TRIANGLE, attributes))
    assert max(read_svg(path, unit=unit).polygon.bounds) == pytest.approx(wide)
    assert max(read_svg(path, 7.0, unit=unit).polygon.bounds) == pytest.approx(7.0)


def test_used_definitions_are_drawn_where_they_are_used(tmp_path: Path):
    body = (
        '<defs><rect id="bar" width="10" height="2"/></defs>'
        '<use href="#bar"/><use href="#bar" x="8" y="1" transform="translate(0 1)"/>'
    )
    outline = read(tmp_path, body, 18.0)
    assert outline.area == pytest.approx(40.0)
    assert outline.polygon.bounds == pytest.approx((0, 0, 18, 4))


@pytest.mark.parametrize(
    "unseen",
    [
        '<rect width="500" height="500" fill="none" stroke="black"/>',
        '<rect width="500" height="500" style="fill:none"/>',
        '<rect width="500" height="500" style="display:none"/>',
        '<g display="none"><rect width="500" height="500"/></g>',
        '<rect width="500" height="500" visibility="hidden"/>',
        '<rect width="500" height="500" fill-opacity="0"/>',
        '<rect width="500" height="500" fill="transparent"/>',
        '<style>.ghost{fill:none}</style><rect class="ghost" width="500" height="500"/>',
        '<defs><rect width="500" height="500"/></defs>',
        '<symbol id="s"><rect width="500" height="500"/></symbol>',
        '<mask id="m"><rect width="500" height="500"/></mask>',
        '<marker id="m"><rect width="500" height="500"/></marker>',
        '<pattern id="p"><rect width="500" height="500"/></pattern>',
        '<clipPath id="c"><rect width="500" height="500"/></clipPath>',
        '<line x2="500" y2="500" stroke="black"/>',
        '<text x="400" y="400">caption</text>',
        '<rect width="0" height="500"/>',
        '<o:rect xmlns:o="urn:other" width="500" height="500"/>',
    ],
)
def test_what_paints_no_fill_is_not_part_of_the_outline(tmp_path: Path, unseen: str):
    outline = read(tmp_path, unseen + TRIANGLE, 40.0)
    assert outline.area == pytest.approx(200.0)


def test_fill_rules(tmp_path: Path):
    path = "M0 0H30V30H0Z M20 10H40V20H20Z"
    assert read(tmp_path, f'<path d="{path}"/>', 40.0).area == pytest.approx(1000)
    # By the even-odd rule, two areas that meet at two corners, around a hole: they are one.
    crossed = read(tmp_path, f'<path fill-rule="evenodd" d="{path}"/>', 40.0)
    assert crossed.area == pytest.approx(1000, rel=1e-4)
    # The inner square opens to the outside only by the even-odd rule.
    notched = "M0 0H30V30H0Z M20 10H30V20H20Z"
    outline = read(tmp_path, f'<path style="fill-rule:evenodd" d="{notched}"/>', 30.0)
    assert outline.area == pytest.approx(800)


def test_the_union_counts_and_holes_do_not(tmp_path: Path):
    outline = read(
        tmp_path,
        '<path d="M0 0h20v10h-20z M5 2v6h10v-6z"/><rect x="15" width="15" height="4"/>',
        30.0,
    )
    assert outline.area == pytest.approx(20 * 10 + 10 * 4)


def test_separate_parts_are_an_error_that_says_so(tmp_path: Path):
    with pytest.raises(FormatError, match=r"2 separate filled parts \(areas 80 %, 20 %\)"):
        read(tmp_path, '<rect width="4" height="10"/><rect x="9" width="1" height="10"/>')


def test_dust_below_the_tolerance_is_no_part(tmp_path: Path):
    body = '<rect width="100" height="50"/><rect x="110" width="0.05" height="0.05"/>'
    assert read(tmp_path, body, 100.0).area == pytest.approx(5000)


def test_inkscape_files_with_a_doctype_are_read(tmp_path: Path):
    path = tmp_path / "inkscape.svg"
    path.write_text(
        '<?xml version="1.0" encoding="UTF-8" standalone="no"?>\n'
        '<!DOCTYPE svg PUBLIC "-//W3C//DTD SVG 20010904//EN" "http://x.invalid/svg10.dtd">\n'
        + drawing(TRIANGLE)
    )
    assert read_svg(path, 40.0).area == pytest.approx(200)


BOMB = (
    '<!DOCTYPE svg [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;">]>'
    '<svg xmlns="http://www.w3.org/2000/svg"><desc>&b;</desc></svg>'
)
REPEATED = "".join(f'<g id="u{k}">' + f'<use href="#u{k - 1}"/>' * 10 + "</g>" for k in range(1, 9))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "is empty"),
        (b"\x89PNG\r\n\x1a\n\x00\x00\x00", "not an SVG file: .*line 1"),
        (bytes(range(256)) * 40, "not an SVG file"),
        (b"<svg", "not an SVG file"),
        (b"<html><body/></html>", "root element is <html>"),
        (b'<x:svg xmlns:x="urn:other"/>', "root element"),
        (BOMB.encode(), "entities are not allowed"),
        (b'<!DOCTYPE svg [<!ENTITY x SYSTEM "file:///etc/hostname">]><svg>&x;</svg>', "entities"),
        (b'<!DOCTYPE svg SYSTEM "http://x.invalid/a.dtd"><svg>&ns;</svg>', "entities"),
        (drawing("").encode(), "nothing in the drawing is filled"),
        (drawing('<path d=""/>').encode(), "nothing in the drawing is filled"),
        (drawing('<path d="M0 0L5 5"/>').encode(), "no area"),
        (drawing('<path d="M0 0L5"/>').encode(), "<path> has a malformed d='M0 0L5'"),
        (drawing('<g transform="rotate(a)"><rect/></g>').encode(), "<g> has a malformed transform"),
        (drawing('<circle r="1e999"/>').encode(), "not finite"),
        (drawing('<rect width="nan" height="3"/>').encode(), "cannot be read|finite|nothing"),
        (drawing('<rect width="1e300" height="1e300"/>').encode(), "finite or beyond"),
        (drawing("<g>" * 200 + "</g>" * 200).encode(), "100 nested"),
        (drawing("<g/>" * 30_000).encode(), "20000 elements"),
        (drawing(f'<g id="u0"><rect width="1" height="1"/></g>{REPEATED}').encode(), "repeats"),
        (drawing('<g id="a"><use href="#a"/></g>').encode(), "refers to itself"),
        (drawing('<use href="other.svg#a"/>').encode(), "only this file's own #id"),
        (drawing('<use href="#a"/>').encode(), "which the file does not have"),
        (drawing('<rect width="1" height="1" clip-path="url(#c)"/>').encode(), "clip-path"),
        (drawing('<g style="mask:url(#c)"><rect width="1" height="1"/></g>').encode(), "mask"),
    ],
)
def test_bad_drawings_say_what_is_wrong(tmp_path: Path, content: bytes, message: str):
    path = tmp_path / "bad.svg"
    path.write_bytes(content)
    with pytest.raises(FormatError, match=message) as caught:
        read_svg(path, 10.0)
    assert "\n" not in str(caught.value)
    assert "bad.svg" in str(caught.value)


def test_files_that_cannot_be_read(tmp_path: Path):
    with pytest.raises(FormatError, match="is a folder"):
        read_svg(tmp_path, 10.0)
    with pytest.raises(FormatError, match="does not exist"):
        read_svg(tmp_path / "none.svg", 10.0)
    huge = tmp_path / "huge.svg"
    with huge.open("wb") as file:
        file.truncate(11_000_000)
    with pytest.raises(FormatError, match="larger than 10 MB"):
        read_svg(huge, 10.0)


@pytest.mark.parametrize("width", [0.0, -1.0, math.nan, math.inf])
def test_a_width_must_be_a_size(tmp_path: Path, width: float):
    with pytest.raises(FormatError, match="width"):
        read(tmp_path, TRIANGLE, width)


@pytest.mark.parametrize("tolerance", [0.0, -1.0, 1e-9, 50.0, math.nan, math.inf])
def test_a_tolerance_has_limits(tmp_path: Path, tolerance: float):
    with pytest.raises(
        FormatError, match=r"tolerance is .*(0\.0001 to 10 is allowed|finite number)"
    ):
        read(tmp_path, TRIANGLE, 100.0, tolerance)


def test_too_many_vertices_name_the_way_out(tmp_path: Path):
    teeth = " ".join(f"L{k} {k % 2}" for k in range(3000))
    with pytest.raises(InputError, match="at most 2000"):
        read(tmp_path, f'<path d="M0 0 {teeth} L3000 900 L0 900 Z"/>', 3000.0, 0.01)


garbage = st.text(st.sampled_from("MmLlHhVvCcSsQqTtAaZz0123456789.,- eE+\n"), max_size=60)


@given(garbage)
@settings(max_examples=200)
def test_any_path_data_is_an_outline_or_an_input_error(tmp_path_factory, data: str):
    folder = tmp_path_factory.mktemp("svg")
    try:
        outline = read(folder, f'<path d="M0 0 {data}"/>', 10.0, 0.1)
    except InputError:
        return
    assert max(outline.polygon.bounds) == pytest.approx(10.0)
