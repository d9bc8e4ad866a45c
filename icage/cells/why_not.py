"""Why a set of contacts is no cage: a sentence for the user, from the mechanics of the grasp."""

from __future__ import annotations

import numpy as np

from icage.arrays import FloatArray
from icage.cells.free_space import Configuration, FreeSpace
from icage.cells.kernels.columns import BIRTH_SIGMA
from icage.cells.kernels.tree import births
from icage.cells.target import cells_near, contacts_as_configuration
from icage.geometry.statics import ISOLATED, contacts_reason, slide_reason
from icage.tolerance import CONTACT_OFF


def why_not(free_space: FreeSpace, contacts: FloatArray) -> str:
    """The reason that the contacts are no strict local minimum of sigma."""
    here = contacts_as_configuration(free_space, contacts)
    size = free_space.pieces.diameter
    cells = cells_near(free_space, here, CONTACT_OFF * size)
    if len(cells):
        born = births(free_space.pieces, free_space.z, cells, free_space.cap, free_space.worst)
        reachable = np.isfinite(born.value[:, BIRTH_SIGMA]).any()
    else:
        reachable = False
    if not reachable:
        return ISOLATED
    return contacts_reason(free_space.outline, contacts)


def plateau_reason(ends: tuple[Configuration, Configuration], free_space: FreeSpace) -> str:
    """The sentence for a target on a plateau."""
    return slide_reason(abs(ends[1].d - ends[0].d), free_space.pieces.diameter)
