"""The answer to one question: how far may the hand open? Frozen value types."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Literal, cast, overload

import numpy as np
import shapely
from numpy.typing import ArrayLike

from icage.arrays import FloatArray, read_only
from icage.checks import a_number, a_path, one_of
from icage.errors import PlacementError
from icage.geometry.way_out import free_from
from icage.hand import HandShape, Placement
from icage.outline import Outline
from icage.search_log import SearchLog
from icage.values import Value

if TYPE_CHECKING:
    from icage.brink import Brink
    from icage.cells.membership import Answers, PlacementAnswer
    from icage.cells.work import CageWork
    from icage.friction.levels import FrictionLevel, JamTolerance
    from icage.shelf import Shelf
    from icage.wedge import Wedge


class CageStatus(StrEnum):
    """What a plan has found; the contract calls it the verdict. [docs/formats.md, icage plan]"""

    CAGE = "cage"
    NOT_A_CAGE = "not_a_cage"
    """The contacts hold nothing; ``why`` says why."""
    NEVER_ESCAPES = "never_escapes"
    """However far the hand opens, the object stays in it."""


def _freeze(value: object, *names: str) -> None:
    """Give a value read-only copies of its arrays, so that its hash cannot change."""
    for name in names:
        array = getattr(value, name)
        if array is not None and array.flags.writeable:
            object.__setattr__(value, name, read_only(array.copy()))


@dataclass(frozen=True, slots=True, eq=False)
class GraspMinimum(Value):
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

    def __post_init__(self) -> None:
        _freeze(self, "contacts")

    @property
    def placement(self) -> Placement:
        """The grasp as a placement of the hand in the object's frame."""
        return Placement.from_contacts(self.contacts)


