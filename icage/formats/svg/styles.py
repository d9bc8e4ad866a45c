"""The values that properties have on an element: declared there, inherited, or initial."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Final
from xml.etree.ElementTree import Element

from icage.errors import FormatError
from icage.formats.svg.lengths import NUMBER, Measure, length
from icage.formats.svg.properties import INHERITED, OWN, REFUSED
from icage.formats.svg.style_sheets import Declarations, Declared
from icage.formats.svg.xml_tree import refused

_RELATIVE: Final = re.compile(rf"{NUMBER}r?em", re.IGNORECASE)


def _nothing() -> Mapping[str, Declared]:
    return {}


@dataclass(frozen=True, slots=True)
class Style:
    """Values of an element.

    Attributes
    ----------
    inherited:
        Of the properties whose values children take over.
    own:
        Of the others, as far as they are declared.
    font_size, root_font_size:
        [px] For ``em`` and ``rem``; a text that is not understood as it stands.
    """

    inherited: Mapping[str, Declared]
    own: Mapping[str, Declared] = field(default_factory=_nothing)
    font_size: float | str = 16.0
    root_font_size: float | str = 16.0

    def text(self, name: str) -> str:
        """The value, in small letters."""
        return self.given(name).text.lower()

    def given(self, name: str) -> Declared:
        """The value as it was written."""
        found = self.inherited.get(name) or self.own.get(name)
        return found or Declared(OWN.get(name, ""), False)

    def measure(self, width: float | None, height: float | None) -> Measure:
        """What lengths refer to in a viewport of this size."""
        return Measure(width, height, self.font_size, self.root_font_size)

    def one_of(self, element: Element, name: str, *allowed: str) -> str:
        """The value of a property that has but a few.

        Raises
        ------
        FormatError:
            Another value.
        """
        value = self.text(name)
        if value not in allowed:
            raise refused(element, name, value)
        return value


INITIAL: Final = Style({name: Declared(text, False) for name, text in INHERITED.items()})


def style_of(element: Element, declared: Declarations, parent: Style, is_root: bool) -> Style:
    """The style of an element whose parent has this one.

    Raises
    ------
    FormatError:
        A relative ``stroke-width`` that cannot be understood.
    """
    if not declared:
        return replace(parent, own={}) if parent.own else parent
    inherited = dict(parent.inherited)
    own: dict[str, Declared] = {}
    for name, given in declared.items():
        word = given.text.lower()
        if name in INHERITED:
            if word in ("inherit", "unset", "revert", "revert-layer"):
                continue
            inherited[name] = Declared(INHERITED[name], False) if word == "initial" else given
        elif word == "inherit":
            own[name] = parent.given(name)
        elif word not in ("initial", "unset", "revert", "revert-layer"):
            own[name] = given
    size, root_size = parent.font_size, parent.root_font_size
    if "font-size" in declared:
        size = _font_size(element, inherited["font-size"], parent, is_root)
        inherited["font-size"] = Declared("inherit", False)
        root_size = size if is_root else root_size
    style = Style(inherited, own, size, root_size)
    wide = inherited["stroke-width"]
    if _RELATIVE.fullmatch(wide.text) and "stroke-width" in declared:
        number = length(element, "stroke-width", wide.text, "both", style.measure(None, None))
        inherited["stroke-width"] = Declared(repr(number), False)
    return style


def check_supported(element: Element, style: Style) -> None:
    """Refuse the properties that would change what an element draws, and are not supported.

    Raises
    ------
    FormatError:
        Names the property.
    """
    for name, given in style.own.items():
        if name in REFUSED and given.text.lower() != REFUSED[name]:
            raise refused(element, name, given.text, "is not supported")


def _font_size(element: Element, given: Declared, parent: Style, is_root: bool) -> float | str:
    """[px], or the text where it is not understood: an error only where something needs it."""
    word = given.text.lower()
    if word == "inherit":
        return parent.font_size
    if word == "medium":
        return 16.0
    measure = Measure(None, None, parent.font_size, 16.0 if is_root else parent.root_font_size)
    if word.endswith("%"):
        word = word[:-1] + "e-2em"
    try:
        return length(element, "font-size", word, "both", measure)
    except FormatError:
        return given.text
