"""Decode an image into shares of the object, one number a pixel, within limits."""

from __future__ import annotations

import io
import warnings
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from icage.arrays import GreyArray
from icage.errors import FormatError

MAX_PIXELS: Final = 25_000_000
"""Of an image; a photo of 24 megapixels is below."""

KINDS: Final = ("PNG", "JPEG")

_TRANSPARENT: Final = 0.02
"""Share of pixels that must be more transparent than not, for the alpha channel to count."""


@dataclass(frozen=True, slots=True, eq=False)
class Pixels:
    """An image as it is shown.

    Attributes
    ----------
    values:
        (rows, columns) in 0 to 1, first row at the top: luminance, or opacity.
    by_alpha:
        Whether they are the opacity.
    notes:
        Warnings, a sentence each.
    """

    values: GreyArray
    by_alpha: bool
    notes: tuple[str, ...]


def pixels(content: bytes) -> Pixels:
    """The pixels of a PNG or JPEG image.

    Raises
    ------
    FormatError:
        No such image, too large, or damaged.
    """
    from PIL import Image

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of sizes, which are checked here
        try:
            image = Image.open(io.BytesIO(content), formats=KINDS)
        except Image.DecompressionBombError as error:
            raise FormatError(f"the image has more than {MAX_PIXELS} pixels; scale it") from error
        except Exception as error:  # whatever its decoders meet in a broken file
            raise FormatError("this is no PNG or JPEG image, or its header is damaged") from error
        columns, rows = image.size
        if columns * rows > MAX_PIXELS:
            raise FormatError(
                f"the image has {columns} x {rows} pixels, at most {MAX_PIXELS} are allowed: "
                "scale it"
            )
        if min(columns, rows) < 3:
            raise FormatError(f"the image has {columns} x {rows} pixels; 3 x 3 are needed")
        try:
            return _decoded(image)
        except Exception as error:
            raise FormatError(
                f"the image cannot be decoded ({' '.join(str(error).split())[:100]})"
            ) from error


def _decoded(image: Any) -> Pixels:
    from PIL import ImageOps

    notes: list[str] = []
    if getattr(image, "n_frames", 1) > 1:
        notes.append(f"the image has {image.n_frames} frames: the first one was read")
    image.load()
    image = ImageOps.exif_transpose(image)
    mode = image.mode
    if mode in ("RGBA", "LA", "PA", "RGBa", "La") or "transparency" in image.info:
        own = image if "A" in image.getbands() else image.convert("RGBA")
        alpha = _shares(own.getchannel("A"), 255.0)
        del own
        clear = float((alpha < 0.5).mean())
        if clear >= _TRANSPARENT and clear < 1.0:
            return Pixels(alpha, True, tuple(notes))
        if clear > 0.0:
            notes.append(f"the image is transparent in {100 * clear:.2g} % of its pixels: not used")
        # What is transparent is shown on white.
        from PIL import Image

        whole = image.convert("RGBA")
        white = Image.new("RGBA", whole.size, (255, 255, 255, 255))
        image = Image.alpha_composite(white, whole).convert("RGB")
    if mode.startswith("I"):  # 16 bits
        return Pixels(_shares(image, 65535.0), False, tuple(notes))
    grey = image if image.mode == "L" else image.convert("RGB").convert("L")
    return Pixels(_shares(grey, 255.0), False, tuple(notes))


def _shares(image: Any, top: float) -> GreyArray:
    """The pixels of one channel in 0 to 1."""
    values: GreyArray = np.array(image, dtype=np.float32)
    values /= np.float32(top)
    return values
