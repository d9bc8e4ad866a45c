"""A picture of a case or a cage as SVG text, without any plotting library. Our own.

Notebooks show it for ``case`` and ``cage``; reports and pages take the same function.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from html import escape
from typing import Final

import numpy as np
import shapely

from icage.arrays import FloatArray
from icage.cage import Cage
from icage.case import Case
from icage.outline import Outline

WIDTH: Final = 480.0
"""[px] Longer side of the drawing."""

_MARGIN: Final = 14.0
_CAPTION: Final = 18.0
_COARSE: Final = 0.4
"""[px] Regions are drawn with so much less detail."""

OBJECT, EDGE, WHOLE, SAFE, HAND, OUT = (
    "#c9ced3",
    "#4d565e",
    "#f2c879",
    "#7fb8d8",
    "#1c4e80",
    "#b5442e",
)
"""Colours, readable with any kind of colour blindness: object, its edge, region of the cage,
guaranteed region, hand, escape."""


def case_picture(case: Case, width: float = WIDTH) -> str:
    """The object, and the fingers of its target grasp if it has one."""
    sheet = _Sheet(
        _bounds([case.outline.vertices, *_discs_box(case.target, case.finger_radius)]), width
    )
    body = list(_object(sheet, case.outline.polygon))
    if case.target is not None:
        body += _hand(sheet, case.target, case.finger_radius, HAND, solid=True)
    return sheet.svg(body, [repr(case)[1:-1]])


def cage_picture(cage: Cage, width: float = WIDTH) -> str:
    """The object, where each finger may be (guaranteed and whole cage), the grasp, the escape."""
    whole, safe = _regions(cage)
    corners = [shapely.get_coordinates(region) for region in (*whole, *safe)]
    hands = [cage.contacts, *(p.contacts for p in cage.punctures if p.kind == "escape")]
    boxes = [box for hand in hands for box in _discs_box(hand, cage.finger_radius)]
    sheet = _Sheet(_bounds([cage.outline.vertices, *corners, *boxes]), width)
    body = [_path(sheet, region, WHOLE, "none", 0.75) for region in whole]
    body += [_path(sheet, region, SAFE, "none", 0.8) for region in safe]
    body += _object(sheet, cage.outline.polygon)
    for puncture in cage.punctures:
        if puncture.kind == "escape":
            body += _hand(sheet, puncture.contacts, cage.finger_radius, OUT, solid=False)
    body += _hand(sheet, cage.contacts, cage.finger_radius, HAND, solid=True)
    return sheet.svg(body, list(_caption(cage)))


def grasp_picture(cage: Cage, caption: str, width: float = WIDTH) -> str:
    """The object, the target hand and, dashed, the hand of the escape; no regions, so at once."""
    hands = [cage.contacts, *(p.contacts for p in cage.punctures if p.kind == "escape")]
    boxes = [box for hand in hands for box in _discs_box(hand, cage.finger_radius)]
    sheet = _Sheet(_bounds([cage.outline.vertices, *boxes]), width)
    body = list(_object(sheet, cage.outline.polygon))
    for hand in hands[1:]:
        body += _hand(sheet, hand, cage.finger_radius, OUT, solid=False)
    body += _hand(sheet, cage.contacts, cage.finger_radius, HAND, solid=True)
    return sheet.svg(body, [caption])


def way_out_picture(cage: Cage, width: float = WIDTH) -> str:
    """The object, the fingers' ways along the escape path, the hand at sigma_max and once free."""
    path, free = cage.escape_path, cage.escape_free_at
    if path is None or free is None:
        return cage_picture(cage, width)
    ways = cage.hand.fingers(path[: free + 1])
    widest = ways[int(np.argmax(path[: free + 1, 3]))]
    boxes = [box for hand in ways for box in _discs_box(hand, cage.finger_radius)]
    sheet = _Sheet(_bounds([cage.outline.vertices, *boxes]), width)
    body = list(_object(sheet, cage.outline.polygon))
    for finger in range(ways.shape[1]):
        points = _pairs(sheet.points(ways[:, finger]))
        body.append(f'<polyline points="{points}" fill="none" stroke="{HAND}" opacity="0.6"/>')
    body += _hand(sheet, widest, cage.finger_radius, HAND, solid=False)
    body += _hand(sheet, ways[-1], cage.finger_radius, OUT, solid=True)
    top, unit = path[: free + 1, 3].max(), f" {cage.unit}" if cage.unit else ""
    return sheet.svg(body, [f"the way out opens at sigma {top:.6g}{unit} (dashed); red: free"])


def outline_picture(outline: Outline, source: shapely.Polygon, width: float = WIDTH) -> str:
    """What a drawing shows (grey), and over it the outline that stands for it, corner by corner."""
    sheet = _Sheet(_bounds([outline.vertices, shapely.get_coordinates(source)]), width)
    body = [_path(sheet, shapely.MultiPolygon([source]), OBJECT, "none", 1.0, exact=True)]
    corners = sheet.points(outline.vertices)
    body.append(f'<polygon points="{_pairs(corners)}" fill="none" stroke="{HAND}"/>')
    body += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="1.8" fill="{HAND}"/>' for x, y in corners]
    return sheet.svg(body, [f"blue: the outline, {len(outline)} vertices; grey: the drawing"])


