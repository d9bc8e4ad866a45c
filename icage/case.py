"""The question: an object, fingers of some radius and, once it is chosen, a target grasp."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Final, Literal

import numpy as np
from numpy.typing import ArrayLike

from icage.arrays import FloatArray, read_only
from icage.checks import a_count, a_number, an_instance
from icage.contacts import as_contacts, check_contacts, check_disc, check_radius
from icage.errors import CaseError, GraspError, InputError
from icage.grasp import Grasp
from icage.hand import HandShape
from icage.outline import Outline
from icage.units import UNITS, Unit
from icage.values import Value

if TYPE_CHECKING:
    from icage.formats.drawings.reading import Reading
    from icage.grasps.wanted import HandLimits

MAX_NAME: Final = 100
"""Characters of a case's name."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Case(Value):
    """An object with the fingers meant for it and, perhaps, a target grasp. Validated here, once.

    Parameters
    ----------
    name:
        Printable, 1 to 100 characters.
    unit:
        "m", "mm" or "cm": what all lengths of the case are in.
    outline:
        The object.
    finger_radius:
        [unit] Radius of the disc fingers; 0 for point fingers.
    target:
        (3, 2) finger centres of the target grasp, fingers 1, 2, 3, counterclockwise, or None for a
        case whose grasp is still to be chosen. Read it as ``contacts``.
    sources:
        The files it was read from: the case file and, if it names one, the drawing.
    size_from:
        Where a drawing's size is from, in words; empty for anything else.
    notes:
        What a user must know about how a drawing was read, a sentence each.
    reading:
        How the drawing was read; None for what is no drawing.

    Raises
    ------
    CaseError, GraspError, HandError:
        A name or unit that is not allowed; a radius below 0 or above 10 diameters, or below
        1e-10 but not 0; contacts off the outline (or off the distance of the radius) by more than
        1e-6 of the diameter, inside the object, overlapping, clockwise, collinear or coincident.

    Examples
    --------
    >>> square = Outline([[0, 0], [2, 0], [2, 2], [0, 2]])
    >>> case = Case("square", "mm", square, finger_radius=0.1)
    >>> case
    <Case square: 4 vertices, 2 x 2 mm, finger radius 0.1 mm, no grasp yet>
    >>> case == Case("square", "mm", square, 0.1)
    True
    """

    name: str
    unit: Unit
    outline: Outline
    finger_radius: float = 0.0
    target: FloatArray | None = None
    sources: tuple[Path, ...] = field(default=(), compare=False)
    size_from: str = field(default="", compare=False)
    notes: tuple[str, ...] = field(default=(), compare=False)
    reading: Reading | None = field(default=None, compare=False)

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not 0 < len(self.name) <= MAX_NAME:  # pyright: ignore[reportUnnecessaryIsInstance]
            raise CaseError(
                f"a case's name is {self.name!r}; 1 to {MAX_NAME} characters are needed"
            )
        if not self.name.isprintable():
            raise CaseError(f"a case's name is {self.name!r}; it must be printable")
        if self.unit not in UNITS:
            raise CaseError(f"unit is {self.unit!r}; one of {', '.join(UNITS)} is needed")
        an_instance(self.outline, Outline, "outline")
        object.__setattr__(self, "finger_radius", check_radius(self.finger_radius))
        check_disc(self.outline, self.finger_radius, self.unit)
        if self.target is not None:
            contacts = as_contacts(self.target)
            check_contacts(self.outline, contacts, self.finger_radius, self.unit)
            object.__setattr__(self, "target", read_only(contacts))

    @property
    def contacts(self) -> FloatArray:
        """Finger centres of the target grasp, (3, 2), [unit], read-only.

        Raises
        ------
        GraspError:
            The case has no grasp yet.
        """
        if self.target is None:
            raise GraspError(
                f"{self.name} has no target grasp yet; Case.grasps() (or `icage grasps`) finds some"
            )
        return self.target

    @property
    def hand(self) -> HandShape:
        """Shape of the hand that stands on the contacts. Raises what ``contacts`` raises."""
        return HandShape.from_contacts(self.contacts)

    def with_grasp(self, grasp: Grasp | ArrayLike) -> Case:
        """The same object and fingers with this target grasp, a ``Grasp`` or contacts (3, 2)."""
        return replace(
            self, target=as_contacts(grasp.contacts if isinstance(grasp, Grasp) else grasp)
        )

    def grasps(
        self,
        top: int = 10,
        *,
        aim: Literal["first", "cage", "friction", "place"] = "first",
        mu: float | None = None,
        rng: np.random.Generator | None = None,
        limits: HandLimits | None = None,
        avoid: Sequence[Sequence[float]] = (),
        tolerance: float = 0.0,
        workers: int = 1,
        progress: Callable[[str, int, int, float | None], None] | None = None,
        seconds: float | None = None,
    ) -> tuple[Grasp, ...]:
        """The best target grasps of the object with these fingers, best first. Our own.

        Parameters
        ----------
        top:
            How many to return; fewer if there are no more.
        aim:
            Rank by sigma_first / sigma_0 ("first"), by sigma_max / sigma_0 ("cage") or, "friction",
            by what friction leaves of the first: sigma_first(mu) / sigma_0; "place" by how much the
            fingers of the open hand may be off where it stands best (``icage.place``), over
            sigma_0.
        mu:
            [1] Coefficient of friction at the fingers, with aim "friction" only.
        rng:
            Where the random moves come from; ``numpy.random.default_rng(0)`` if None.
        limits:
            What the hand can be; ``HandLimits()`` if None: no angle below 15 degrees, fingers 2 %
            of the object's diameter apart.
        avoid:
            Stretches of the outline that no finger may touch, each from one arclength to another,
            [unit], counterclockwise from the first vertex.
        tolerance:
            [unit] How wrong the outline may be: smaller or shallower grasps are left out.
        workers:
            Threads; the result does not depend on their number.
        progress:
            Called with (stage, done, total, best score so far or None).
        seconds:
            When to stop the search with what there is; Ctrl-C does the same. None: when it is done.

        Raises
        ------
        GraspError:
            No immobilizing three-finger grasp was found.
        InputError:
            ``top`` below 1, a limit that no hand can meet, or an aim and a mu that do not fit.

        Examples
        --------
        >>> square = Outline([[0, 0], [3, 0], [3, 1], [2, 1], [2, 3], [1, 3], [1, 1], [0, 1]])
        >>> case = Case("T", "mm", square)
        >>> case.grasps(top=2)[0].score > 1.5
        True
        """
        from icage.grasps.of_case import best_of_case, grasps_in
        from icage.grasps.wanted import HandLimits, Wanted, as_stretches

        a_count(top, "top")
        a_count(workers, "workers")
        draws = np.random.default_rng(0) if rng is None else rng
        an_instance(draws, np.random.Generator, "rng")
        hand = HandLimits() if limits is None else an_instance(limits, HandLimits, "limits")
        wanted = Wanted(aim, limits=hand, avoid=as_stretches(avoid), tolerance=tolerance, mu=mu)
        if seconds is not None and a_number(seconds, "seconds") <= 0.0:
            raise InputError(f"seconds is {seconds:g}; more than 0 is needed")
        if progress is not None and not callable(progress):
            raise InputError(f"progress is {progress!r}; what can be called is needed, or None")
        planned = best_of_case(self, top, wanted, draws, workers, progress, seconds)
        if not planned.cages:
            raise GraspError(
                f"none of the {len(planned.failures)} grasps that were found is one of these "
                f"fingers: {planned.reason_words()}"
            )
        return grasps_in(planned)

    def _repr_svg_(self) -> str:
        from icage.formats.picture import case_picture

        return case_picture(self)

    def __repr__(self) -> str:
        width, height = np.ptp(self.outline.vertices, axis=0)
        fingers = (
            f"finger radius {self.finger_radius:.6g} {self.unit}"
            if self.finger_radius
            else "point fingers"
        )
        grasp = (
            "no grasp yet"
            if self.target is None
            else f"sigma_0 {_size(self.target):.6g} {self.unit}"
        )
        size = f"{len(self.outline)} vertices, {width:.6g} x {height:.6g} {self.unit}"
        return f"<Case {self.name}: {size}, {fingers}, {grasp}>"


def _size(contacts: FloatArray) -> float:
    return float(np.hypot(*(contacts[1] - contacts[0])))
