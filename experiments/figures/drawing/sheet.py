"""A page whose only axes are in points (1/72 inch), so that text, lines and shapes share a ruler.

The drawing fills the page's width above a caption. Where the hand is small on the object (a saw),
the drawing shows the surroundings of the hand, and a smaller overview above it the whole object.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

Bounds = tuple[float, float, float, float]
"""x and y of the lower left, then of the upper right corner."""

_WIDEST, _TALLEST = 500.0, 400.0
"""[pt] The drawing fits into this: a text column of a journal, and not more than half a page."""

_NARROWEST = 432.0
"""[pt] Room for the lines of the caption."""

_MARGIN = 14.0
"""[pt]"""

_AROUND = 16.0
"""[pt] Free border of the drawing, room for a number outside everything."""

_OVERVIEW = (280.0, 110.0)
"""[pt] The overview fits into this."""

_WORTH_A_DETAIL = 2.0
"""[1] A detail must be larger than the whole at least by this."""

_LEAST_ASPECT = 1.4
"""[1] Width over height of a detail: a narrow strip of an object is hard to recognize."""


@dataclass(frozen=True, slots=True)
class View:
    """A window onto the object's frame: ``page = origin + zoom * (point - corner)``."""

    zoom: float
    corner: NDArray[np.float64]
    origin: NDArray[np.float64]
    window: Bounds

    def point(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Points (..., 2) of the object's frame, on the page."""
        return self.origin + self.zoom * (np.asarray(points) - self.corner)

    def shape(self, geometry: BaseGeometry) -> BaseGeometry:
        """A geometry of the object's frame, on the page."""
        return shapely.transform(geometry, self.point)


@dataclass(frozen=True, slots=True)
class Sheet:
    """A figure, its axes in points, its views; the caption has the strip below ``floor``."""

    figure: Figure
    axes: Axes
    main: View
    overview: View | None
    width: float
    height: float
    floor: float
    """[pt]"""

    @property
    def left(self) -> float:
        """Where lines of text start."""
        return _MARGIN

    @property
    def right(self) -> float:
        """Where they end."""
        return self.width - _MARGIN


def lay_out(whole: Bounds, detail: Bounds, strip: float) -> Sheet:
    """A sheet above a caption ``strip`` points high.

    ``whole`` holds everything there is to draw and ``detail`` only the hand and its regions, both
    in the object's frame.
    """
    near = _widened(detail, 0.12)
    zoom = _fit(whole, (_WIDEST, _TALLEST), _AROUND)
    close_up = _fit(near, (_WIDEST, 0.75 * _TALLEST), 0.0)
    has_detail = close_up > _WORTH_A_DETAIL * zoom
    shown = near if has_detail else whole
    zoom = close_up if has_detail else zoom
    around = 0.0 if has_detail else _AROUND
    wide, tall = zoom * (shown[2] - shown[0]), zoom * (shown[3] - shown[1])
    width = max(_NARROWEST, wide + 2.0 * max(around, _MARGIN))
    floor = strip + (2.0 if has_detail else 1.0) * _MARGIN
    x, y = 0.5 * (width - wide), floor + around
    ceiling = y + tall + around
    window = (x, y, x + wide, y + tall) if has_detail else (2.0, floor, width - 2.0, ceiling)
    main = View(zoom, np.array(shown[:2]), np.array([x, y]), window)
    overview = _overview(whole, x, ceiling + _MARGIN) if has_detail else None
    top = overview.window[3] if overview is not None else ceiling - 2.0
    height = top + 2.0 + (6.0 if has_detail else 0.0)
    figure = Figure(figsize=(width / 72.0, height / 72.0), facecolor="white")
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_xlim(0.0, width)
    axes.set_ylim(0.0, height)
    axes.set_axis_off()
    return Sheet(figure, axes, main, overview, width, height, strip + _MARGIN)


def _overview(whole: Bounds, x: float, y: float) -> View:
    zoom = _fit(whole, _OVERVIEW, 0.0)
    wide, tall = zoom * (whole[2] - whole[0]), zoom * (whole[3] - whole[1])
    return View(zoom, np.array(whole[:2]), np.array([x, y]), (x, y, x + wide, y + tall))


def _fit(bounds: Bounds, room: tuple[float, float], around: float) -> float:
    """Points per unit of length so that ``bounds`` fill the room but for a border."""
    return min(
        (room[0] - 2.0 * around) / (bounds[2] - bounds[0]),
        (room[1] - 2.0 * around) / (bounds[3] - bounds[1]),
    )


def _widened(bounds: Bounds, share: float) -> Bounds:
    """A border all round, and at least as wide as ``_LEAST_ASPECT`` asks for."""
    by = share * max(bounds[2] - bounds[0], bounds[3] - bounds[1])
    tall = bounds[3] - bounds[1] + 2.0 * by
    side = max(by, 0.5 * (_LEAST_ASPECT * tall - (bounds[2] - bounds[0])))
    return bounds[0] - side, bounds[1] - by, bounds[2] + side, bounds[3] + by
