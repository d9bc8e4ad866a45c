"""Minima of the true curve that a polygon may hide: solved next to the least points of its cells.

A shallow minimum beside an arc can vanish where chords or tangents stand for the arc. Its cell is
visited all the same, and the forces nearly balance at the least point of it. Our own.
"""

from __future__ import annotations

import numpy as np

from icage.cage import Cage
from icage.discs.critical import Critical, CriticalHands


def hidden_minima(critical: CriticalHands, cage: Cage, reach: float) -> list[Critical]:
    """Minima on the true curve next to cells of a cage, its listed ones among them.

    ``reach`` [unit] is how far the polygon may lie off the curve. None for methods without cells.
    """
    work = cage.work
    if work is None:
        return []
    top = np.inf if cage.sigma_max is None else cage.sigma_max
    hands = work.least_hands(top)
    return critical.minima_near(hands, reach) if len(hands) else []
