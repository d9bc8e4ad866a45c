"""Whether a study's inputs fit its case: discs and a triangle are left, the hand is near."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import product
from typing import Final

import numpy as np
import shapely

from experiments.study.inputs.distributions import Distribution
from experiments.study.inputs.variables import input_of
from icage.case import Case
from icage.errors import HandError, InputError
from icage.hand import HandShape

THINNEST: Final = 1e-4
"""[diameter] Least radius of a finger: the engine compiles no disc of 1e-5, and a closing presses
them a few 1e-4 deep."""

FARTHEST: Final = 10.0
"""[diameter] From the object to a finger of the nominal placement."""


class MisfitError(InputError):
    """Inputs of a study that are possible, but not with this object and hand."""


def check_fits(
    vary: Mapping[str, Distribution], nominal: tuple[float, ...] | None, case: Case
) -> None:
    """Refuse what leaves no disc or triangle, and a nominal placement that is nowhere near.

    Raises
    ------
    MisfitError:
        Names the input, what was found and what is allowed.
    """
    radius = input_of("shape", "finger_radius").name
    if radius in vary:
        _check_fingers(radius, vary[radius], case)
    angles = [input_of("shape", field).name for field in ("phi_1", "phi_2")]
    if any(name in vary for name in angles):
        _check_triangle(angles, vary, case)
    if nominal is not None:
        _check_near(nominal, case)


def _check_fingers(name: str, error: Distribution, case: Case) -> None:
    """Errors of their radius must leave discs."""
    radius, thinnest = case.finger_radius, THINNEST * case.outline.diameter
    least = radius + error.low
    if not least >= thinnest:
        raise MisfitError(
            f"vary.{name}: fingers of radius {radius:g} {case.unit} would be down to "
            f"{least:g}; {thinnest - radius:g} {case.unit} or more is allowed"
            + (" (use truncated)" if math.isinf(least) else "")
        )


def _check_triangle(angles: Sequence[str], vary: Mapping[str, Distribution], case: Case) -> None:
    """Every pair of errors of the two angles must leave a hand."""
    none = Distribution("fixed", (0.0,))
    ends = [vary.get(name, none).reach for name in angles]
    phi = HandShape.from_contacts(case.contacts).phi
    for errors in product(*ends):
        try:
            HandShape.from_angles(phi[0] + errors[0], phi[1] + errors[1])
        except HandError as error:
            names = " and ".join(f"vary.{n}" for n in angles if n in vary)
            off = " and ".join(f"{math.degrees(one):.4g}" for one in errors)
            planned = ", ".join(f"{math.degrees(one):.4g}" for one in phi)
            raise MisfitError(
                f"{names}: errors of {off} degrees at fingers 1 and 2 of the planned hand, phi = "
                f"({planned}) degrees, leave no triangle: {error}"
            ) from error


def _check_near(nominal: tuple[float, ...], case: Case) -> None:
    """A hand from another drawing, or in another unit, is a slip."""
    fingers = HandShape.from_contacts(case.contacts).fingers(np.array(nominal))
    off = shapely.distance(shapely.points(fingers), case.outline.polygon)
    farthest, allowed = float(np.max(off)), FARTHEST * case.outline.diameter
    if not farthest <= allowed:
        raise MisfitError(
            f"nominal: finger {int(np.argmax(off)) + 1} would stand {farthest:g} {case.unit} from "
            f"the object; up to {allowed:g} {case.unit}, {FARTHEST:g} diameters, is allowed"
        )
