"""A drawing's tree with what is looked up in it: ids, styles in place, what may be spent on it."""

from __future__ import annotations

from typing import Final
from xml.etree.ElementTree import Element

from icage.errors import FormatError
from icage.formats.drawings.drawing import Shape
from icage.formats.svg.cascade import Cascade
from icage.formats.svg.path_data import MAX_CURVES
from icage.formats.svg.style_sheets import Declarations
from icage.formats.svg.styles import INITIAL, Style, style_of
from icage.formats.svg.xml_tree import MAX_ELEMENTS, reference, refused

MAX_STEPS: Final = 5 * MAX_ELEMENTS
"""Elements drawn or used to clip or to measure, with every repetition."""

MAX_CLIPS: Final = 20_000
"""Clips of all shapes, those that stand together counted once."""

Clips = tuple[tuple[Shape, ...], ...]
"""Each is a union of areas in drawing coordinates; what is outside of any is not shown."""


class Document:
    """The tree of a drawing, its style sheets applied.

    Raises
    ------
    FormatError:
        Style sheets that are not understood.
    """

    def __init__(self, root: Element) -> None:
        self.root = root
        self.cascade = Cascade(root)
        self.notes: dict[str, None] = {}
        self.paints: dict[Element, bool] = {}
        """Whether a gradient or pattern that is used paints anything."""
        self._ids: dict[str, Element] = {}
        self._parents = {child: parent for parent in root.iter() for child in parent}
        for element in root.iter():
            name = element.get("id")
            if name:
                self._ids.setdefault(name, element)
        self._drawn = 0
        self._steps = 0
        self._curves = 0
        self._clips: Clips = ()
        self._clipped = 0

    def declared(self, element: Element) -> Declarations:
        """What the cascade gives an element."""
        return self.cascade.declared(element)

    def style_of(self, element: Element, parent: Style) -> Style:
        """The style of an element that is drawn inside one with this style."""
        return style_of(element, self.declared(element), parent, element is self.root)

    def style_in_place(self, element: Element) -> Style:
        """The style where the element stands in the file, as for clip paths and gradients."""
        chain = [element]
        while (parent := self._parents.get(chain[-1])) is not None:
            chain.append(parent)
        style = INITIAL
        for one in reversed(chain):
            style = self.style_of(one, style)
        return style

    def target(self, element: Element, name: str, url: str) -> Element:
        """The element that a reference means.

        Raises
        ------
        FormatError:
            It is in another file, or nowhere.
        """
        if not url.startswith("#"):
            raise refused(element, name, url, "is outside: only this file's own #id is allowed")
        found = self._ids.get(url[1:])
        if found is None:
            raise refused(element, name, url, "is an id which the file does not have")
        return found

    def has(self, url: str) -> bool:
        """Whether a reference is to an element of this file."""
        return url.startswith("#") and url[1:] in self._ids

    def template(self, element: Element) -> Element | None:
        """The gradient or pattern from which another one takes what it lacks."""
        url = reference(element)
        return None if url is None else self.target(element, "href", url)

    def note(self, sentence: str) -> None:
        """Something that the user must know."""
        self.notes[sentence] = None

    def draw_one(self) -> None:
        """Count an element that is drawn."""
        self._drawn += 1
        if self._drawn > MAX_ELEMENTS:
            raise FormatError(f"<use> repeats more than {MAX_ELEMENTS} elements")
        self.step()

    def step(self) -> None:
        """Count an element that is looked at."""
        self._steps += 1
        if self._steps > MAX_STEPS:
            raise FormatError(f"clip paths and <use> repeat more than {MAX_STEPS} elements")

    def clip(self, clips: Clips) -> None:
        """Count the clips of a shape, unless the shape before it has the same."""
        if clips is not self._clips:
            self._clips = clips
            self._clipped += len(clips)
        if self._clipped > MAX_CLIPS:
            raise FormatError(f"shapes are clipped more than {MAX_CLIPS} times")

    def add_curves(self, count: int) -> None:
        """Count lines and curves."""
        self._curves += count
        if self._curves > MAX_CURVES:
            raise FormatError(f"the drawing has more than {MAX_CURVES} lines and curves")
