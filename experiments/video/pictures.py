"""Beside a film: a sheet of its frames, and a small GIF for a page that plays nothing else."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from experiments.figures.drawing.canvas import Canvas, Pixels
from experiments.figures.drawing.palette import QUIET_INK, RULE

COLUMNS, ROWS = 3, 3
"""Frames of a sheet."""

_SHEET: Final = (640, 360)
_GAP: Final = 24
"""[pixel] Size of a frame on the sheet, and what is around it."""

_GIF: Final = (640, 360)
_GIF_FPS: Final = 10.0
_MOST: Final = 120
"""[pixel], [1 / s] Of a GIF, and its frames: a longer film is shown in larger steps."""

_COLOURS: Final = 128
"""Of all frames together: the page has few, and edges of letters."""

_SAMPLED: Final = 12
"""Frames that the colours are chosen from."""


def _small(pixels: Pixels, size: tuple[int, int]) -> Image.Image:
    whole = Image.fromarray(np.ascontiguousarray(pixels[..., :3]))
    return whole.resize(size, Image.Resampling.LANCZOS)


@dataclass(slots=True)
class Sheet:
    """Frames of a film of ``frames``, evenly spaced, the first and the last among them."""

    title: str
    frames: int
    fps: int
    kept: list[tuple[int, NDArray[np.uint8]]] = field(
        default_factory=list[tuple[int, NDArray[np.uint8]]]
    )

    def see(self, number: int, pixels: Pixels) -> None:
        """Keep a frame if it is one of those."""
        if number in np.linspace(0, self.frames - 1, COLUMNS * ROWS).round().astype(int):
            self.kept.append((number, np.asarray(_small(pixels, _SHEET))))

    def save(self, path: Path) -> None:
        """Write them in rows, with their times, as a PNG file."""
        (wide, high), head = _SHEET, 64
        canvas = Canvas(
            COLUMNS * (wide + _GAP) + _GAP, ROWS * (high + 2 * _GAP) + _GAP + head
        )  # fmt: skip
        canvas.text(_GAP, 46.0, self.title, 28.0, bold=True)
        for place, (number, picture) in enumerate(self.kept):
            left = _GAP + place % COLUMNS * (wide + _GAP)
            top = head + _GAP + place // COLUMNS * (high + 2 * _GAP)
            canvas.paste(picture, left, top)
            edge = [[left, top], [left + wide, top], [left + wide, top + high], [left, top + high]]
            canvas.line([*edge, edge[0]], RULE, 1.0)
            canvas.text(left, top + high + 18.0, f"{number / self.fps:.1f} s", 15.0, QUIET_INK)
        Image.fromarray(canvas.pixels[..., :3]).save(path, format="PNG", optimize=True)


@dataclass(slots=True)
class Gif:
    """A film of ``frames`` in few frames and few colours."""

    frames: int
    fps: int
    kept: list[Image.Image] = field(default_factory=list[Image.Image])

    @property
    def every(self) -> int:
        """Frames of the film from one of the GIF to the next."""
        return max(round(self.fps / _GIF_FPS), -(-self.frames // _MOST), 1)

    def see(self, number: int, pixels: Pixels) -> None:
        """Keep a frame if it is one of those; the last of the film is."""
        if (self.frames - 1 - number) % self.every == 0:
            self.kept.append(_small(pixels, _GIF))

    def save(self, path: Path) -> None:
        """Write them as a GIF file that begins again at its end."""
        some = np.linspace(0, len(self.kept) - 1, min(_SAMPLED, len(self.kept))).round().astype(int)
        mosaic = Image.fromarray(np.vstack([np.asarray(self.kept[k]) for k in some.tolist()]))
        colours = mosaic.quantize(_COLOURS, method=Image.Quantize.MEDIANCUT, kmeans=1)
        plain = [one.quantize(palette=colours, dither=Image.Dither.NONE) for one in self.kept]
        pause = round(1000.0 * self.every / self.fps)
        plain[0].save(
            path, format="GIF", save_all=True, append_images=plain[1:], loop=0, optimize=True,
            duration=[pause] * (len(plain) - 1) + [1500],
        )  # fmt: skip
