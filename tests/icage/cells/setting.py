"""A random object cut into pieces, with a hand on it: what tests of single kernels stand on."""

from __future__ import annotations

import numpy as np
import shapely

from icage.cells.free_space import FreeSpace
from icage.cells.kernels.near import Hand
from icage.hand import HandShape
from icage.outline import Outline
from tests.oracles.targets import random_target


class Setting:
    """A random object with its pieces and a hand on it."""

    def __init__(self, seed: int, size: float = 1.0) -> None:
        self.rng = np.random.default_rng([seed, 23])
        target = random_target(self.rng, ["star", "random", "tool", "comb"][seed % 4])
        outline = Outline(size * target.vertices)
        self.space = FreeSpace.around(outline, HandShape.from_contacts(size * target.contacts))
        self.pieces, self.z, self.size = self.space.pieces, self.space.z, outline.diameter
        self.ring = outline.vertices - self.space.origin
        at = (size * target.contacts - self.space.origin) @ [1.0, 1j]
        self.hand = Hand(at[0].real, at[0].imag, (at[1] - at[0]).real, (at[1] - at[0]).imag)
        p = self.pieces
        self.corners = [
            np.column_stack([p.x[v], p.y[v]])
            for v in (p.slot_vertex[p.ptr[k] : p.ptr[k + 1]] for k in range(len(p.ptr) - 1))
        ]
        self.shapes = [shapely.Polygon(c) for c in self.corners]
        self.fingers = complex(*self.hand[:2]) + complex(*self.hand[2:]) * (self.z @ [1.0, 1j])
