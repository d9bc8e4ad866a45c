"""sublevels(): all minima of one hand shape round an object, and the levels at which they merge."""

from __future__ import annotations

import os

from numpy.typing import ArrayLike

from icage.case import Case
from icage.cells.sublevels import sublevels_of
from icage.checks import a_count, an_instance
from icage.errors import HandError, InputError
from icage.hand import HandShape
from icage.library_faults import geometry_told
from icage.minima import Sublevels
from icage.outline import Outline


@geometry_told()
def sublevels(
    case: Case | Outline | ArrayLike, hand: HandShape | None = None, *, workers: int | None = None
) -> Sublevels:
    """All local minima of sigma of a hand shape, and where each merges with a deeper one. Our own.

    The whole of which a plan is the part round one target: every grasp in which closing this hand
    can end, two-finger grasps and plateaus included, and how far each may open. For point fingers.

    Parameters
    ----------
    case:
        A case, or the object alone: an ``Outline`` or its vertices (n, 2).
    hand:
        Shape of the hand; None for that of the case's grasp.
    workers:
        Threads; None for as many as there are cores. The answer does not depend on it.

    Raises
    ------
    OutlineError:
        The vertices are no simple polygon with an area.
    GraspError:
        No hand is given and the case has no grasp yet.
    HandError:
        No hand is given with a bare outline.
    InputError:
        The case has disc fingers, the hand is no ``HandShape``, ``workers`` no count, or the
        outline has so many vertices that the answer would take more than 1 GB.

    Notes
    -----
    Seconds for 300 vertices. [docs/decisions/0014-whole-sublevels.md]

    Examples
    --------
    >>> triangle = [[0, 0], [1, 0], [0.5, 0.75**0.5]]
    >>> found = sublevels(triangle, HandShape.from_angles_deg(60, 120))
    >>> found
    <Sublevels: 3 minima, sigma 0.5 to 0.5>
    >>> found.merges.round(6).tolist(), found.into.tolist()
    ([0.866025, 0.866025, 0.866025], [-1, -1, -1])
    """
    threads = _cores() if workers is None else a_count(workers, "workers")
    if isinstance(case, Case):
        if case.finger_radius > 0.0:
            raise InputError(
                f"{case.name} has fingers of radius {case.finger_radius:g}; sublevels() is for "
                "point fingers: give it the outline and a hand"
            )
        outline, shape = case.outline, case.hand if hand is None else hand
    else:
        outline, shape = case if isinstance(case, Outline) else Outline(case), hand
        if shape is None:
            raise HandError("sublevels() of a bare outline needs a HandShape; none was given")
    an_instance(shape, HandShape, "hand", "; HandShape.from_contacts makes one of contacts")
    return sublevels_of(outline, shape, threads)


def _cores() -> int:
    """Cores that this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # macOS, Windows
        return os.cpu_count() or 1
