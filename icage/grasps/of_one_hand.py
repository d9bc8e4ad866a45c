"""All immobilizing grasps of one given hand on an outline. [Bunis2018, Fig. 2]

Every strict local minimum of sigma over the whole free space, however shallow its basin (down to
the depth cut): from the least points of all cells, kept if no cell round them goes deeper.
"""

from __future__ import annotations

from itertools import takewhile

import numpy as np

from icage.arrays import FloatArray, IntArray
from icage.cells.free_space import Configuration, FreeSpace
from icage.cells.kernels.columns import BIRTH_SIGMA, BIRTH_WX, BIRTH_WY, BORN_FINGER, BORN_SLOT
from icage.cells.kernels.search import TIE
from icage.cells.kernels.tree import lowest_cells
from icage.cells.target import is_strict_minimum
from icage.discs.offsets import offsets
from icage.errors import InputError
from icage.geometry.near_frame import NearFrame
from icage.hand import HandShape
from icage.outline import Outline
from icage.tolerance import DEPTH_CUT, SAME_POINT

SEGMENTS = 8
"""Segments a quadrant of the polygon that stands in for disc fingers."""

MOST_PIECES = 250
"""Pieces of the plane beyond which the table of all cells would not fit into 1 GB."""

_SAME_HAND = 1e-7
"""[diameter] Two hands whose fingers are this close are one: above the rounding of a least point,
far below the distance of two minima that a depth of DEPTH_CUT can tell apart."""


def grasps_of_hand(outline: Outline, hand: HandShape, radius: float = 0.0) -> list[FloatArray]:
    """Contacts (3, 2) of all strict local minima of sigma, by sigma, then by contacts.

    Of discs (``radius`` [unit]) they are those of chords, ``SEGMENTS`` a quadrant.

    Raises
    ------
    InputError:
        The outline needs more than ``MOST_PIECES`` convex pieces around it.

    Examples
    --------
    >>> triangle = Outline([[0, 0], [1, 0], [0.5, 0.75**0.5]])
    >>> len(grasps_of_hand(triangle, HandShape.from_angles_deg(60, 120)))
    3
    """
    frame = NearFrame.of(outline)
    near = frame.outline_into(outline)
    if radius > 0.0:
        # far from the origin a grown polygon has more corners than there are floats for
        near = offsets(near, radius, SEGMENTS).inner
    free_space = FreeSpace.around(near, hand)
    pieces = free_space.pieces
    if pieces.total > MOST_PIECES:
        raise InputError(
            f"the outline needs {pieces.total} pieces; up to {MOST_PIECES} are allowed here: "
            "simplify it"
        )
    size = pieces.diameter
    lowest = lowest_cells(
        pieces, free_space.z, free_space.cap, free_space.worst, TIE * size, DEPTH_CUT * size
    )
    found: list[tuple[float, Configuration]] = []
    low = lowest.birth
    for k in np.argsort(low[:, BIRTH_SIGMA], kind="stable"):
        here = _least_point(free_space, lowest.cells[k], low[k], lowest.birth_at[k])
        sigma = float(low[k, BIRTH_SIGMA])
        if _known(free_space, here, sigma, found):
            continue
        if is_strict_minimum(free_space, here, sigma):
            found.append((sigma, here))
    return [frame.back(free_space.contacts(here)) for _, here in found]


def _least_point(
    free_space: FreeSpace, cell: IntArray, low: FloatArray, where: IntArray
) -> Configuration:
    finger, slot = int(where[BORN_FINGER]), int(where[BORN_SLOT])
    a, b = free_space.on_edge(cell, finger, slot, low[BIRTH_WX], low[BIRTH_WY])
    return Configuration(0.5 * (a.d + b.d), a.w)


def _known(
    free_space: FreeSpace,
    here: Configuration,
    sigma: float,
    found: list[tuple[float, Configuration]],
) -> bool:
    """Whether a configuration is among those found, which come in ascending order of sigma."""
    least = sigma - SAME_POINT * free_space.pieces.diameter
    last = takewhile(lambda pair: pair[0] >= least, reversed(found))
    return any(_same(free_space, here, known) for _, known in last)


def _same(free_space: FreeSpace, a: Configuration, b: Configuration) -> bool:
    shift = np.abs((a.d - b.d) + (a.w - b.w) * free_space.hand.z).max()
    return bool(shift <= _SAME_HAND * free_space.pieces.diameter)