def _regions(cage: Cage) -> tuple[list[shapely.MultiPolygon], list[shapely.MultiPolygon]]:
    """Inner regions below sigma_max and below sigma_first; none where there is nothing to draw."""
    if cage.work is None:
        return [], []
    whole = list(cage.regions("sigma_max", gap=0.02))
    first = cage.sigma_first
    inside = first is not None and first != cage.sigma_max and first > cage.sigma_0
    return (whole, list(cage.regions("sigma_first", gap=0.02))) if inside else ([], whole)


def _caption(cage: Cage) -> Iterator[str]:
    yield repr(cage)[1:-1]
    if cage.status == "not_a_cage":
        yield cage.why or ""
        return
    if cage.work is not None:
        yield "blue: closing ends in the grasp only; yellow: caged; red: the way out"


class _Sheet:
    """Object coordinates to pixels, y downwards."""

    def __init__(self, bounds: tuple[FloatArray, FloatArray], width: float) -> None:
        low, high = bounds
        self._low, size = low, high - low
        self.scale = (width - 2.0 * _MARGIN) / float(size.max())
        self._top = float(high[1])
        self.width, self.height = (float(v) * self.scale + 2.0 * _MARGIN for v in size)

    def points(self, at: FloatArray) -> FloatArray:
        """(n, 2) pixels of points (n, 2)."""
        x = (at[:, 0] - self._low[0]) * self.scale + _MARGIN
        y = (self._top - at[:, 1]) * self.scale + _MARGIN
        return np.column_stack([x, y])

    def svg(self, body: Iterable[str], caption: list[str]) -> str:
        """The document: a drawing, and lines of text below it."""
        down = [self.height + _CAPTION * (k + 0.7) for k in range(len(caption))]
        lines = [
            f'<text x="{_MARGIN}" y="{y:.1f}">{escape(line)}</text>'
            for y, line in zip(down, caption, strict=True)
        ]
        width = max(self.width, 2.0 * _MARGIN + 7.0 * max(map(len, caption), default=0))
        height = self.height + _CAPTION * len(caption)
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height:.0f}" '
            f'viewBox="0 0 {width:.0f} {height:.0f}" font-family="sans-serif" font-size="12" '
            f'fill="{EDGE}">' + "".join([*body, *lines]) + "</svg>"
        )


def _bounds(parts: Iterable[FloatArray]) -> tuple[FloatArray, FloatArray]:
    every = np.vstack([part for part in parts if len(part)])
    return every.min(axis=0), every.max(axis=0)


def _discs_box(contacts: FloatArray | None, radius: float) -> list[FloatArray]:
    return [] if contacts is None else [contacts - radius, contacts + radius]


def _object(sheet: _Sheet, polygon: shapely.Polygon) -> Iterator[str]:
    yield _path(sheet, shapely.MultiPolygon([polygon]), OBJECT, EDGE, 1.0, exact=True)


def _path(
    sheet: _Sheet, region: shapely.MultiPolygon, fill: str, stroke: str, opacity: float,
    *, exact: bool = False,
) -> str:  # fmt: skip
    """One ``path`` of all rings of a region."""
    drawn = region if exact else region.simplify(_COARSE / sheet.scale)
    rings = [
        "M"
        + " ".join(f"{x:.1f},{y:.1f}" for x, y in sheet.points(shapely.get_coordinates(ring)[:-1]))
        + "Z"
        for part in shapely.get_parts(drawn)
        for ring in (part.exterior, *part.interiors)
    ]
    return (
        f'<path d="{"".join(rings)}" fill="{fill}" fill-opacity="{opacity:g}" fill-rule="evenodd" '
        f'stroke="{stroke}" stroke-width="1.2" stroke-linejoin="round"/>'
    )


def _pairs(at: FloatArray) -> str:
    """Pixels (n, 2) as a list of points."""
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in at)


def _hand(
    sheet: _Sheet, contacts: FloatArray, radius: float, colour: str, *, solid: bool
) -> Iterator[str]:
    """The polygon of the fingers and the fingers themselves, numbered."""
    at = sheet.points(contacts)
    dashes = "" if solid else ' stroke-dasharray="4 3"'
    yield f'<polygon points="{_pairs(at)}" fill="none" stroke="{colour}"{dashes}/>'
    size = max(radius * sheet.scale, 3.0)
    for number, (x, y) in enumerate(at, start=1):
        fill = colour if solid else "white"
        yield (
            f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{size:.1f}" fill="{fill}" fill-opacity="0.85" '
            f'stroke="{colour}"/>'
        )
        yield (
            f'<text x="{x + size + 2.0:.1f}" y="{y - size:.1f}" fill="{colour}" '
            f'font-weight="bold">{number}</text>'
        )
