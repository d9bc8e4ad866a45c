"""The walk over a drawing in the order in which it is drawn. [SVG2018, Sec. 3, Sec. 5]

Groups, nested drawings, ``use`` and ``switch`` become the state in which a shape is met: style,
map to drawing coordinates, viewport, clips, names.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Final
from xml.etree.ElementTree import Element

from icage.errors import FormatError
from icage.formats.svg.conditions import holds
from icage.formats.svg.document import Clips, Document
from icage.formats.svg.lengths import Measure, share
from icage.formats.svg.matrices import Matrix, product
from icage.formats.svg.shapes import SHAPES
from icage.formats.svg.styles import Style, check_supported
from icage.formats.svg.transforms import about_origin, transform
from icage.formats.svg.view_box import check_finite
from icage.formats.svg.viewports import Sides, rectangle, shift, viewport_of
from icage.formats.svg.xml_tree import local_name, quoted, reference, refused

NOT_READ: Final = ("text", "image", "foreignObject")
"""What is painted and has no outline that can be read."""

NEVER_DRAWN: Final = {
    "", "defs", "symbol", "clipPath", "mask", "marker", "pattern", "linearGradient",
    "radialGradient", "meshgradient", "hatch", "solidcolor", "solidColor", "filter", "style",
    "title", "desc", "metadata", "script", "view", "cursor", "color-profile", "font", "font-face",
    "flowRoot",
}  # fmt: skip
_ANIMATIONS: Final = {
    "animate", "animateTransform", "animateMotion", "animateColor", "set", "discard",
}  # fmt: skip
_VIEWPORTS: Final = ("svg", "symbol")
_CONTAINERS: Final = ("g", "a", *_VIEWPORTS)

_MAX_USE: Final = 50
"""``use`` inside what is used, at most."""

_LABEL: Final = "{http://www.inkscape.org/namespaces/inkscape}label"
_DISPLAYS: Final = {
    "inline", "block", "inline-block", "list-item", "flex", "inline-flex", "grid", "inline-grid",
    "table", "inline-table", "table-cell", "table-row", "run-in", "compact", "marker", "flow-root",
}  # fmt: skip
_NOT_ASKED: Final[Sides] = (None, None)


@dataclass(frozen=True, slots=True)
class State:
    """The state in which an element is met.

    Attributes
    ----------
    style:
        Of its parent; of itself once it is met.
    matrix:
        From its parent's user units to drawing coordinates; from its own once it is met.
    width, height:
        [user] Of the nearest viewport; None if the page has no size.
    clips:
        In drawing coordinates.
    names:
        Ids and labels of what is around it; its own, too, once it is met.
    used:
        The elements that ``use`` is repeating here.
    """

    style: Style
    matrix: Matrix
    width: float | None
    height: float | None
    clips: Clips = ()
    names: tuple[str, ...] = ()
    used: tuple[Element, ...] = ()

    @property
    def measure(self) -> Measure:
        """What relative lengths refer to."""
        return self.style.measure(self.width, self.height)


@dataclass(frozen=True, slots=True)
class Met:
    """A shape, or what cannot be read, and the state in which it is drawn."""

    element: Element
    state: State


_Ahead = tuple[Element, State, Sides]

ClipsOf = Callable[[Element, State], Clips]
"""The clips that an element's ``clip-path`` means, in the element's own state."""


class Walk:
    """Meets everything that is drawn inside an element, in order.

    Parameters
    ----------
    document:
        The drawing.
    clips_of:
        Finds clips. None where only the extent counts: then nothing is clipped, and what has no
        opacity is met, too.
    """

    def __init__(self, document: Document, clips_of: ClipsOf | None) -> None:
        self._document = document
        self._clips_of = clips_of

    def page(self, root: Element, state: State) -> Iterator[Met]:
        """What is met inside the root, which has this state itself.

        Raises
        ------
        FormatError:
            Something that is not understood, or too much.
        """
        return self._all([(child, state, _NOT_ASKED) for child in reversed(root)])

    def inside(self, element: Element, state: State) -> Iterator[Met]:
        """What is met in an element that has this state itself; the element, if it is a shape."""
        if _is_drawn(element):
            return iter([Met(element, state)])
        return self._all(self._expanded(element, state, _NOT_ASKED))

    def _all(self, stack: list[_Ahead]) -> Iterator[Met]:
        while stack:
            element, outer, asked = stack.pop()
            state = self._own_state(element, outer)
            if state is None:
                continue
            if _is_drawn(element):
                yield Met(element, state)
            else:
                stack += self._expanded(element, state, asked)

    def _expanded(self, element: Element, state: State, asked: Sides) -> list[_Ahead]:
        """What is inside a container, the last one first."""
        tag = local_name(element)
        if tag == "use":
            return [self._used(element, state)]
        if tag == "switch":
            return [(child, state, _NOT_ASKED) for child in _chosen(element)]
        if tag not in _CONTAINERS:
            raise FormatError(f"<{tag}> is not supported")
        within = self._within(element, state, asked) if tag in _VIEWPORTS else state
        if within is None:
            return []
        return [(child, within, _NOT_ASKED) for child in reversed(element)]

    def _own_state(self, element: Element, outer: State) -> State | None:
        """The element's own state; None if nothing of it is drawn."""
        tag = local_name(element)
        if tag in _ANIMATIONS:
            raise FormatError(f"<{tag}> animates the drawing, which is not supported")
        if tag == "script":
            self._document.note("scripts in the drawing are not run")
        if tag in NEVER_DRAWN and not (tag == "symbol" and outer.used[-1:] == (element,)):
            return None
        if not holds(element):
            return None
        self._document.draw_one()
        style = self._document.style_of(element, outer.style)
        if style.text("display") == "none":
            return None
        if style.text("display") not in _DISPLAYS:
            raise refused(element, "display", style.text("display"), "is not supported")
        names = (*outer.names, *names_of(element)) if len(element.attrib) else outer.names
        state = replace(outer, style=style, names=names)
        if self._clips_of is not None:
            if share(element, "opacity", style.text("opacity")) <= 0.0:
                return None
            check_supported(element, style)
        if tag not in _CONTAINERS and len(element):
            refuse_animations(element)
        if style.own:
            state = self._moved(element, state)
        elif tag == "use":
            state = replace(
                state, matrix=product(state.matrix, shift(element, style, state.measure))
            )
        return state

    def _moved(self, element: Element, state: State) -> State:
        """With the element's transform and clips."""
        tag, style = local_name(element), state.style
        if tag in _VIEWPORTS:
            for name in ("transform", "clip-path"):
                refuse_given(element, style, name)
            return state
        matrix = product(state.matrix, own_transform(element, style, state.measure))
        if tag == "use":
            matrix = product(matrix, shift(element, style, state.measure))
        check_finite(element, matrix)
        state = replace(state, matrix=matrix)
        if self._clips_of is None or style.text("clip-path") == "none":
            return state
        return replace(state, clips=(*state.clips, *self._clips_of(element, state)))

    def _used(self, element: Element, state: State) -> tuple[Element, State, Sides]:
        """What ``use`` draws."""
        url = reference(element) or ""
        if not url.startswith("#"):
            raise FormatError(f"<use> refers to {quoted(url)}; only this file's own #id is allowed")
        if not self._document.has(url):
            raise FormatError(f"<use> refers to {quoted(url)}, which the file does not have")
        target = self._document.target(element, "href", url)
        if target in state.used:
            raise FormatError(f"<use> refers to itself ({quoted(url)})")
        if len(state.used) >= _MAX_USE:
            raise FormatError(f"<use> is nested more than {_MAX_USE} times")
        asked = tuple(
            None if given.text in ("", "auto") else given.text
            for given in (state.style.given("width"), state.style.given("height"))
        )
        return target, replace(state, used=(*state.used, target)), (asked[0], asked[1])

    def _within(self, element: Element, state: State, asked: Sides) -> State | None:
        """The state inside a nested drawing; None if it has no area."""
        viewport = viewport_of(element, state.style, state.measure, asked)
        if viewport is None:
            return None
        clips = state.clips
        if viewport.cuts and self._clips_of is None:
            raise FormatError(f"the bounding box of a <{local_name(element)}> is not supported")
        if viewport.cuts:
            clips = (*clips, (rectangle(*viewport.sides, product(state.matrix, viewport.place)),))
        matrix = product(state.matrix, viewport.matrix)
        check_finite(element, matrix)
        return replace(
            state, matrix=matrix, width=viewport.width, height=viewport.height, clips=clips
        )


