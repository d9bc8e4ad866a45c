"""What a mesh shows as a drawing: cut at a height, or looked at along an axis.

One looks against the axis, so that x and y of the drawing and the axis are right-handed: along z, x
is to the right and y up; along x, y is to the right and z up; along y, z is to the right and x up.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from icage.arrays import FloatArray
from icage.formats.drawings.drawing import Drawing
from icage.formats.drawings.reading import Axis, Reading
from icage.formats.mesh.section import section
from icage.formats.mesh.silhouette import silhouette

COLUMNS: Final[dict[Axis, tuple[int, int, int]]] = {"x": (1, 2, 0), "y": (2, 0, 1), "z": (0, 1, 2)}
"""Which coordinates are to the right, up, and towards the eye."""


def seen(triangles: FloatArray, reading: Reading) -> Drawing:
    """The drawing of triangles (n, 3, 3); it states no unit, as meshes do not.

    Raises
    ------
    FormatError:
        Nothing is cut or seen, or it is too much.
    """
    axis = reading.axis or "z"
    turned = np.ascontiguousarray(triangles[:, :, COLUMNS[axis]])
    if reading.section is None:
        return silhouette(turned)
    return section(turned, reading.section, axis)