@dataclass(frozen=True, slots=True, eq=False)
class Puncture(Value):
    """A level at which the target's component meets another one. [Bunis2018, Sec. III-B]"""

    sigma: float
    kind: Literal["intermediate", "escape"]
    joins: tuple[int, ...]
    contacts: FloatArray
    free_fingers: tuple[int, ...]

    def __post_init__(self) -> None:
        _freeze(self, "contacts")


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Cage(Value):
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
    status: CageStatus
    why: str | None
    sigma_0: float
    sigma_first: float | None
    sigma_max: float | None
    sigma_max_upper: float | None = None
    sigma_max_lower: float | None = None
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
    name: str = ""
    """Of the case that was planned; empty for a bare outline."""
    unit: str = ""
    """Of all lengths; empty if nobody said."""

    def __post_init__(self) -> None:
        _freeze(self, "contacts", "escape_path")

    @property
    def target_placement(self) -> Placement:
        """The target as a placement of the hand in the object's frame."""
        return Placement.from_contacts(self.contacts)

    @overload
    def query(self, placements: Placement) -> PlacementAnswer: ...

    @overload
    def query(self, placements: ArrayLike) -> PlacementAnswer | Answers: ...

    def query(self, placements: Placement | ArrayLike) -> PlacementAnswer | Answers:
        """Is the object caged by a hand that stands here? See ``icage.cells.membership``.

        Parameters
        ----------
        placements:
            One placement (a ``Placement`` or four numbers x, y, theta [rad], sigma) or rows (n, 4)
            of them, in the object's frame and unit.

        Returns
        -------
        PlacementAnswer for one placement, Answers for rows.

        Raises
        ------
        PlacementError:
            Numbers that are not finite, a negative sigma, another shape.
        MethodError:
            The cage was planned by the contact space: plan it by the cells.

        Examples
        --------
        >>> from icage.planner import plan
        >>> cage = plan(
        ...     [[0, 0], [1, 0], [0.5, 0.75**0.5]],
        ...     [[0.5, 0], [0.75, 0.1875**0.5], [0.25, 0.1875**0.5]],
        ... )
        >>> cage.query(cage.target_placement).verdict
        <PlacementClass.TARGET: 'target'>
        >>> cage.query([5.0, 5.0, 0.0, 0.5]).verdict == "escapes"
        True
        """
        from icage.cells.membership import query

        if isinstance(placements, Placement):
            return query(self, placements.as_array()[None, :])[0]
        try:
            rows = np.asarray(placements, dtype=np.float64)
        except (TypeError, ValueError) as error:
            raise PlacementError(
                f"placements are a {type(placements).__name__}; numbers x, y, theta, sigma or rows "
                "of them are needed"
            ) from error
        return query(self, rows[None, :])[0] if rows.shape == (4,) else query(self, rows)

    def regions(
        self,
        level: float | Literal["sigma_max", "sigma_first"] = "sigma_max",
        *,
        bound: Literal["inner", "outer"] = "inner",
        gap: float = 1e-3,
    ) -> tuple[shapely.MultiPolygon, ...]:
        """Where each finger may be while the hand stays below a level; [0] is finger 1.

        Parameters
        ----------
        level:
            "sigma_max" (all of the cage), "sigma_first" (the guaranteed set) or a size [unit].
        bound:
            "inner": certainly in the region, the safe side, the one to draw and to aim at. "outer":
            nothing of the region lies outside it.
        gap:
            [1] Wanted relative difference of area between the two bounds.

        Raises
        ------
        InputError:
            The level is not between sigma_0 and sigma_max, or the gap not in (0, 1).
        MethodError:
            The cage was planned by the contact space: plan it by the cells.
        """
        from icage.cells.regions import caging_regions

        one_of(bound, ("inner", "outer"), "bound")
        a_number(gap, "gap")
        found = caging_regions(self, self._level(level), gap)
        return tuple(region.geometry for region in found if region.bound == bound)

    def _level(self, level: float | str) -> float | None:
        if isinstance(level, str):
            one_of(level, ("sigma_max", "sigma_first"), "level")
            return self.sigma_first if level == "sigma_first" else self.sigma_max
        return a_number(level, "level")

    @property
    def shelf(self) -> Shelf | None:
        """The least hands below sigma_first in which closing may stop with nothing to hold it.

        On opposing parallel edges a hand may balance the motor and slide at constant sigma. None
        where there are none, and for cages planned by the contact space, which does not look.
        """
        if self.work is None:
            return None
        if "shelf" not in self.work.remembered:
            from icage.shelf import shelf_of

            self.work.remembered["shelf"] = shelf_of(self, self.work)
        return cast("Shelf | None", self.work.remembered["shelf"])

    @property
    def brink(self) -> Brink | None:
        """The least hand below sigma_first, no grasp, at which closing stops from one side.

        A finger is at the end of an edge there, or in a minimum too shallow to count. None where
        there is none, and for cages planned by the contact space, which does not look.
        """
        if self.work is None:
            return None
        if "brink" not in self.work.remembered:
            from icage.brink import brink_of

            self.work.remembered["brink"] = brink_of(self, self.work)
        return cast("Brink | None", self.work.remembered["brink"])

    @property
    def wedge(self) -> Wedge | None:
        """Why, and from which size on, closing ends in the target only by an exact fit.

        Fingers 1e-5 of the diameter thinner or thicker would end elsewhere. None where nothing of
        the guaranteed set hangs on that, and for cages planned by the contact space, which does
        not look.
        """
        if self.work is None:
            return None
        if "wedge" not in self.work.remembered:
            from icage.wedge import wedge_of

            self.work.remembered["wedge"] = wedge_of(self, self.work)
        return cast("Wedge | None", self.work.remembered["wedge"])

    @property
    def sigma_guaranteed(self) -> float | None:
        """[unit] Below it closing ends in the target.

        The least of sigma_first, ``shelf``, ``brink`` and ``wedge``. None if closing does so
        however far the hand opens; sigma_0 if nothing is guaranteed.
        """
        ends = (
            self.sigma_first,
            None if self.shelf is None else self.shelf.sigma,
            None if self.brink is None else self.brink.sigma,
            None if self.wedge is None else self.wedge.sigma,
        )
        return min((sigma for sigma in ends if sigma is not None), default=None)

    def friction(self, mu: float, tolerance: JamTolerance | None = None) -> FrictionLevel:
        """Below which level closing ends near the target although the fingers rub.

        ``mu`` [1] is Coulomb's coefficient, ``tolerance`` what counts as near (0.005 diameters and
        0.02 rad). For several coefficients ``icage.friction_levels`` shares the work, and tells
        what is raised.

        Examples
        --------
        >>> from icage.planner import plan
        >>> cage = plan(
        ...     [[0, 0], [1, 0], [0.5, 0.75**0.5]],
        ...     [[0.5, 0], [0.75, 0.1875**0.5], [0.25, 0.1875**0.5]],
        ... )
        >>> cage.friction(0.01).jam is None
        True
        >>> cage.friction(0.1).jam.fingers
        (1, 2, 3)
        """
        from icage.friction.levels import friction_levels

        return friction_levels(self, (mu,), tolerance)[0]

    def save(self, file: str | Path) -> None:
        """Write the cage as ``icage-plan/1``, whole or not at all; ``icage.read_cage`` reads it.

        Raises
        ------
        OutputError:
            The file cannot be written.
        """
        from icage.formats.cage_json import save_cage

        save_cage(self, a_path(file, "file"))

    def _repr_svg_(self) -> str:
        from icage.formats.picture import cage_picture

        return cage_picture(self)

    def __repr__(self) -> str:
        name = f" {self.name}" if self.name else ""
        unit = f" {self.unit}" if self.unit else ""
        if self.status == "not_a_cage":
            return f"<Cage{name}: not a cage at sigma {self.sigma_0:.6g}{unit}>"
        first = "" if self.sigma_first is None else f" < {self.sigma_first:.6g}"
        top = "" if self.sigma_max is None else f" <= {self.sigma_max:.6g}"
        never = ", never escapes" if self.sigma_max is None else ""
        count = f"{len(self.grasps)} grasp{'' if len(self.grasps) == 1 else 's'}"
        return f"<Cage{name}: sigma {self.sigma_0:.6g}{first}{top}{unit}{never}, {count}>"

    @property
    def escape_free_at(self) -> int | None:
        """First row of ``escape_path`` at which the hand can shrink to a point as it stands.

        From there on nothing holds the object (see ``icage.geometry.way_out``); the rows after
        it only show how the planner pinches the hand. None without an escape path.
        """
        if self.escape_path is None:
            return None
        return free_from(self.outline, self.hand, self.finger_radius, self.escape_path)


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
        CageStatus.NOT_A_CAGE,
        why,
        sigma,
        sigma,
        sigma,
        sigma_max_upper=sigma if radius else None,
        sigma_max_lower=sigma if radius else None,
        sigma_first_upper=sigma if radius else None,
        sigma_first_converged=True if radius else None,
    )
