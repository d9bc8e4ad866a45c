# ruff: noqa: SIM905 - words are read better in lines
"""Whatever stands in an attribute or a style sheet: an answer or an input error, nothing else."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from icage.errors import InputError
from icage.formats.drawings.reading import Reading
from icage.formats.svg.lengths import numbers
from icage.formats.svg.path_data import Malformed, subpaths
from icage.formats.svg.reader import read

WORDS = tuple(
    (
        "M L z a C 0 1 -1 .5 1e3 1e999 nan , ; : ( ) { } [ ] # . * > + ~ @ ! ' \\ / % mm em px q "
        "none red inherit url(#a) rgb rgba translate scale matrix rotate deg fill stroke opacity "
        "important media screen and not clip-path rect g polygon path inset calc var --a hover"
    ).split()
)
pieces = st.lists(st.sampled_from([*WORDS, " ", "\t", "é"]), max_size=25).map("".join)
ATTRIBUTES = tuple(
    (
        "d points transform style fill stroke opacity width x rx viewBox clip-path class font-size "
        "stroke-width stroke-dasharray transform-origin display overflow systemLanguage href"
    ).split()
)


def escaped(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")


def refusal(content: str) -> str:
    """Why a drawing is refused; empty if it is read."""
    try:
        read(content.encode(), Reading(strokes="drawn"))
    except InputError as error:
        return str(error)
    return ""


@pytest.mark.filterwarnings("error")
@given(st.sampled_from(ATTRIBUTES), st.sampled_from(["rect", "path", "g", "svg", "use"]), pieces)
@settings(max_examples=300, deadline=None)
def test_any_attribute(name: str, tag: str, text: str):
    known = "".join(f' {k}="9"' for k in ("width", "height") if k != name)
    body = f'<{tag} {name}="{escaped(text)}"{known}><rect width="9" height="9"/></{tag}>'
    content = f'<svg xmlns="http://www.w3.org/2000/svg"><rect id="a"/>{body}</svg>'
    assert "\n" not in refusal(content)


@pytest.mark.filterwarnings("error")
@given(pieces)
@settings(max_examples=300, deadline=None)
def test_any_style_sheet(text: str):
    content = f'<svg xmlns="http://www.w3.org/2000/svg"><style>{escaped(text)}</style><path/></svg>'
    assert "\n" not in refusal(content)


path_text = st.text(st.sampled_from("MmLlHhVvCcSsQqTtAaZz0123456789.,- e+"), max_size=40)


@given(path_text)
@settings(max_examples=300, deadline=None)
def test_white_space_where_the_grammar_allows_it_changes_nothing(text: str):
    try:
        plain = subpaths("M1 2" + text)
    except (Malformed, InputError):
        return
    spaced = "".join(f" {c} " if c.isalpha() and c not in "eE" else c for c in "M1 2" + text)
    again = subpaths(spaced)
    assert [len(one.curves) for one in again] == [len(one.curves) for one in plain]
    assert [one.closed for one in again] == [one.closed for one in plain]


@pytest.mark.parametrize(
    "text",
    ["M", "M1", "M1 2,", "M1 2L", "M1 2z3 4", "M,1 2", "M1,,2", "M1 2 3", "M1 2A1 1 0 00 5",
     "M1 2 x", "1 2", "M1 2C1 2 3 4 5", "M1 2e", "M+-1 2", "M1 2H", "MM1 2", "M1 2#"],
)  # fmt: skip
def test_path_data_that_break_the_grammar(text: str):
    with pytest.raises(Malformed):
        subpaths(text)


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("", []),
        (" 1 ,2\n-3.5.5e1+4", [1, 2, -3.5, 5, 4]),
        ("1,,2", None),
        (",1", None),
        ("1 2,", None),
        ("1e", None),
        ("0x10", None),
    ],
)
def test_lists_of_numbers(text: str, found: list[float] | None):
    assert numbers(text) == found
