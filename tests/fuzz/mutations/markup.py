"""Faults of SVG: attributes, elements, styles, nesting, references in a circle."""

from __future__ import annotations

import re
from random import Random
from typing import Final

from tests.fuzz.mutations.text import one_of, put
from tests.fuzz.mutations.values import near, scalar

_ATTRIBUTE: Final = re.compile(r'\s([\w:-]+)="([^"]*)"')
_ELEMENT: Final = re.compile(r"<([\w:]+)(?:\s[^<>]*)?/>|<([\w:]+)(?:\s[^<>]*)?>[^<>]*</\2>")
_START: Final = re.compile(r"<([a-z]\w*)(?=[\s/>])")
_NUMBER: Final = re.compile(r"(?<![\w/#.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")

_NAMES: Final = (
    "d", "points", "transform", "style", "fill", "stroke", "opacity", "width", "height", "x", "y",
    "cx", "r", "rx", "viewBox", "clip-path", "clip-rule", "fill-rule", "class", "id", "font-size",
    "stroke-width", "stroke-dasharray", "stroke-linejoin", "stroke-miterlimit", "display", "mask",
    "transform-origin", "overflow", "systemLanguage", "href", "xlink:href", "visibility",
    "preserveAspectRatio", "patternUnits", "xml:space",
)  # fmt: skip
_VALUES: Final = (
    "none", "inherit", "red", "#12345", "url(#a)", "url(#none)", "#a", "rgb(1,2,3)", "currentColor",
    "evenodd", "1e9px", "5%", "3em", "-1", "0", "translate(1e308)", "scale(0)", "scale(1e-200)",
    "matrix(1 0 0 0 0 0)", "matrix(0 1e155 1e155 0 0 0)", "rotate(1e400)", "skewX(90)", "M0 0",
    "M0 0H9V9z", "M0 0A1e-300 1 0 0 1 9 9z", "M0 0C1e308 0 0 1e308 9 9z", "M1e300 0h9v9z", "0,0 1",
    "fill:none", "fill:url(#a);clip-path:url(#a)", "calc(1px + 2px)", "var(--a)", "0 0 0 0",
    "0 0 1e-300 1", "xMidYMid slice", "hidden", "miter", "1 2 3", "1e999", "important!",
)  # fmt: skip


def spoiled(content: bytes, others: tuple[bytes, ...], random: Random) -> bytes:
    """The content with one to four such faults."""
    text = content.decode("utf-8", "replace")
    for _ in range(random.choice((1, 1, 2, 4))):
        new = random.choice(_WAYS)(text, random)
        text = new if 'xmlns="http' in new else text
    return text.encode("utf-8", "surrogatepass")


def _value(text: str, random: Random) -> str:
    found = one_of(_ATTRIBUTE, text, random)
    return text if found is None else put(text, found, f' {found[1]}="{random.choice(_VALUES)}"')


def _number(text: str, random: Random) -> str:
    found = one_of(_ATTRIBUTE, text, random)
    inner = None if found is None else one_of(_NUMBER, found[2], random)
    if found is None or inner is None:
        return text
    value = put(
        found[2], inner, near(inner[0], random) if random.random() < 0.5 else scalar(random)
    )
    value = value.replace('"', "").replace("<", "")
    return put(text, found, f' {found[1]}="{value}"')


def _attribute(text: str, random: Random) -> str:
    found = one_of(_START, text, random)
    if found is None:
        return text
    return put(text, found, f'{found[0]} {random.choice(_NAMES)}="{random.choice(_VALUES)}"')


def _lose(text: str, random: Random) -> str:
    found = one_of(random.choice((_ATTRIBUTE, _ELEMENT)), text, random)
    return text if found is None else put(text, found, "")


def _double(text: str, random: Random) -> str:
    found = one_of(_ELEMENT, text, random)
    return text if found is None else put(text, found, found[0] * random.choice((2, 3, 200)))


def _rename(text: str, random: Random) -> str:
    tags = "svg g a defs symbol use clipPath mask pattern text image switch rect path style line"
    found = one_of(_START, text, random)
    return text if found is None else put(text, found, f"<{random.choice(tags.split())}")


def _nest(text: str, random: Random) -> str:
    found = one_of(_ELEMENT, text, random)
    if found is None:
        return text
    depth = random.choice((1, 2, 60, 400, 3_000))
    tag = random.choice(('g transform="scale(0.5)"', "g", "svg", 'svg viewBox="0 0 1 1"', "switch"))
    return put(text, found, f"<{tag}>" * depth + found[0] + f"</{tag.split()[0]}>" * depth)


def _circle(text: str, random: Random) -> str:
    end = text.rfind("</svg>")
    put_in = random.choice((
        '<g id="a"><use href="#a"/></g>', '<use id="a" href="#b"/><use id="b" href="#a"/>',
        '<clipPath id="a" clip-path="url(#a)"><rect width="9" height="9"/></clipPath>'
        '<rect width="50" height="50" clip-path="url(#a)"/>',
        '<style>@import "a.css"; * { fill: url(#a) } path > g ~ rect::before { d: none }</style>',
        '<style>rect { transform: scale(0) } svg { display: none }</style>',
        "<!DOCTYPE svg>", "<![CDATA[a]]>", "<?xml-stylesheet href='a.css'?>", "&a;", "&#0;", "<!--",
    ))  # fmt: skip
    return text[:end] + put_in + text[end:]


_WAYS: Final = (
    _value, _value, _number, _number, _number, _attribute, _lose, _double, _rename, _nest, _circle
)  # fmt: skip
