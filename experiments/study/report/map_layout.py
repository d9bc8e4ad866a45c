"""Where the panels of the placement map stand on its page."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from experiments.figures.drawing.sheet import Bounds
from experiments.study.report.pictures import MARGIN, WIDE

_LONG: Final = 2.0
"""[1] Panels wider than this times their height stand one above the other."""

SCALE: Final = 18.0
"""[pt] Below a panel, for the scale bar."""

_GAP, _TITLE, _TALLEST = 10.0, 16.0, 235.0
"""[pt] Between panels; above one, its name; height of one of the whole."""

_ROOM, _ALL = WIDE - 2.0 * MARGIN, 500.0
"""[pt] Width and largest height of all panels together, close-ups among them."""

_TALL: Final = 390.0
"""[pt] Height of a close-up with others beside it."""

_WHOLE: Final = 0.45
"""[1] Share of a row that the whole has beside a close-up, at least."""

_NEAR: Final = 0.8
"""[1] Among arrangements that magnify nearly as much as the best, the one that fills the page."""

_WIDER: Final = 1.3
"""[1] Close-ups in a row are made wider by up to this to fill it."""

_WIDENED: Final = 3
"""How often the panel of the whole is made wider, at most, to hold the others' frames."""


@dataclass(frozen=True, slots=True)
class Place:
    """A panel on the page, [pt]: ``below`` from the page's top to the foot of its scale bar."""

    window: Bounds
    x: float
    width: float
    height: float
    below: float

    @property
    def zoom(self) -> float:
        """[pt] per unit of length."""
        return self.width / (self.window[2] - self.window[0])


def placed(whole: Bounds, close_ups: Sequence[Bounds]) -> list[Place]:
    """Where the panels of the fingers stand, a panel of the whole before them if there are four.

    Close-ups share a scale and keep their shapes.
    """
    if not close_ups:
        return list(_alike(whole))
    places = _best(whole, close_ups)
    for _ in range(_WIDENED):  # panels may be wider than their windows: all lie in the whole
        frames = np.array([place.window for place in places])
        pad = 0.02 * (whole[2] - whole[0])
        least, most = frames[1:, :2].min(axis=0) - pad, frames[1:, 2:].max(axis=0) + pad
        if (least + pad >= frames[0, :2]).all() and (most - pad <= frames[0, 2:]).all():
            break
        low, high = np.minimum(whole[:2], least), np.maximum(whole[2:], most)
        whole = (float(low[0]), float(low[1]), float(high[0]), float(high[1]))
        places = _best(whole, close_ups)
    return places


def _best(whole: Bounds, close_ups: Sequence[Bounds]) -> list[Place]:
    """The fullest page among those with about the largest close-ups."""
    ways = [_below(whole, close_ups), _beside(whole, close_ups), _right(whole, close_ups)]
    best = max(places[1].zoom for places in ways)
    return max((places for places in ways if places[1].zoom >= _NEAR * best), key=_filled_share)


def _alike(whole: Bounds) -> Iterator[Place]:
    """The whole three times, side by side or one above the other."""
    long = _aspect(whole) > _LONG
    width = _ROOM if long else (_ROOM - 2.0 * _GAP) / 3.0
    width = min(width, _TALLEST * _aspect(whole))
    height = width / _aspect(whole)
    for k in range(3):
        x = MARGIN if long else MARGIN + k * (width + _GAP)
        below = (_TITLE + height + SCALE) * (k + 1 if long else 1)
        yield Place(whole, x, width, height, below)


def _below(whole: Bounds, close_ups: Sequence[Bounds]) -> list[Place]:
    """The whole, and below it the close-ups in a row."""
    width = min(_ROOM, _TALLEST * _aspect(whole))
    height = width / _aspect(whole)
    top = _TITLE + height + SCALE
    sizes = [_size(window) for window in close_ups]
    space = _ROOM - (len(sizes) - 1) * _GAP
    left = _ALL - top - _TITLE - SCALE
    zoom = min(space / sum(w for w, _ in sizes), left / max(h for _, h in sizes))
    return [Place(whole, MARGIN, width, height, top), *_row(close_ups, zoom, MARGIN, space, top)]


