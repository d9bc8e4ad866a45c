"""All minima of sigma for one hand and where they merge, by the cells' method. Our own.

The counterpart of ``icage.contact_space.sublevel``: two ways to one diagram.
[docs/decisions/0014-whole-sublevels.md]
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import NamedTuple, TypeVar

import numpy as np

from icage.arrays import AnyArray, FloatArray, IntArray
from icage.cells.free_space import FreeSpace
from icage.cells.kernels.basins import (
    Basins,
    Ends,
    basins_of,
    ends_of_basins,
    least_forest,
)
from icage.cells.kernels.inhabited import extents_of, inhabited_cells
from icage.cells.kernels.whole import (
    EMPTY,
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
"""Hands that a thread takes at a time: some 10 ms."""

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
        low = _least_points(free_space, cells, threads)
        basins = basins_of(low.sigma, low.least, *low.passes)
        ends = threads.submit(_ends, low, basins)
        held = _held(free_space, cells, low, basins, threads)
    return _counted(free_space, held, ends.result())


class _LeastPoints(NamedTuple):
    """Least sigma (n,) of all cells, and where.

    ``finger`` and ``slot`` (n,): the edge of its piece that the finger is on; -1 where the least
    point is on a pass, or is a pinched hand. ``least`` (n,) is the least of the cell's ``passes``.
    """

    sigma: FloatArray
    finger: AnyArray
    slot: AnyArray
    least: AnyArray
    passes: Passes


class _Held(NamedTuple):
    """Basins whose least point is a hand below the cap: basin and sigma (b,), cell, hand (b, 4)."""

    basin: IntArray
    sigma: FloatArray
    cell: AnyArray
    hand: FloatArray


def _least_points(
    free_space: FreeSpace, cells: AnyArray, threads: ThreadPoolExecutor
) -> _LeastPoints:
    pieces, z, worst = free_space.pieces, free_space.z, free_space.worst
    cap = _AT_CAP * free_space.cap
    m, fingers = pieces.total, range(len(z))
    told = np.zeros((len(cells), 2), dtype=np.int8)
    lists = list(threads.map(partial(cells_by_piece, cells, m), fingers))

    def passes_of(finger: int, piece: int) -> Passes:
        return passes_from(pieces, z, lists[finger], told, finger, piece, cap, worst)

    every = np.indices((len(z), m)).reshape(2, -1).tolist()
    parts = threads.map(passes_of, *every)
    passes = Passes(*(np.concatenate(column) for column in zip(*parts, strict=True)))
    sigma, least = least_passes(len(cells), *passes)
    isolated = np.flatnonzero((sigma == np.inf) & (told[:, EMPTY] == 0))
    sigma[(cells == cells[:, :1]).all(axis=1)] = 0.0
    at = np.full(len(cells), -1, dtype=np.int8), np.full(len(cells), -1, dtype=np.int32)
    walls = edges_that_lead_nowhere(pieces)

    def lower(finger: int, piece: int) -> None:
        lower_at_walls(pieces, z, lists[finger], told, walls, sigma, *at, finger, piece, worst)

    for finger in fingers:  # one after the other: a cell has one piece for each
        list(threads.map(partial(lower, finger), range(m)))
    least_of_isolated(pieces, z, cells, isolated, sigma, *at, cap, worst)
    return _LeastPoints(sigma, *at, least, passes)


def _ends(low: _LeastPoints, basins: Basins) -> Ends:
    forest = least_forest(basins.of, len(basins.lowest), *low.passes)
    passes = Passes(*(column[forest] for column in low.passes))
    order = np.argsort(passes.sigma, kind="stable")
    return ends_of_basins(low.sigma, basins, *passes, order)


def _held(
    free_space: FreeSpace,
    cells: AnyArray,
    low: _LeastPoints,
    basins: Basins,
    threads: ThreadPoolExecutor,
) -> _Held:
    births = low.sigma[basins.lowest]
    top = free_space.cap - DEPTH_CUT * free_space.pieces.diameter
    basin = np.flatnonzero((births > 0.0) & (births < top))
    at = basins.lowest[basin]
    cell, finger, slot = cells[at], low.finger[at], low.slot[at]

    def hands(first: int, last: int) -> FloatArray:
        return least_hands(
            free_space.pieces, free_space.z, cell[first:last], finger[first:last],
            slot[first:last], free_space.cap, free_space.worst,
        )  # fmt: skip

    parts = _shared(threads, len(at), _STRETCH, hands)
    return _Held(basin, births[basin], cell, np.concatenate([np.empty((0, 4)), *parts]))


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


def _counted(free_space: FreeSpace, held: _Held, ends: Ends) -> Minima:
    """Minima deeper than the depth cut, and no pinched hands."""
    births, merges = held.sigma, ends.merged[held.basin]
    kept = np.flatnonzero(merges - births > DEPTH_CUT * free_space.pieces.diameter)
    kept = kept[np.lexsort((merges[kept], births[kept]))]
    rows = np.full(len(ends.merged) + 1, -1)  # the last one is for minima that never merge
    # what swallows a minimum that counts is deeper and ends later, so it counts or is pinched
    rows[held.basin[kept]] = np.arange(len(kept))
    hands = held.hand[kept]
    d, w = hands[:, 0] + 1j * hands[:, 1], hands[:, 2] + 1j * hands[:, 3]
    fingers = d[:, None] + w[:, None] * free_space.hand.z
    contacts = np.stack([fingers.real, fingers.imag], axis=2) + free_space.origin
    into = rows[ends.elder[held.basin[kept]]]
    return Minima(births[kept], merges[kept], into, contacts, held.cell[kept].astype(np.int64))
