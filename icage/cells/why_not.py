"""Why a set of contacts is no cage: a sentence for the user, from the mechanics of the grasp."""

from __future__ import annotations

import numpy as np

from icage.arrays import FloatArray
from icage.cells.kernels.tree import births
from icage.cells.solver import Configuration, Terrain
from icage.cells.target import cells_near, contacts_as_configuration
from icage.geometry.statics import ISOLATED, contacts_reason, slide_reason
from icage.tolerance import CONTACT_OFF


def why_not(terrain: Terrain, contacts: FloatArray) -> str:
    """The reason that the contacts are no strict local minimum of sigma."""
    here = contacts_as_configuration(terrain, contacts)
    size = terrain.pieces.diameter
    cells = cells_near(terrain, here, CONTACT_OFF * size)
    if len(cells):
        value, _ = births(terrain.pieces, terrain.z, cells, terrain.cap, terrain.worst)
        reachable = np.isfinite(value[:, 0]).any()
    else:
        reachable = False
    if not reachable:
        return ISOLATED
    return contacts_reason(terrain.outline, contacts)


def plateau_reason(ends: tuple[Configuration, Configuration], terrain: Terrain) -> str:
    """The sentence for a target on a plateau."""
    return slide_reason(abs(ends[1].d - ends[0].d), terrain.pieces.diameter)
