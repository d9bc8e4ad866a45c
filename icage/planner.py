"""plan(): from an object and a target grasp to the cage. It alone checks what it is given."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Final, Literal, TypeAlias, cast

from numpy.typing import ArrayLike

from icage.cage import Cage
from icage.case import Case
from icage.cells.method import CELLS
from icage.checks import one_of
from icage.contacts import as_contacts
from icage.discs.on_curve import plan_discs
from icage.errors import InputError
from icage.geometry.near_frame import NearFrame
from icage.grasp import Grasp
from icage.hand import HandShape, Placement
from icage.library_faults import geometry_told
from icage.method import Method
from icage.outline import Outline

MethodName: TypeAlias = Literal["cells", "contact-space"]

METHODS: Final[tuple[MethodName, ...]] = ("cells", "contact-space")
"""The methods by the names that the command line gives them."""


@geometry_told()
def plan(
    case: Case | Outline | ArrayLike,
    grasp: Grasp | ArrayLike | None = None,
    finger_radius: float | None = None,
    method: MethodName | Method = CELLS,
) -> Cage:
    """How far the hand on a target grasp may open before the object can escape.

    Parameters
    ----------
    case:
        A case, or the object alone: an ``Outline`` or its vertices (n, 2).
    grasp:
        The target: a ``Grasp``, or finger centres (3, 2), counterclockwise, in the outline's unit.
        None for the case's own.
    finger_radius:
        [unit] Radius of the disc fingers, 0 for point fingers; None for the case's own (0 for a
        bare outline).
    method:
        "cells" (default, exact and fast) or "contact-space", the paper's I-CAGE; or an object that
        follows ``icage.method.Method``.

    Raises
    ------
    OutlineError:
        The vertices are no simple polygon with an area.
    GraspError:
        There is no grasp, the contacts are not three points on the outline (at the distance of the
        radius from it), the radius is no finite number of 0 or more, or a disc does not fit.
    HandError:
        The contacts are clockwise, collinear or coincident.
    InputError:
        There is no such method.

    Examples
    --------
    >>> triangle = [[0, 0], [1, 0], [0.5, 0.75**0.5]]
    >>> cage = plan(triangle, [[0.5, 0], [0.75, 0.1875**0.5], [0.25, 0.1875**0.5]])
    >>> cage
    <Cage: sigma 0.5 < 0.866025 <= 0.866025, 1 grasp>
    """
    asked = _asked(case, grasp, finger_radius)
    chosen = _method(method)
    outline, radius = asked.outline, asked.finger_radius
    hand = HandShape.from_contacts(asked.contacts)
    frame = NearFrame.of(outline)
    near, contacts = frame.outline_into(outline), frame.into(asked.contacts)
    if radius > 0.0:
        cage = plan_discs(near, hand, contacts, radius, chosen)
    else:
        cage = chosen.cage(near, hand, contacts, near, 0.0)
    cage = frame.cage_back(cage, outline)
    if isinstance(case, Case):
        return replace(cage, name=case.name, unit=case.unit)
    return cage


_UNNAMED: Final = "object"


def _asked(
    case: Case | Outline | ArrayLike, grasp: Grasp | ArrayLike | None, finger_radius: float | None
) -> Case:
    """What was asked for as one checked value."""
    if isinstance(grasp, Placement):
        raise InputError(
            "a Placement says where a hand stands and not its shape; plan() needs three finger "
            "centres (3, 2), such as HandShape.fingers(placement.as_array())"
        )
    contacts = grasp.contacts if isinstance(grasp, Grasp) else grasp
    if isinstance(case, Case):
        if contacts is None and finger_radius is None:
            return case
        radius = case.finger_radius if finger_radius is None else finger_radius
        target = case.contacts if contacts is None else as_contacts(contacts)
        return replace(case, target=target, finger_radius=radius)
    if isinstance(case, str | Path):
        raise InputError(f"plan() was given {str(case)!r}; icage.load reads names and files")
    outline = case if isinstance(case, Outline) else Outline(case)
    radius = 0.0 if finger_radius is None else finger_radius
    target = None if contacts is None else as_contacts(contacts)
    return Case(_UNNAMED, "m", outline, radius, target)


def _method(method: MethodName | Method) -> Method:
    if hasattr(method, "cage") and hasattr(method, "local_cage"):
        return cast(Method, method)
    if method == "cells":
        return CELLS
    if method == "contact-space":
        from icage.contact_space.method import CONTACT_SPACE  # only now: more kernels to load

        return CONTACT_SPACE
    one_of(method, METHODS, "method")
    raise AssertionError("every name has its method above")
