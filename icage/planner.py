"""plan(): from an outline and a target grasp to the cage. The front door of the planner."""

from __future__ import annotations

import numpy as np

from icage.arrays import FloatArray
from icage.cage import Cage, CageWork
from icage.errors import GeometryError
from icage.hand import HandShape
from icage.minima import escape_path, first_joining, grasps_and_punctures
from icage.outline import Outline
from icage.reach import largest_sigma_in
from icage.solver import Search, Terrain, Tree, merge_tree, search
from icage.target import Target, contacts_as_configuration, find_target
from icage.tolerance import DEPTH_CUT, NOT_A_CAGE
from icage.why import plateau_reason, why_not


def plan(outline: Outline, contacts: FloatArray, finger_radius: float = 0.0) -> Cage:
    """How far the hand on these contacts may open before the object can escape.

    Parameters
    ----------
    outline:
        The object.
    contacts:
        (3, 2), finger centres of the target grasp, counterclockwise, in the outline's unit.
    finger_radius:
        Radius of the disc fingers in the same unit; 0 for point fingers.

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
    if finger_radius > 0.0:
        from icage.disc_fingers import plan_discs

        return plan_discs(outline, hand, points, finger_radius)
    terrain = Terrain.around(outline, hand)
    target = find_target(terrain, contacts_as_configuration(terrain, points))
    return cage_on(terrain, points, target, outline)


def not_a_cage(
    outline: Outline, hand: HandShape, contacts: FloatArray, why: str, radius: float = 0.0
) -> Cage:
    """The answer for contacts that hold nothing."""
    sigma = float(np.hypot(*(contacts[1] - contacts[0])))
    return Cage(
        outline,
        hand,
        radius,
        contacts,
        "not_a_cage",
        why,
        sigma,
        sigma,
        sigma,
        sigma_max_upper=sigma if radius else None,
        sigma_first_upper=sigma if radius else None,
        sigma_first_converged=True if radius else None,
    )


def cage_on(
    terrain: Terrain,
    contacts: FloatArray,
    target: Target | None,
    outline: Outline,
    radius: float = 0.0,
    known: Search | None = None,
) -> Cage:
    """The cage of a target on the polygon of a terrain, whose fingers are points.

    ``known`` is the search from the target, where it has been made already.
    """
    hand = terrain.hand
    if target is None:
        return not_a_cage(outline, hand, contacts, why_not(terrain, contacts), radius)
    if target.plateau is not None:
        why = plateau_reason(target.plateau, terrain)
        return not_a_cage(outline, hand, contacts, why, radius)
    found = search(terrain, target.cell, target.sigma_0) if known is None else known
    if found.gave_up:
        raise GeometryError(f"the search gave up after {len(found.nodes)} cells")
    tree = merge_tree(found)
    grasps, punctures, nodes = grasps_and_punctures(found, tree, target)
    largest = largest_sigma_in(found) if found.never_escapes else None
    top = found.level if largest is None else largest
    if top / target.sigma_0 - 1.0 < NOT_A_CAGE:
        why = (
            "isolated: the hand can neither open nor close at these contacts"
            if largest is not None
            else f"no depth: the object escapes at once (sigma_max / sigma_0 - 1 = "
            f"{top / target.sigma_0 - 1.0:.2g})"
        )
        return not_a_cage(outline, hand, contacts, why, radius)
    size = terrain.pieces.diameter
    path, gap = escape_path(found, target) if found.escaped else (None, None)
    first = punctures[0].sigma if punctures else None
    return Cage(
        outline=outline,
        hand=hand,
        finger_radius=radius,
        contacts=grasps[0].contacts,
        verdict="cage" if found.escaped else "never_escapes",
        why=None,
        sigma_0=target.sigma_0,
        sigma_first=first,
        sigma_max=found.level if found.escaped else None,
        sigma_largest=largest,
        adjusted_by=target.moved * size,
        punctures=punctures,
        grasps=grasps,
        escape_path=path,
        min_finger_gap=gap,
        warnings=_cut_warnings(tree, found.level, size),
        work=CageWork(found, tree, nodes),
    )


def _cut_warnings(tree: Tree, escape: float, size: float) -> tuple[str, ...]:
    """Whether sigma_first hangs on the depth below which a minimum does not count."""
    fine = first_joining(tree, 1e-11 * size, escape)
    rough = first_joining(tree, 1e-6 * size, escape)
    chosen = first_joining(tree, DEPTH_CUT * size, escape)
    if fine == rough == chosen:
        return ()
    return (
        "sigma_first depends on how deep a minimum must be to count: "
        f"{fine:.9g} (1e-11 of the diameter), {chosen:.9g} (1e-10, used), {rough:.9g} (1e-6)",
    )
