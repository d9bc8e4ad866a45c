"""The answer to one question: how far may the hand open? Frozen value types."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, TypeAlias

import numpy as np

from icage.arrays import FloatArray
from icage.cells.solver import Search, Tree
from icage.hand import HandShape, Placement
from icage.outline import Outline

Verdict: TypeAlias = Literal["cage", "not_a_cage", "never_escapes"]


@dataclass(frozen=True, slots=True)
class GraspMinimum:
    """A local minimum of sigma: closing can end here. Lengths in the object's unit.

    ``contacts`` (3, 2) are the finger centres; ``free_fingers`` (of 1, 2, 3) touch nothing;
    ``plateau`` the two ends if the grasp can slide at constant sigma (opposing parallel edges).
    """

    id: int
    target: bool
    sigma: float
    contacts: FloatArray
    plateau: tuple[FloatArray, FloatArray] | None
    free_fingers: tuple[int, ...]
    joined_at: float
    """Level at which its basin joins the target's, [unit] (the target's own sigma for itself)."""

    @property
    def placement(self) -> Placement:
        """The grasp as a placement of the hand in the object's frame."""
        return Placement.from_contacts(self.contacts)


@dataclass(frozen=True, slots=True)
class Puncture:
    """A level at which the target's component meets another one. [Bunis2018, Sec. III-B]"""

    sigma: float
    kind: Literal["intermediate", "escape"]
    joins: tuple[int, ...]
    contacts: FloatArray
    free_fingers: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class CageWork:
    """What the search left behind, for queries and regions: internal to the planner.

    It lies in the frame near the object (``icage.frame.NearFrame``), not in the object's own.
    """

    search: Search
    tree: Tree
    minimum_node: tuple[int, ...]
    """Node of each grasp, by id."""
    sagitta: float = 0.0
    """How far the polygon searched may lie inside the true offset, [unit] (0 for points)."""
    remembered: dict[str, object] = field(default_factory=dict[str, object])
    """Point location and escape levels, built when first asked for (see membership)."""


@dataclass(frozen=True, slots=True)
class SearchStep:
    """One node that a search in contact space has met. [Bunis2018, Sec. VI]

    ``kind`` is "minimum" (least node of a convex region), "side" (a finger passes a vertex),
    "diagonal" (the third finger passes to the next piece of the plane), "wall" (a gluing seam),
    "tunnel" or "pinch". ``pair`` are the fingers (1..3) on ``edges``: edge q starts at vertex q of
    the ring without straight vertices.
    """

    sigma: float
    pair: tuple[int, int]
    edges: tuple[int, int]
    kind: str


@dataclass(frozen=True, slots=True)
class SearchLog:
    """How a search in contact space went."""

    iterations: tuple[SearchStep, ...]
    rectangles_explored: int
    rectangles_total: int
    nodes: int
    tunnel_edges_tried: int
    tunnel_edges_used: int


@dataclass(frozen=True, slots=True)
class Cage:
    """How far a hand on a target grasp may open. Levels in the object's unit.

    ``sigma_first`` is the first level at which closing may end elsewhere, ``sigma_max`` the one at
    which the object can escape (None: never). With disc fingers ``sigma_max`` and
    ``sigma_max_upper`` bracket the true value, and ``sigma_first`` is the smallest over several
    arc resolutions.
    """

    outline: Outline
    hand: HandShape
    finger_radius: float
    contacts: FloatArray
    verdict: Verdict
    why: str | None
    sigma_0: float
    sigma_first: float | None
    sigma_max: float | None
    sigma_max_upper: float | None = None
    sigma_first_upper: float | None = None
    sigma_first_converged: bool | None = None
    sigma_largest: float | None = None
    """Largest sigma in the target's component, for a hand that never escapes."""
    adjusted_by: float = 0.0
    """How far the contacts asked for were from the target, largest finger, [unit]."""
    punctures: tuple[Puncture, ...] = ()
    grasps: tuple[GraspMinimum, ...] = ()
    escape_path: FloatArray | None = None
    """(k, 4) = x, y, theta, sigma, from the target to a pinched hand."""
    min_finger_gap: float | None = None
    """Least distance between two finger centres on the path before its last, pinching segment."""
    warnings: tuple[str, ...] = ()
    search: SearchLog | None = field(default=None, repr=False, compare=False)
    """The course of the search, where the method keeps one (contact space)."""
    work: CageWork | None = field(default=None, repr=False, compare=False)
    """None for ``not_a_cage`` and for methods that cannot answer queries (contact space)."""

    @property
    def target_placement(self) -> Placement:
        """The target as a placement of the hand in the object's frame."""
        return Placement.from_contacts(self.contacts)


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
