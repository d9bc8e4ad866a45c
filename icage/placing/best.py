"""The placement of the open hand that may be off by most.

A hand whose fingers are each off by at most r keeps clear of the object if its clearance is at
least r, and its fingers then stand where straight motions lead that meet nothing: it is in the same
component. How large it is there is the only other question. [docs/theory.md, Sec. 11]
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import shapely

from icage.arrays import FloatArray, IntArray, read_only
from icage.cage import Cage
from icage.cells.membership import TARGET, query
from icage.cells.work import CageWork, work_of
from icage.checks import a_number, an_instance
from icage.errors import GeometryError, GraspError, InputError
from icage.geometry.near_frame import NearFrame
from icage.hand import HandShape, Placement
from icage.library_faults import geometry_told
from icage.placing.kernels.edges import near_edges
from icage.placing.kernels.search import Asked, Deepest, deepest
from icage.placing.turn_and_shift import TurnAndShift
from icage.tolerance import COLLISION, LEVEL, PLACE_GAP
from icage.values import Value

BOXES = 2_000_000
"""Boxes looked at before the search gives up: some seconds."""

_BELOW = 2.0 * LEVEL
"""[1] The largest size is this far (relative) below the level, which the set does not reach."""

_BALANCED = 1e-6
"""[1] Clearance and level that agree to this are in balance: the level is what limits both."""


@dataclass(frozen=True, slots=True, eq=False)
class BestPlacement(Value):
    """The placement in the guaranteed set whose fingers may each be off by most. Lengths [unit].

    Attributes
    ----------
    placement:
        Where the hand stands, in the object's frame.
    fingers:
        (3, 2) its finger centres.
    tolerance:
        r: if every finger is off by less than r, the hand is clear of the object and in the
        guaranteed set. The hand keeps its size, or, with ``opening_error``, errs in that, too.
    tolerance_upper:
        No placement of the set has a larger one: the search's certificate.
    clearance:
        Least distance of a finger from the object (from its disc's edge).
    limited_by:
        "clearance", or "level" where the opening may err and that is what limits it.
    level:
        The level of the set: sigma_first, with friction that of ``mu``. None if there is none.
    mu:
        [1] The coefficient of friction.
    opening:
        The size that was asked for; None if it was to be chosen.
    opening_error:
        Whether the hand's size may err as its fingers do.
    boxes:
        How many boxes the search has looked at.
    """

    placement: Placement
    fingers: FloatArray
    tolerance: float
    tolerance_upper: float
    clearance: float
    limited_by: Literal["clearance", "level"]
    level: float | None
    mu: float
    opening: float | None
    opening_error: bool
    turn_and_shift: TurnAndShift = field(compare=False, repr=False)
    """What turn and shift the hand bears as a rigid body, at its own size: more than the tolerance
    says, which holds for any error of its fingers."""
    boxes: int = field(compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "fingers", read_only(np.array(self.fingers, dtype=np.float64)))


@geometry_told()
def place(
    cage: Cage,
    mu: float = 0.0,
    opening: float | None = None,
    opening_error: bool = False,
    gap: float = PLACE_GAP,
    largest: float = math.inf,
) -> BestPlacement:
    """Where to put the open hand, and how far each finger may be off.

    Parameters
    ----------
    cage:
        Planned by the cells.
    mu:
        [1] Coulomb's coefficient at the fingers: the set is then the one below
        ``cage.friction(mu).sigma_first``.
    opening:
        [unit] The size sigma of the open hand; None: the one that leaves most room is chosen.
    opening_error:
        Whether the size may err as the fingers do. If not, the hand is off as a rigid body, and
        the level costs nothing.
    gap:
        [1] How much larger (relative) a tolerance may be that the search has not excluded.
    largest:
        [unit] The hand opens no further than this.

    Raises
    ------
    GraspError:
        Not a cage, or no hand of the set keeps clear of the object.
    InputError:
        An opening that the set does not have; a coefficient that is negative or no number.
    MethodError:
        The cage was planned by the contact space: plan it by the cells.

    Notes
    -----
    A few ms for simple objects, up to 0.1 s for the shipped tools. After two million boxes the
    search ends; ``tolerance_upper`` then says how far it got.

    Examples
    --------
    >>> from icage.planner import plan
    >>> cage = plan(
    ...     [[0, 0], [1, 0], [0.5, 0.75**0.5]],
    ...     [[0.5, 0], [0.75, 0.1875**0.5], [0.25, 0.1875**0.5]],
    ... )
    >>> best = place(cage, opening=0.8)
    >>> round(best.tolerance, 4), best.limited_by
    (0.1732, 'clearance')
    """
    an_instance(cage, Cage, "cage", "; icage.plan makes one")
    work = work_of(cage)
    if work is None:
        raise GraspError(f"there is nothing to place a hand for: not a cage, {cage.why}")
    if not 0.0 < a_number(gap, "gap") < 1.0:
        raise InputError(f"gap {gap}; a number between 0 and 1 is needed")
    level = cage.sigma_guaranteed if mu == 0.0 else cage.friction(mu).sigma_first
    if level is not None and level <= cage.sigma_0:
        raise GraspError(
            "no placement is good: closing ends in the target by an exact fit only (a wedge)"
        )
    size = _opening(cage, level, opening)
    if largest != math.inf:
        largest = a_number(largest, "largest")
    an_instance(opening_error, bool, "opening_error")
    if not largest > cage.sigma_0:
        raise InputError(f"largest {largest:g}; above sigma_0 = {cage.sigma_0:.9g} is needed")
    found = _deepest(cage, work, level, size, opening_error, gap, largest)
    floor = COLLISION * cage.outline.diameter
    if not found.value > floor:
        if found.bound > floor * (1.0 + gap) and found.boxes >= BOXES:
            raise GeometryError(f"no placement found in {found.boxes} boxes of hands")
        raise GraspError(
            f"no hand of the guaranteed set{'' if size is None else f' at opening {size:g}'} keeps "
            f"clear of the object by more than {COLLISION:g} diameters"
        )
    return _answer(cage, work, found, level, float(mu), size, opening_error)


def _opening(cage: Cage, level: float | None, opening: float | None) -> float | None:
    """The size asked for, checked."""
    if opening is None:
        return None
    size = a_number(opening, "opening")
    top = cage.sigma_largest if level is None else level
    if not cage.sigma_0 < size < (np.inf if top is None else top):
        raise InputError(
            f"opening {size:g}; above sigma_0 = {cage.sigma_0:.9g} and below "
            f"{'the largest size' if level is None else 'the level'} {top:.9g} is allowed"
        )
    return size


def _deepest(
    cage: Cage, work: CageWork, level: float | None, size: float | None, errs: bool, gap: float,
    largest: float,
) -> Deepest:  # fmt: skip
    """The search's answer, in the frame of the pieces."""
    free_space = work.search.free_space
    pieces, z = free_space.pieces, free_space.z
    bound = np.inf if level is None else level * (1.0 - _BELOW)
    top = min(bound, free_space.cap, largest) if size is None else size
    cells, least = _cells(cage, work, top, cage.sigma_0 if size is None else size)
    edges = _edges(NearFrame.of(cage.outline).into(cage.outline.vertices) - free_space.origin)
    asked = Asked(
        arm=z - z.mean(axis=0),
        edges=edges,
        near=near_edges(pieces, edges),
        radius=cage.finger_radius,
        size=cage.outline.diameter,
        least=cage.sigma_0 if size is None else size,
        top=top,
        level=bound,
        share=_around(cage.hand) if errs and np.isfinite(bound) else 0.0,
        gap=gap,
        floor=COLLISION * cage.outline.diameter,
    )
    return deepest(pieces, z, cells, least, asked, BOXES)


def _cells(cage: Cage, work: CageWork, top: float, low: float) -> tuple[IntArray, FloatArray]:
    """Cells of the set up to a size, and the least size (n,) that its hands have in each."""
    found = work.search
    reached = found.node_level
    if work.polygon_first is None:
        first = np.inf if cage.sigma_first is None else cage.sigma_first
        use = np.flatnonzero((reached <= top) & (reached < first))
        # a smaller hand of such a cell is not joined to the target at its own size
        least = np.maximum(low, reached[use])
    else:  # as for a query: chords may have minima that the true curve does not have
        use = np.flatnonzero(reached < work.polygon_first * (1.0 - LEVEL))
        least = np.full(len(use), low)
    return np.ascontiguousarray(found.cells[use]), np.minimum(least, top)


def _edges(ring: FloatArray) -> FloatArray:
    """Start, unit direction and length of the edges of a ring; those of no length left out."""
    side = np.roll(ring, -1, axis=0) - ring
    length = np.hypot(side[:, 0], side[:, 1])
    rows = np.column_stack([ring, side / np.where(length > 0.0, length, 1.0)[:, None], length])
    return np.ascontiguousarray(rows[length > 0.0])


def _answer(
    cage: Cage, work: CageWork, found: Deepest, level: float | None, mu: float,
    size: float | None, errs: bool,
) -> BestPlacement:  # fmt: skip
    """The placement in the object's frame, its fingers looked at anew."""
    frame = NearFrame.of(cage.outline)
    x, y, theta, sigma = found.hand.tolist()
    w = sigma * np.exp(1j * theta)
    hand = complex(x, y) + w * (cage.hand.z - cage.hand.z.mean())
    fingers = np.column_stack([hand.real, hand.imag]) + work.search.free_space.origin
    fingers = frame.back(fingers)
    turned = float(np.angle(w))
    placement = Placement(float(fingers[0, 0]), float(fingers[0, 1]), turned, float(sigma))
    if query(cage, placement.as_array()[None]).verdict[0] != TARGET:
        raise GeometryError(f"the best placement {placement} is not in the guaranteed set")
    capped = errs and level is not None
    room = _around(cage.hand) * (level - sigma) if capped and level is not None else np.inf
    clear = found.value if room > found.value else _clearance(cage, fingers)
    return BestPlacement(
        placement=placement,
        fingers=fingers,
        tolerance=float(found.value),
        tolerance_upper=float(found.bound),
        clearance=float(clear),
        limited_by="level" if clear >= room * (1.0 - _BALANCED) else "clearance",
        level=level,
        mu=mu,
        opening=size,
        opening_error=bool(errs),
        turn_and_shift=TurnAndShift(cage.outline.vertices, fingers, cage.finger_radius),
        boxes=int(found.boxes),
    )


def _around(hand: HandShape) -> float:
    """Radius of the least circle round the unit hand: fingers that are off by r, the shape kept,
    change the hand's size by r over it at most.
    """
    fingers = np.column_stack([hand.z.real, hand.z.imag])
    return float(shapely.minimum_bounding_radius(shapely.MultiPoint(fingers)))


def _clearance(cage: Cage, fingers: FloatArray) -> float:
    """Least distance of the finger centres from the outline, less their radius."""
    from icage.kernels.locate import depth_inside

    return float(-depth_inside(cage.outline.vertices, fingers, cage.finger_radius).max())