def _beside(whole: Bounds, close_ups: Sequence[Bounds]) -> list[Place]:
    """The whole beside the first close-up, the others below."""
    first, *others = sizes = [_size(window) for window in close_ups]
    space = _ROOM - (len(others) - 1) * _GAP
    rows = first[1] + max(h for _, h in others)
    zoom = min(
        ((1.0 - _WHOLE) * _ROOM - _GAP) / first[0],
        space / sum(w for w, _ in others),
        (_ALL - 2.0 * (_TITLE + SCALE)) / rows,
    )
    width = min(_ROOM - _GAP - zoom * sizes[0][0], _TALLEST * _aspect(whole))
    height = width / _aspect(whole)
    x = MARGIN + width + _GAP
    one = _row(close_ups[:1], zoom, x, MARGIN + _ROOM - x, 0.0)
    below = max(_TITLE + height + SCALE, one[0].below)
    start = Place(whole, MARGIN, width, height, _TITLE + height + SCALE)
    return [start, *one, *_row(close_ups[1:], zoom, MARGIN, space, below)]


def _right(whole: Bounds, close_ups: Sequence[Bounds]) -> list[Place]:
    """The whole and, below it, two close-ups on the left, the tallest on the right of them."""
    sizes = [_size(window) for window in close_ups]
    tallest = max(range(3), key=lambda k: sizes[k][1])
    left = [k for k in range(3) if k != tallest]
    widest = max(sizes[k][0] for k in left)
    heights = sum(sizes[k][1] for k in left)
    foot = _TITLE + SCALE
    space = _ROOM - _GAP
    # the height of the whole falls as the close-up beside it grows: both linear in the zoom
    slope = heights - sizes[tallest][0] / _aspect(whole)
    zoom = min(
        space / (widest + sizes[tallest][0]),
        (1.0 - _WHOLE) * space / sizes[tallest][0],
        _TALL / sizes[tallest][1],
        (_ALL - 3.0 * foot - space / _aspect(whole)) / slope if slope > 0.0 else math.inf,
    )
    if not zoom > 0.0:
        return _below(whole, close_ups)
    width = space - zoom * sizes[tallest][0]
    height = width / _aspect(whole)
    below = foot + height
    places = {-1: Place(whole, MARGIN, width, height, below)}
    for k in left:
        (places[k],) = _row([close_ups[k]], zoom, MARGIN, width, below)
        below = places[k].below
    x = MARGIN + width + _GAP
    (places[tallest],) = _row([close_ups[tallest]], zoom, x, MARGIN + _ROOM - x, 0.0)
    return [places[k] for k in range(-1, 3)]


def _row(
    windows: Sequence[Bounds], zoom: float, x: float, space: float, above: float
) -> list[Place]:
    """Panels side by side from ``x`` on, wider than their windows if that fills the space."""
    wider = space / (zoom * sum(_size(window)[0] for window in windows))
    wider = wider if 1.0 < wider <= _WIDER else 1.0
    places: list[Place] = []
    for window in windows:
        width, height = (zoom * side for side in _size(window))
        seen = _filled(window, wider * width / height)
        places.append(Place(seen, x, wider * width, height, above + _TITLE + height + SCALE))
        x += wider * width + _GAP
    return places


def _filled_share(places: Sequence[Place]) -> float:
    """How much of the page is panels."""
    area = sum(place.width * place.height for place in places)
    return area / max(place.below for place in places)


def _size(window: Bounds) -> tuple[float, float]:
    return window[2] - window[0], window[3] - window[1]


def _aspect(window: Bounds) -> float:
    return (window[2] - window[0]) / (window[3] - window[1])


def _filled(window: Bounds, aspect: float) -> Bounds:
    """The window, made wider or higher to have the aspect of its panel."""
    width, height = window[2] - window[0], window[3] - window[1]
    more_x = max(0.0, 0.5 * (aspect * height - width))
    more_y = max(0.0, 0.5 * (width / aspect - height))
    return window[0] - more_x, window[1] - more_y, window[2] + more_x, window[3] + more_y
