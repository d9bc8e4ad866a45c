"""All minima of sigma for one hand and where they merge, by the cells' method. Our own.

The counterpart of ``icage.contact_space.sublevel``: two ways to one diagram.
[docs/decisions/0014-whole-sublevels.md]
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple, TypeVar

import numpy as np

from icage.arrays import AnyArray, FloatArray, IntArray
from icage.cells.free_space import FreeSpace
from icage.cells.kernels.basins import basins_of, ends_of_basins, least_forest
from icage.cells.kernels.inhabited import extents_of, inhabited_cells
from icage.cells.kernels.whole import (
    Passes,
    cells_by_piece,
    edges_that_lead_nowhere,
    least_hands,
    least_of_isolated,
    least_passes,
    lower_at_walls,
    passes_from,
)
from icage.errors import InputError
from icage.geometry.near_frame import NearFrame
from icage.hand import HandShape
from icage.minima import Sublevels
from icage.outline import Outline
from icage.tolerance import DEPTH_CUT

MOST_CELLS = 5_000_000
"""Cells that hold a hand, beyond which their passes and merges would take more than 1 GB."""

_AT_CAP = 1.0 + 1e-9
"""[1] Passes up to this part of the cap are taken: at the cap every hand has escaped, and rounding
must not make a hand that escapes just there one that never does."""

_STRETCH = 10_000
"""Cells that a thread takes at a time: some 50 ms."""

Done = TypeVar("Done")


class Minima(NamedTuple):
    """The minima that count, by sigma: births, merges and ``into`` (m,), contacts (m, 3, 2).

    ``cells`` (m, 3) are those in which they lie; contacts are in the free space's frame.
    """

    births: FloatArray
    merges: FloatArray
    into: IntArray
    contacts: FloatArray
    cells: IntArray


def sublevels_of(outline: Outline, hand: HandShape, workers: int = 1) -> Sublevels:
    """The whole sublevel structure of a hand with point fingers. See ``icage.sublevels``.

    Complexity: of all (piece, piece, piece) those are looked at that hold a hand, n^2 to n^2.5.

    Raises
    ------
    InputError:
        More than ``MOST_CELLS`` cells hold a hand.
    """
    frame = NearFrame.of(outline)
    free_space = FreeSpace.around(frame.outline_into(outline), hand)
    found = minima_in(free_space, workers)
    return Sublevels(
        outline=outline,
        hand=hand,
        births=found.births,
        merges=found.merges,
        into=found.into,
        contacts=frame.back(found.contacts),
    )


def minima_in(free_space: FreeSpace, workers: int = 1) -> Minima:
    """The same for a free space that has been cut already, of which discs' inner polygons have one.

    Raises
    ------
    InputError:
        More than ``MOST_CELLS`` cells hold a hand.
    """
    with ThreadPoolExecutor(max_workers=workers) as threads:
        cells = _cells_with_a_hand(free_space, threads)
        low, finger, slot, which, passes = _least_points(free_space, cells, threads)
        basins = basins_of(low, which, *passes)
        del which
        forest = least_forest(basins.of, len(basins.lowest), *passes)
        passes = Passes(*(column[forest] for column in passes))
        order = np.argsort(passes.sigma, kind="stable")
        ends = ends_of_basins(low, basins, *passes, order)
        return _counted(free_space, cells, low, finger, slot, basins, ends, threads)


def _least_points(free_space, cells, threads):
    pieces, z, worst = free_space.pieces, free_space.z, free_space.worst
    cap = _AT_CAP * free_space.cap
    m = pieces.total
    told = np.zeros((len(cells), 2), dtype=np.int8)
    fingers = range(cells.shape[1])
    lists = list(threads.map(lambda i: cells_by_piece(cells, m, i), fingers))
    parts = threads.map(
        lambda at: passes_from(pieces, z, lists[at[0]], told, *at, cap, worst),
        ((i, piece) for i in fingers for piece in range(m)),
    )
    passes = Passes(*(np.concatenate(column) for column in zip(*parts, strict=True)))
    low, which = least_passes(len(cells), *passes)
    low[(cells == cells[:, :1]).all(axis=1)] = 0.0
    finger = np.full(len(cells), -1, dtype=np.int8)
    slot = np.full(len(cells), -1, dtype=np.int32)
    walls = edges_that_lead_nowhere(pieces)
    isolated = np.flatnonzero((low == np.inf) & (told[:, 1] == 0))
    for i in fingers:
        for _ in threads.map(
            lambda piece: lower_at_walls(
                pieces, z, lists[i], told, walls, low, finger, slot, i, piece, worst
            ),
            range(m),
        ):
            pass
    least_of_isolated(pieces, z, cells, isolated, low, finger, slot, cap, worst)
    return low, finger, slot, which, passes


def _shared(
    threads: ThreadPoolExecutor, total: int, stretch: int, work: Callable[[int, int], Done]
) -> Iterator[Done]:
    """What comes of the stretches of a range, in order."""
    begins = range(0, total, stretch)
    return threads.map(work, begins, [min(begin + stretch, total) for begin in begins])


def _cells_with_a_hand(free_space: FreeSpace, threads: ThreadPoolExecutor) -> AnyArray:
    pieces = free_space.pieces
    extents = extents_of(pieces, free_space.z)
    parts: list[AnyArray] = []
    total = 0
    for part in _shared(
        threads, pieces.total, 1, lambda a, b: inhabited_cells(pieces, extents, a, b)
    ):
        parts.append(part)
        total += len(part)
        if total > MOST_CELLS:
            threads.shutdown(cancel_futures=True)
            raise InputError(
                f"{len(parts)} of the outline's {pieces.total} pieces have {total} cells that hold "
                f"a hand; up to {MOST_CELLS} in all are allowed here: simplify the outline"
            )
    return np.concatenate(parts)


def _counted(free_space, cells, low, finger, slot, basins, ends, threads):
    """Minima deeper than the depth cut, and no pinched hands."""
    lowest = basins.lowest
    births, merges = low[lowest], ends.merged
    cut = DEPTH_CUT * free_space.pieces.diameter
    kept = np.flatnonzero((births > 0.0) & (births < free_space.cap - cut))
    kept = kept[merges[kept] - births[kept] > cut]
    kept = kept[np.lexsort((merges[kept], births[kept]))]
    rows = np.full(len(lowest) + 1, -1)  # the last one is for minima that never merge
    # what swallows a minimum that counts is deeper and ends later, so it counts or is pinched
    rows[kept] = np.arange(len(kept))
    at = lowest[kept]
    held = cells[at]
    parts = list(_shared(
        threads, len(at), _STRETCH,
        lambda a, b: least_hands(
            free_space.pieces, free_space.z, held[a:b], finger[at[a:b]], slot[at[a:b]],
            free_space.cap, free_space.worst)))
    hands = np.concatenate(parts) if parts else np.empty((0, 4))
    d, w = hands[:, 0] + 1j * hands[:, 1], hands[:, 2] + 1j * hands[:, 3]
    fingers = d[:, None] + w[:, None] * free_space.hand.z
    contacts = np.stack([fingers.real, fingers.imag], axis=2) + free_space.origin
    return Minima(
        births[kept], merges[kept], rows[ends.elder[kept]], contacts, held.astype(np.int64)
    )
