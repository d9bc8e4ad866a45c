"""A small fast canvas: matplotlib's Agg rasterizer without a figure. One unit is one pixel, y down;
or ``scale`` pixels, so that one layout makes pictures of any size.

Antialiased paths with transparency at a few hundred microseconds each, so that a video frame is
drawn in milliseconds, with nothing but what the package depends on anyway.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.backends.backend_agg import RendererAgg
from matplotlib.font_manager import FontProperties
from matplotlib.path import Path
from matplotlib.transforms import Affine2D, Bbox
from numpy.typing import ArrayLike, NDArray

from experiments.figures.drawing.palette import INK, Colour

Pixels = NDArray[np.uint8]
"""(height, width, 4), red, green, blue, alpha."""

_CIRCLE = Path.unit_circle()


@dataclass(frozen=True, slots=True)
class Pen:
    """How a line is drawn: width and dashes in [pixel]."""

    colour: Colour
    width: float = 1.0
    dash: Sequence[float] | None = None
    alpha: float = 1.0


class Canvas:
    """Width x height units of ``scale`` pixels, white at first."""

    def __init__(self, width: int, height: int, scale: float = 1.0) -> None:
        self.width, self.height, self.scale = width, height, scale
        self._agg = RendererAgg(round(width * scale), round(height * scale), 72.0 * scale)
        self._clip: Bbox | None = None
        self.pixels[:] = 255

    @property
    def pixels(self) -> Pixels:
        """The picture so far: a view, to be copied by whoever keeps it."""
        return np.asarray(self._agg.buffer_rgba())

    def clip(self, box: tuple[float, float, float, float] | None) -> None:
        """Draw only inside (left, top, right, bottom) from now on, or everywhere."""
        if box is None:
            self._clip = None
        else:
            left, top, right, bottom = box
            corners = [[left, self.height - bottom], [right, self.height - top]]
            self._clip = Bbox([[self.scale * x, self.scale * y] for x, y in corners])

    def path(
        self,
        path: Path,
        to_pixels: Affine2D | None = None,
        *,
        fill: Colour | None = None,
        alpha: float = 1.0,
        pen: Pen | None = None,
    ) -> None:
        """A path, filled, and outlined by the pen; ``to_pixels`` maps it to pixels with y down."""
        gc = self._agg.new_gc()
        gc.set_joinstyle("round")
        gc.set_capstyle("round" if pen is None or pen.dash is None else "butt")
        if self._clip is not None:
            gc.set_clip_rectangle(self._clip)
        if pen is None:
            gc.set_linewidth(0.0)
        else:
            gc.set_foreground((*pen.colour, pen.alpha), isRGBA=True)
            gc.set_linewidth(pen.width)
            gc.set_dashes(0.0, None if pen.dash is None else list(pen.dash))
        upwards = (to_pixels or Affine2D()) + Affine2D().scale(1.0, -1.0).translate(
            0.0, self.height
        ).scale(self.scale)
        face = None if fill is None else (*fill, alpha)
        self._agg.draw_path(gc, path, upwards, face)
        gc.restore()

    def line(
        self,
        points: ArrayLike,
        colour: Colour,
        width: float = 1.0,
        dash: Sequence[float] | None = None,
        alpha: float = 1.0,
    ) -> None:
        """A polyline through points (n, 2)."""
        pen = Pen(colour, width, dash, alpha)
        self.path(Path(np.asarray(points, dtype=np.float64)), pen=pen)

    def box(self, box: tuple[float, float, float, float], fill: Colour, alpha: float = 1.0) -> None:
        """A filled rectangle (left, top, right, bottom)."""
        left, top, right, bottom = box
        corners = [[left, top], [right, top], [right, bottom], [left, bottom], [left, top]]
        self.path(Path(np.array(corners), closed=True), fill=fill, alpha=alpha)

    def disc(
        self,
        centre: ArrayLike,
        radius: float,
        fill: Colour | None,
        edge: Colour | None = None,
        width: float = 1.0,
        alpha: float = 1.0,
    ) -> None:
        """A disc."""
        x, y = np.asarray(centre, dtype=np.float64).tolist()
        place = Affine2D().scale(radius).translate(x, y)
        pen = None if edge is None else Pen(edge, width, alpha=alpha)
        self.path(_CIRCLE, place, fill=fill, alpha=alpha, pen=pen)

    def text(
        self,
        x: float,
        y: float,
        text: str,
        size: float,
        colour: Colour = INK,
        *,
        bold: bool = False,
        anchor: str = "left",
        math: bool = False,
    ) -> float:
        """A line of text on the baseline y, ``anchor`` (left, middle, right) at x; its width."""
        font = FontProperties(family="DejaVu Sans", size=size, weight="bold" if bold else "normal")
        wide, _, _ = self._agg.get_text_width_height_descent(text, font, math)
        wide /= self.scale
        left = x - {"left": 0.0, "middle": 0.5, "right": 1.0}[anchor] * wide
        gc = self._agg.new_gc()
        gc.set_foreground(colour)
        self._agg.draw_text(gc, self.scale * left, self.scale * y, text, font, 0.0, ismath=math)
        gc.restore()
        return float(wide)

    def paste(self, picture: NDArray[np.uint8], left: int, top: int) -> None:
        """Copy a picture (h, w, 3 or 4), in pixels, to a place that holds it."""
        high, wide, channels = picture.shape
        left, top = round(self.scale * left), round(self.scale * top)
        self.pixels[top : top + high, left : left + wide, :channels] = picture
