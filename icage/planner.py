"""plan(): from an outline and a target grasp to the cage. The front door of the planner."""

from __future__ import annotations

import numpy as np

from icage.arrays import FloatArray
from icage.cage import Cage
from icage.cells.method import CELLS
from icage.discs.brackets import plan_discs
from icage.frame import NearFrame
from icage.hand import HandShape
from icage.method import Engine
from icage.outline import Outline


def plan(
    outline: Outline, contacts: FloatArray, finger_radius: float = 0.0, engine: Engine = CELLS
) -> Cage:
    """How far the hand on these contacts may open before the object can escape.

    Parameters
    ----------
    outline:
        The object.
    contacts:
        (3, 2), finger centres of the target grasp, counterclockwise, in the outline's unit.
    finger_radius:
        Radius of the disc fingers in the same unit; 0 for point fingers.
    engine:
        The method: cells (default) or ``icage.contact_space.CONTACT_SPACE``, the paper's.

    Raises
    ------
    HandError:
        The contacts are clockwise, collinear or coincident.
    GraspError:
        With discs: the contacts cannot be reached by fingers of this radius.

    Examples
    --------
    >>> triangle = Outline([[0, 0], [1, 0], [0.5, 0.75**0.5]])
    >>> cage = plan(triangle, [[0.5, 0], [0.75, 0.1875**0.5], [0.25, 0.1875**0.5]])
    >>> cage.verdict, round(cage.sigma_0, 9), round(cage.sigma_max, 9)
    ('cage', 0.5, 0.866025404)
    """
    points = np.asarray(contacts, dtype=np.float64)
    hand = HandShape.from_contacts(points)
    frame = NearFrame.of(outline)
    near, points = frame.outline_into(outline), frame.into(points)
    if finger_radius > 0.0:
        cage = plan_discs(near, hand, points, finger_radius, engine)
    else:
        cage = engine.cage(near, hand, points, near, 0.0)
    return frame.cage_back(cage, outline)
