"""Computed steps and looks in one compiled loop, closing after closing.

Numba's cache on disk notices a change of the file that a loop is in, and of no other. What is
called here is written elsewhere, so the text of those files is part of what the loop is made of.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from icage.arrays import FloatArray, IntArray
from sim.closing import computed_step, look, near_edges
from sim.closing.computed_step import Plant, Room, copy_rows, goes_on, pressing, stand
from sim.closing.look import Bounds, Record, Shape, look_at
from sim.world import hand_in_object, machine_loops
from sim.world.machine_loops import borrowing


def _text() -> str:
    """A digest of the files that the loop calls."""
    digest = hashlib.sha256()
    for module in (computed_step, look, near_edges, hand_in_object, machine_loops):
        digest.update(Path(str(module.__file__)).read_bytes())
    return digest.hexdigest()


def _loop(text: str) -> Callable[..., None]:
    """The loop; ``text`` is in its closure, which the cache compares."""

    @borrowing
    def loop(
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
        if len(text) == 0:
            return
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

    compiled: Any = loop
    return compiled


_close_on = _loop(_text())


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
