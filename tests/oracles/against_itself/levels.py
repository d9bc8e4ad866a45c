"""The levels of one target on one polygon: the only place where the sweeps touch the planner."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from icage.cells.free_space import FreeSpace, search
from icage.cells.target import contacts_as_configuration, find_target
from icage.discs.offsets import directions_on_arcs, offsets
from icage.hand import HandShape
from icage.outline import Outline

Floats = NDArray[np.float64]


class Levels(NamedTuple):
    """sigma_0, sigma_first, sigma_max of a target, [unit]; inf: never; nan: no strict minimum."""

    sigma_0: float
    sigma_first: float
    sigma_max: float

    @property
    def opening(self) -> float:
        """sigma_max / sigma_0, [1]."""
        return self.sigma_max / self.sigma_0


def levels(
    vertices: Floats, contacts: Floats, *, merge: bool, reach: float | None = None
) -> Levels:
    """Levels on convex pieces (``merge``) or on the raw triangles of the plane round the polygon.

    ``reach`` [diameter] is how far the minimum may be from the contacts: None for the planner's
    own limit, more where the polygon stands in for a curve.
    """
    free_space = FreeSpace.around(Outline(vertices), HandShape.from_contacts(contacts), merge=merge)
    wanted = contacts_as_configuration(free_space, contacts)
    if reach is None:
        target = find_target(free_space, wanted)
    else:
        target = find_target(free_space, wanted, reach=reach, turn=max(1e-3, 10.0 * reach))
    if target is None or target.plateau is not None:
        return Levels(np.nan, np.nan, np.nan)
    found = search(free_space, target.cell, target.sigma_0)
    if found.gave_up:
        raise RuntimeError("the search gave up")
    return Levels(target.sigma_0, found.sigma_first(), found.level)


def grown(
    vertices: Floats, contacts: Floats, radius: float, segments: int
) -> tuple[Floats, Floats, float]:
    """Inner and outer polygon round the true offset, and the reach [diameter] to look with."""
    outline = Outline(vertices)
    through = directions_on_arcs(outline, radius, contacts)
    both = offsets(outline, radius, segments, through)
    chord = np.pi * radius / segments / outline.diameter if through else 0.0
    return both.inner.vertices, both.outer.vertices, max(1e-5, chord)


def difference(a: Levels, b: Levels) -> float:
    """Largest relative difference of the two ratios to sigma_0; inf if a verdict differs."""
    worst = 0.0
    for one, other in ((a.sigma_first, b.sigma_first), (a.sigma_max, b.sigma_max)):
        x, y = one / a.sigma_0, other / b.sigma_0
        if np.isfinite(x) and np.isfinite(y):
            worst = max(worst, abs(x - y) / x)
        elif np.isnan(x) != np.isnan(y) or np.isinf(x) != np.isinf(y):
            return np.inf
    return worst
