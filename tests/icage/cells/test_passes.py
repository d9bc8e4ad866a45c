"""Passes against double-double: none is lost to a box, and doubles are as good as they say."""

from __future__ import annotations

import numpy as np
import pytest

from icage.cells.free_space import FreeSpace
from icage.cells.kernels.boxes import out_of_reach
from icage.cells.kernels.careful import pass_careful
from icage.cells.kernels.facet import facet_of
from icage.cells.kernels.min_norm import FOUND, INFEASIBLE, UNSURE
from icage.cells.kernels.passes import new_room, pass_fast
from icage.discs.offsets import offsets
from icage.hand import HandShape
from icage.kernels.compiled import machine_code_at_once
from icage.outline import Outline
from icage.tolerance import PASS_ERROR


def _hand(rng: np.random.Generator) -> HandShape:
    while True:
        z = complex(rng.uniform(-1.5, 2.5), rng.uniform(0.05, 2.0))
        if min(abs(z), abs(z - 1.0)) > 0.2:
            return HandShape(z)


def _outline(rng: np.random.Generator, kind: str) -> Outline:
    n = 16
    angle = (np.arange(n) + rng.uniform(0.1, 0.9, n)) * 2.0 * np.pi / n
    radius = rng.uniform(0.4, 1.0, n)
    outline = Outline(np.column_stack([radius * np.cos(angle), radius * np.sin(angle)]))
    # the chords of grown corners make slivers, where rounding matters most
    return outline if kind == "star" else offsets(outline, 0.05, 6).inner


@pytest.mark.parametrize("kind", ["star", "grown"])
@pytest.mark.parametrize("seed", range(3))
def test_doubles_and_boxes_say_nothing_that_is_not_so(kind: str, seed: int) -> None:
    """A facet out of reach is empty, and a value in doubles is as near as its bound promises."""
    machine_code_at_once()
    rng = np.random.default_rng(seed)
    space = FreeSpace.around(_outline(rng, kind), _hand(rng))
    pieces, room, worst = space.pieces, new_room(), PASS_ERROR * space.pieces.scale
    empty, told, found, off = 0, 0, 0, 0.0
    for _ in range(1500):
        cell = rng.integers(0, pieces.total, 3)
        finger = int(rng.integers(3))
        slot = int(rng.integers(pieces.ptr[cell[finger]], pieces.ptr[cell[finger] + 1]))
        facet = facet_of(pieces, cell, finger, slot)
        cap = space.cap * rng.choice([1.0, 0.3])
        careful = pass_careful(pieces, space.z, facet, cap, 0.0)
        fast = pass_fast(pieces, space.z, facet, cap, worst, room)
        sigma = np.hypot(careful.w_x, careful.w_y) if careful.status == FOUND else np.inf
        if sigma > cap:
            empty += 1
            told += out_of_reach(pieces, space.z, facet, cap)
            assert fast.status in (INFEASIBLE, UNSURE) or np.hypot(fast.w_x, fast.w_y) > cap - worst
            continue
        assert not out_of_reach(pieces, space.z, facet, cap)
        assert fast.status != INFEASIBLE
        if fast.status == FOUND:
            found += 1
            off = max(off, abs(np.hypot(fast.w_x, fast.w_y) - sigma))
    assert found > 50  # what was compared
    assert told > 0.6 * empty > 60
    assert off <= worst
