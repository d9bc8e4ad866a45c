"""Where the panels of the placement map stand on its page."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from experiments.drawing.sheet import Bounds
from experiments.study.pictures import MARGIN, WIDE

_LONG: Final = 2.0
"""[1] Panels wider than this times their height stand one above the other."""

SCALE: Final = 18.0
"""[pt] Below a panel, for the scale bar."""

_GAP, _TITLE, _TALLEST = 10.0, 16.0, 235.0
"""[pt] Between panels; above one, its name; height of one."""


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
    """Where the panels of the fingers stand, a panel of the whole before them if there are four."""
    long = _aspect(whole) > _LONG
    if close_ups:
        both = [whole, *close_ups]
        rows = [both[:1], both[1:]] if long else [both[:2], both[2:]]
    else:
        rows = [[whole]] * 3 if long else [[whole] * 3]
    places: list[Place] = []
    below = 0.0
    for row in rows:
        width = (WIDE - 2.0 * MARGIN - (len(row) - 1) * _GAP) / len(row)
        height = min(width / min(_aspect(window) for window in row), _TALLEST)
        below += _TITLE + height + SCALE
        for k, window in enumerate(row):
            seen = _filled(window, width / height)
            places.append(Place(seen, MARGIN + k * (width + _GAP), width, height, below))
    return places


def _aspect(window: Bounds) -> float:
    return (window[2] - window[0]) / (window[3] - window[1])


def _filled(window: Bounds, aspect: float) -> Bounds:
    """The window, made wider or higher to have the aspect of its panel."""
    width, height = window[2] - window[0], window[3] - window[1]
    more_x = max(0.0, 0.5 * (aspect * height - width))
    more_y = max(0.0, 0.5 * (width / aspect - height))
    return window[0] - more_x, window[1] - more_y, window[2] + more_x, window[3] + more_y
