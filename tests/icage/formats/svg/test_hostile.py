"""Drawings made to exhaust a reader are refused in one line; the work is bounded by counts."""

from __future__ import annotations

from pathlib import Path

import pytest

from icage.errors import InputError
from icage.formats.drawings.read import trace_file
from icage.formats.drawings.reading import Reading
from tests.icage.formats.svg.drawings import drawing

MANY = "<g>" + "<rect/>" * 19_000 + "</g>"
RECT = '<rect width="9" height="8"/>'


def star(corners: int) -> str:
    return "M50 50" + "".join(f"L{k * 7919 % 97} {k * 104729 % 101}" for k in range(corners)) + "z"


def sheet(css: str, body: str = RECT) -> str:
    return f"<style><![CDATA[{css}]]></style>{body}"


CLIP_TREE = '<clipPath id="c0"><rect width="9" height="9"/></clipPath>' + "".join(
    f'<clipPath id="c{k}" clip-path="url(#c{k - 1})">'
    + f'<rect width="{k}" height="40" clip-path="url(#c{k - 1})"/>' * 5
    + "</clipPath>"
    for k in range(1, 15)
)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    ("body", "message"),
    [
        pytest.param("<rect/>" * 1_000_000, "20000 elements", id="a million elements"),
        pytest.param("<g>" * 99_000 + "</g>" * 99_000, "100 nested", id="deep"),
        pytest.param(
            '<g transform="scale(1e5)">' * 97 + RECT + "</g>" * 97, "not finite", id="scaled deep"
        ),
        pytest.param(
            "".join(f'<use id="u{k}" href="#u{k - 1}"/>' for k in range(1, 9000))
            + '<rect id="u0" width="1" height="1"/>',
            "nested more than 50",
            id="chain of use",
        ),
        pytest.param(
            '<clipPath id="c">' + RECT * 9000 + "</clipPath>"
            + '<rect width="60" height="50" clip-path="url(#c)"/>' * 9000,
            "lines and curves",
            id="clips times shapes",
        ),
        pytest.param(
            CLIP_TREE + '<rect width="60" height="50" clip-path="url(#c14)"/>',
            "lines and curves",
            id="tree of clips",
        ),
        pytest.param(
            "".join(f'<clipPath id="c{k}">{RECT}</clipPath>' for k in range(90))
            + "".join(f'<g clip-path="url(#c{k})">' for k in range(90))
            + RECT.replace("/>", ' clip-path="url(#c0)"/>') * 900 + "</g>" * 90,
            "clipped more than 20000",
            id="clips inside one another",
        ),
        pytest.param(
            '<clipPath id="a"><rect width="9" height="9" clip-path="url(#b)"/></clipPath>'
            '<clipPath id="b"><rect width="9" height="9" clip-path="url(#a)"/></clipPath>'
            '<rect width="60" height="50" clip-path="url(#a)"/>',
            "refers to itself",
            id="clips of one another",
        ),
        pytest.param(
            '<clipPath id="c" clipPathUnits="objectBoundingBox">' + RECT + "</clipPath>"
            + '<g clip-path="url(#c)">' * 95 + RECT * 3000 + "</g>" * 95,
            "repeats more than",
            id="boxes of boxes",
        ),
        pytest.param(
            '<linearGradient id="a" href="#b"/><linearGradient id="b" href="#a"/>'
            '<rect width="9" height="9" fill="url(#a)"/>',
            "nothing in the drawing is filled",
            id="gradients of one another",
        ),
        pytest.param(f'<path d="{star(20_000)}"/>', "cross one another", id="star"),
        pytest.param(
            "".join(f'<circle cx="{50 + k / 1e3}" cy="50" r="20"/>' for k in range(19_990)),
            "points",
            id="circles",
        ),
        pytest.param(
            "".join(
                f'<rect x="{k % 100}" y="{k // 200}" width="60" height="60" '
                f'transform="rotate({k})"/>' for k in range(9_990)
            ),
            "cross one another",
            id="crossing squares",
        ),
        pytest.param(f'<path d="M0 0{"l1 1" * 2_000_000}"/>', "lines and curves", id="long path"),
        pytest.param(f'<polygon points="{"1 " * 4_900_000}"/>', "100000 numbers", id="long points"),
        pytest.param(f'<rect width="{"9" * 9_000_000}" height="8"/>', "finite", id="long number"),
        pytest.param(f'<rect fill="{"(" * 9_000_000}"/>', "nothing|understood", id="long nothing"),
        pytest.param(
            f'<rect width="9" height="8" fill="{"(" * 9_000_000}"/>', "fill=", id="long colour"
        ),
        pytest.param(sheet("(" * 299_000), "cannot be read", id="brackets in css"),
        pytest.param(sheet("@media all{" * 20_000), "too deeply", id="deep css"),
        pytest.param(sheet("a{b:{" * 50_000), "too deeply|not supported", id="deep rules"),
        pytest.param(sheet("a{b:c}" * 100_000), "more than 300000 characters", id="long css"),
        pytest.param(
            sheet("*" + ":not(" * 5000 + "a" + ")" * 5000 + "{fill:red}"), "deeply", id="deep not"
        ),
        pytest.param(
            sheet("g " * 12 + "x{fill:red}" + "g " * 12 + "rect{fill:none}",
                  "<g>" * 90 + MANY + "</g>" * 90),
            "look at more than",
            id="descendants",
        ),
        pytest.param(
            sheet("*:nth-last-of-type(2n+1){fill:red}", MANY), "look at more than", id="counting"
        ),
        pytest.param(sheet("*{fill:red}" * 2000, MANY), "look at more than", id="many rules"),
        pytest.param(
            f'<rect style="{"(" * 5_000_000}"/>', "style attributes have more", id="long style"
        ),
        pytest.param('<rect width="1e308" height="1e308"/>', "finite", id="1e308"),
        pytest.param('<rect width="1e-308" height="1e-308"/>', "diameter 0", id="1e-308"),
        pytest.param(
            '<rect width="9" height="8" transform="skewX(90)"/>', "finite or beyond", id="skew"
        ),
    ],
)  # fmt: skip
def test_a_hostile_drawing_is_refused_in_one_line(tmp_path: Path, body: str, message: str):
    path = tmp_path / "hostile.svg"
    page = 'width="100mm" height="100mm" viewBox="0 0 100 100"'
    path.write_text(drawing(body, page), encoding="utf-8")
    with pytest.raises(InputError, match=message) as caught:
        trace_file(path, Reading())
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 400


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"\x1f\x8b\x08" + bytes(5000), "compressed"),
        (drawing(RECT).encode()[:-9], "not an SVG file"),
        (b'<?xml-stylesheet href="a.css"?>' + drawing(RECT).encode(), "external style sheet"),
    ],
)
def test_other_contents(tmp_path: Path, content: bytes, message: str):
    path = tmp_path / "hostile.svg"
    path.write_bytes(content)
    with pytest.raises(InputError, match=message):
        trace_file(path, Reading())