def _is_drawn(element: Element) -> bool:
    return local_name(element) in SHAPES or local_name(element) in NOT_READ


def names_of(element: Element) -> tuple[str, ...]:
    """The id and the label of an element, if it has them."""
    names = (element.get("id"), element.get(_LABEL))
    return tuple(dict.fromkeys(name for name in names if name))


def own_transform(element: Element, style: Style, measure: Measure) -> Matrix:
    """The map of an element's transform, about its origin."""
    given = style.given("transform")
    matrix = transform(element, given.text, given.css, measure)
    if given.text.lower() == "none":
        return matrix
    style.one_of(element, "transform-box", "view-box", "border-box")
    origin = style.given("transform-origin")
    if not origin.text:
        return matrix
    return about_origin(element, matrix, origin.text, origin.css, measure)


def refuse_given(element: Element, style: Style, name: str) -> None:
    """Refuse a property on an element where it is not supported."""
    text = style.given(name).text
    if text.lower() not in ("", "none"):
        raise refused(element, name, text, f"is not supported on <{local_name(element)}>")


def _chosen(switch: Element) -> list[Element]:
    """The first child that may be drawn and whose conditions hold."""
    for child in switch:
        if local_name(child) not in NEVER_DRAWN and holds(child):
            return [child]
    return []


def refuse_animations(element: Element) -> None:
    """Refuse an element that has an animation as a child."""
    for child in element:
        if local_name(child) in _ANIMATIONS:
            raise FormatError(
                f"<{local_name(child)}> animates <{local_name(element)}>, which is not supported"
            )
