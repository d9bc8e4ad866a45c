"""Clip paths as areas in drawing coordinates. [CSSMasking2021, Sec. 5]"""

from __future__ import annotations

from dataclasses import replace
from typing import Final
from xml.etree.ElementTree import Element

import numpy as np

from icage.formats.drawings.curves import Curve
from icage.formats.drawings.drawing import Shape
from icage.formats.svg.conditions import holds
from icage.formats.svg.document import Clips, Document
from icage.formats.svg.matrices import IDENTITY, Matrix, placed, product
from icage.formats.svg.paint import URL
from icage.formats.svg.rings import rings
from icage.formats.svg.shapes import SHAPES, subpaths_of
from icage.formats.svg.structure import NOT_READ, State, Walk, own_transform, refuse_given
from icage.formats.svg.viewports import shift
from icage.formats.svg.xml_tree import local_name, reference, refused

_MAX_NESTED: Final = 20
"""Clip paths that clip clip paths, at most."""

_SILENT: Final = ("", "title", "desc", "metadata")


class ClipPaths:
    """Finds what the ``clip-path`` of an element leaves of it."""

    def __init__(self, document: Document) -> None:
        self._document = document
        self._open: list[Element] = []

    def __call__(self, element: Element, state: State) -> Clips:
        """The clips of an element in its own state.

        Raises
        ------
        FormatError:
            Missing, outside, of itself, or with something in it that is not understood.
        """
        text = state.style.given("clip-path").text
        match = URL.fullmatch(text)
        if match is None or match[3]:
            raise refused(element, "clip-path", text, "is not supported")
        path = self._document.target(element, "clip-path", match[2].strip())
        if local_name(path) != "clipPath":
            raise refused(element, "clip-path", text, f"is a <{local_name(path)}>")
        if path in self._open:
            raise refused(element, "clip-path", text, "refers to itself")
        if len(self._open) >= _MAX_NESTED:
            raise refused(element, "clip-path", text, f"is nested more than {_MAX_NESTED} times")
        self._open.append(path)
        clips = self._clips(element, path, state)
        self._open.pop()
        return clips

    def _clips(self, element: Element, path: Element, state: State) -> Clips:
        self._document.step()
        style = self._document.style_in_place(path)
        within = replace(state, style=style, clips=())
        own = self(path, within) if style.text("clip-path") != "none" else ()
        matrix = product(state.matrix, own_transform(path, style, within.measure))
        units = path.get("clipPathUnits", "").strip() or "userSpaceOnUse"
        if units == "objectBoundingBox":
            # Programs do not agree about which of the two comes first.
            refuse_given(path, style, "transform")
            matrix = product(matrix, self._box(element, state))
        elif units != "userSpaceOnUse":
            raise refused(path, "clipPathUnits", units)
        within = replace(within, matrix=matrix)
        areas: list[Shape] = []
        for child in path:
            areas += self._area(path, child, within, None)
        return (tuple(areas), *own)

    def _area(
        self, path: Element, child: Element, outer: State, user: Element | None
    ) -> list[Shape]:
        """What a child of a clip path adds to it; ``user``: the ``use`` that draws it."""
        tag = local_name(child)
        if tag in _SILENT or not holds(child):
            return []
        self._document.step()
        style = self._document.style_of(child, outer.style)
        if style.text("display") == "none":
            return []
        allowed = (*SHAPES, "use") if user is None else SHAPES
        if tag not in allowed:
            what = "with <use> in it" if tag == "use" else f"with <{tag}> in it"
            raise refused(path, "id", path.get("id", ""), f"is a clip path {what}: not supported")
        state = replace(outer, style=style)
        matrix = product(outer.matrix, own_transform(child, style, state.measure))
        if tag == "use":
            matrix = product(matrix, shift(child, style, state.measure))
        state = replace(state, matrix=matrix)
        if style.text("clip-path") != "none":
            state = replace(state, clips=(*outer.clips, *self(child, state)))
        if tag == "use":
            target = self._document.target(child, "href", reference(child) or "")
            return self._area(path, target, state, child)
        if style.one_of(child, "visibility", "visible", "hidden", "collapse") != "visible":
            return []
        rule = style.one_of(child, "clip-rule", "nonzero", "evenodd")
        found = rings(subpaths_of(child, style, state.measure), matrix)
        self._document.add_curves(sum(len(ring) for ring in found))
        if not found or tag == "line":
            return []
        return [Shape(found, (), "evenodd" if rule == "evenodd" else "nonzero", state.clips)]

    def _box(self, element: Element, state: State) -> Matrix:
        """From (0, 0, 1, 1) to the bounding box of an element, in its user units.

        Raises
        ------
        FormatError:
            The element has no box that could be measured.
        """
        corners = [np.zeros((0, 2))]
        local = replace(state, matrix=IDENTITY, clips=())
        for met in Walk(self._document, None).inside(element, local):
            if local_name(met.element) in NOT_READ:
                raise refused(
                    element, "clip-path", state.style.given("clip-path").text,
                    f"is of the bounding box of a <{local_name(met.element)}>: not supported",
                )  # fmt: skip
            for part in subpaths_of(met.element, met.state.style, met.state.measure):
                corners += [_corners(placed(curve, met.state.matrix)) for curve in part.curves]
        points = np.vstack(corners)
        if len(points) == 0:
            return (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        low, high = points.min(axis=0), points.max(axis=0)
        w, h = (high - low).tolist()
        return (w, 0.0, 0.0, h, float(low[0]), float(low[1]))


def _corners(curve: Curve) -> np.ndarray:
    return curve.at(np.array([0.0, *curve.turns(), 1.0]))
