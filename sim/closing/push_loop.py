"""Computed steps and looks in one compiled loop, closing after closing."""

from __future__ import annotations

import numpy as np

from icage.arrays import FloatArray, IntArray
from sim.closing.computed_step import Plant, Room, copy_rows, goes_on, pressing, stand
from sim.closing.look import Bounds, Record, Shape, look_at
from sim.world.machine_loops import borrowing


@borrowing
def _close_on(
    ids: IntArray,
    plant: Plant,
    room: Room,
    most: int,
    state: FloatArray,
    peak: FloatArray,
    shape: Shape,
    bounds: Bounds,
    record: Record,
    ahead: FloatArray,
    depth: FloatArray,
) -> None:  # pragma: no cover - compiled
    for i in ids:
        copy_rows(state[i], ahead)
        stands = False
        while goes_on(plant, room, most, bounds.stride, stands, ahead):
            copy_rows(ahead, state[i])
            peak[i] = max(peak[i], pressing(room))
            stand(plant, room, ahead[0])  # for the look and for the next step
            stands = True
            if not look_at(i, ahead[0], ahead[1], room.fingers, depth, shape, bounds, record):
                break


def close_on(
    ids: IntArray,
    plant: Plant,
    room: Room,
    most: int,
    state: FloatArray,
    peak: FloatArray,
    shape: Shape,
    bounds: Bounds,
    record: Record,
) -> None:
    """Close ``ids`` as far as steps can be computed and none has ended.

    ``goes_on`` and ``look_at`` in turn, each closing by itself. Updates ``state`` (N, 3, 6),
    ``peak`` (N,) and the record.
    """
    ahead, depth = np.empty((3, 6)), np.empty(3)
    _close_on(ids, plant, room, most, state, peak, shape, bounds, record, ahead, depth)
