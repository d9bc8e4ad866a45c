"""A PNG or JPEG image as a drawing: one shape, a pixel one unit long, without a size."""

from __future__ import annotations

import numpy as np

from icage.formats.drawings.curves import Polyline
from icage.formats.drawings.drawing import Drawing, Shape
from icage.formats.drawings.reading import Reading
from icage.formats.image.contour import contour
from icage.formats.image.mask import largest_blob
from icage.formats.image.pixels import pixels


def read(content: bytes, reading: Reading) -> Drawing:
    """The drawing that an image shows. Its resolution in dpi is not believed: a width is needed.

    Raises
    ------
    FormatError:
        Not a readable image, or nothing stands out in it.
    """
    image = pixels(content)
    blob = largest_blob(image, reading.threshold)
    # The middle of pixel (row, column) is at (column + 1/2, rows - row - 1/2).
    row, column = blob.corner
    shift = np.array([column + 0.5, len(image.values) - row - 0.5])
    rings = [ring * [1.0, -1.0] + shift for ring in contour(blob)]
    shape = Shape(tuple((Polyline(ring),) for ring in rings), (), "evenodd")
    return Drawing(shapes=(shape,), notes=blob.notes)
