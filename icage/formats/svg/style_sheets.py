"""The style rules of a drawing: its ``<style>`` elements and ``style`` attributes, as declarations.

tinycss2 splits the text; which media apply and what is refused is decided here. [CSS2024]
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final, NamedTuple
from xml.etree.ElementTree import Element

import tinycss2

from icage.errors import FormatError
from icage.formats.svg.properties import KNOWN
from icage.formats.svg.xml_tree import local_name, quoted

MAX_STYLE: Final = 300_000
"""Characters of all style sheets without their fonts, and of all unusual ``style`` attributes."""

_LONG: Final = 20_000
"""Characters from which on a ``style`` attribute is unusual."""

_FONT: Final = re.compile(r"@font-face\s*\{[^{}*]*\}", re.IGNORECASE)

_PLAIN: Final = re.compile(
    r"""(?:[^"'\\{}\[\]@/!()]++|\([^"'\\{}\[\]@!();]*+\)|!\s*+important\b)*+"""
)
"""Declarations that may be split at semicolons and colons: no quotes, escapes or comments."""

_HARMLESS: Final = {"charset", "font-face", "page", "keyframes", "-webkit-keyframes", "viewport",
                    "counter-style", "font-feature-values", "-moz-keyframes"}  # fmt: skip
_MEDIA: Final = {"all": True, "screen": True, "print": False, "speech": False}

_COLOURS: Final = re.compile(
    r"(?:(?:only\s+)?screen\s+and\s*)?\(\s*prefers-color-scheme\s*:\s*(light|dark)\s*\)"
)
"""The page is light, as a browser shows it unless told otherwise."""


class Declared(NamedTuple):
    """What a property was given: the text, whether as CSS and not as an attribute, important."""

    text: str
    css: bool = True
    important: bool = False


Declarations = dict[str, Declared]


@dataclass(frozen=True, slots=True)
class Rule:
    """A style rule: tokens of its selectors, the name spaces they may use, what it declares."""

    selectors: Sequence[Any]
    spaces: dict[str | None, str]
    declarations: Declarations


class StyleReader:
    """Reads style text, as much of it as is allowed, and each ``style`` attribute once."""

    def __init__(self) -> None:
        self._left = MAX_STYLE
        self._known: dict[str, Declarations] = {}

    def rules(self, root: Element) -> list[Rule]:
        """The rules of all style elements, in their order.

        Raises
        ------
        FormatError:
            Imports, conditions or rules that are not understood; too much text.
        """
        sheets = [element for element in root.iter() if local_name(element) == "style"]
        rules: list[Rule] = []
        for sheet in sheets:
            kind = sheet.get("type", "text/css").strip().lower()
            if kind not in ("", "text/css"):
                raise FormatError(f"<style> has type={quoted(kind)}, which is not understood")
            if not _applies(sheet.get("media", "all")):
                continue
            text = _FONT.sub("", "".join(sheet.itertext()))
            if len(text) > self._left:
                raise FormatError(f"the style sheets have more than {MAX_STYLE} characters")
            self._left -= len(text)
            spaces: dict[str | None, str] = {}
            parsed = tinycss2.parse_stylesheet(text, skip_comments=True, skip_whitespace=True)
            self._collect(parsed, spaces, rules)
        self._left = MAX_STYLE
        return rules

    def _collect(
        self, nodes: Sequence[Any], spaces: dict[str | None, str], rules: list[Rule]
    ) -> None:
        for node in nodes:
            if node.type == "qualified-rule":
                declared = _declarations(node.content, nested=True)
                if declared:
                    rules.append(Rule(node.prelude, dict(spaces), declared))
            elif node.type == "at-rule":
                self._at_rule(node, spaces, rules)
            elif node.type == "error":
                raise FormatError(f"a style sheet cannot be read: {node.message} (<style>)")

    def _at_rule(self, node: Any, spaces: dict[str | None, str], rules: list[Rule]) -> None:
        name = node.lower_at_keyword
        prelude = tinycss2.serialize(node.prelude).strip()
        if name == "namespace":
            values = [
                token for token in node.prelude if token.type not in ("whitespace", "comment")
            ]
            prefix = values[0].value if values[0].type == "ident" else None
            spaces[prefix] = str(values[-1].value)
        elif name == "media":
            if node.content is not None and _applies(prelude):
                inner = tinycss2.parse_blocks_contents(
                    node.content, skip_comments=True, skip_whitespace=True
                )
                self._collect(inner, spaces, rules)
        elif name not in _HARMLESS:
            raise FormatError(f"@{name} {prelude:.40} in a style sheet is not supported")

    def attribute(self, text: str) -> Declarations:
        """What a ``style`` attribute declares."""
        known = self._known.get(text)
        if known is None:
            if len(text) <= _LONG and _PLAIN.fullmatch(text):
                known = _plain(text)
            else:
                self._left -= len(text)
                if self._left < 0:
                    raise FormatError(f"style attributes have more than {MAX_STYLE} characters")
                known = _declarations(text, nested=False)
            self._known[text] = known
        return known


def _plain(text: str) -> Declarations:
    declared: Declarations = {}
    for part in text.split(";"):
        name, colon, value = part.partition(":")
        name = name.strip().lower()
        if colon and name in KNOWN:
            value, mark, _ = value.partition("!")
            _declare(declared, name, value.strip(), bool(mark))
    return declared


def _declarations(content: Any, nested: bool) -> Declarations:
    declared: Declarations = {}
    for node in tinycss2.parse_blocks_contents(content, skip_comments=True, skip_whitespace=True):
        if node.type == "declaration":
            value = tinycss2.serialize(node.value).strip()
            _declare(declared, node.lower_name, value, bool(node.important))
        elif node.type in ("qualified-rule", "at-rule") and nested:
            raise FormatError("a style rule inside a style rule is not supported")
    return declared


def _declare(declared: Declarations, name: str, value: str, important: bool) -> None:
    """The later one counts, unless the earlier one is important."""
    if not value:
        return
    for long in _longhands(name):
        before = declared.get(long)
        if before is None or important or not before.important:
            given = _font_size(value) if name == "font" else value
            declared[long] = Declared(given, True, important)


def _longhands(name: str) -> tuple[str, ...]:
    if name == "marker":
        return ("marker-start", "marker-mid", "marker-end")
    if name == "font":
        return ("font-size",)
    return (name,) if name in KNOWN else ()


def _font_size(font: str) -> str:
    """The size in the shorthand ``font``: what stands before the family, without a line height."""
    for word in font.replace("/", " ").split():
        if word[0].isdigit() or word[0] == ".":
            if not word.isdigit():
                return word
        elif word in ("inherit", "initial", "unset"):
            return word
    return font


def _applies(media: str) -> bool:
    """Whether a list of media queries holds on a screen."""
    text = media.strip().lower()
    if not text:
        return True
    found: list[bool] = []
    for query in text.split(","):
        colours = _COLOURS.fullmatch(query.strip())
        if colours:
            found.append(colours[1] == "light")
            continue
        words = query.split()
        negated = bool(words) and words[0] == "not"
        if words and words[0] in ("not", "only"):
            del words[0]
        if len(words) == 1 and words[0] in _MEDIA:
            found.append(_MEDIA[words[0]] != negated)
        elif _MEDIA.get(words[0] if words else "") is False and not negated:
            found.append(False)  # whatever else it asks for, it is no screen
        else:
            raise FormatError(f"the media query {quoted(query.strip())} is not understood")
    return any(found)
