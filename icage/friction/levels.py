"""sigma_first with friction: below it, closing ends within a tolerance of the target.

Below the frictionless sigma_first the cells that the search has reached are the target's component,
and it holds no other minimum: whatever hand lies in them joins the target at its own sigma. So the
first jam that matters is the one of least sigma in these cells, outside the tolerance. Our own.
[docs/theory.md, Sec. 10]
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from icage.arrays import BoolArray, FloatArray, read_only
from icage.cells.work import CageWork, work_of
from icage.checks import a_number
from icage.errors import InputError
from icage.friction.contacts import contacts_of
from icage.friction.kernels.far import Near
from icage.friction.kernels.jams import LeastJam, least_jam
from icage.geometry.near_frame import NearFrame
from icage.hand import Placement
from icage.library_faults import geometry_told
from icage.tolerance import JAM_THICK, LEVEL, NEAR_POSITION, NEAR_TURN
from icage.values import Value

if TYPE_CHECKING:
    from icage.cage import Cage

_FINE = 1e-12
"""[diameter] How far the cover of the tolerance's outside may cut into it."""

_LARGEST_TURN = 0.5 * np.pi
"""[rad] A tolerance of the angle has to be smaller: a hand across the target is not near it."""


@dataclass(frozen=True, slots=True, eq=False)
class Jam(Value):
    """A hand at which contact forces within the cones balance although it squeezes.

    ``fingers`` (of 1, 2, 3) carry the forces, ``contacts`` (3, 2) are all finger centres, sigma
    is the hand's size; in the object's frame and unit.
    """

    fingers: tuple[int, ...]
    contacts: FloatArray
    sigma: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "contacts", read_only(np.array(self.contacts, dtype=np.float64)))

    @property
    def placement(self) -> Placement:
        """The jam as a placement of the hand in the object's frame."""
        return Placement.from_contacts(self.contacts)


@dataclass(frozen=True, slots=True)
class JamTolerance:
    """Which jams count as the target: those within both, in the object's frame.

    ``position``: how far the middle of the fingers is from its place at the target, [diameter];
    ``angle``: how far the hand is turned, [rad].
    """

    position: float = NEAR_POSITION
    angle: float = NEAR_TURN

    def __post_init__(self) -> None:
        position = a_number(self.position, "the tolerance of the position")
        angle = a_number(self.angle, "the tolerance of the angle")
        if not 0.0 <= position <= 1.0:
            raise InputError(
                f"the tolerance of the position is {position:g} diameters; 0 to 1 is allowed"
            )
        if not 0.0 <= angle < _LARGEST_TURN:
            raise InputError(
                f"the tolerance of the angle is {angle:g} rad; 0 to less than "
                f"{_LARGEST_TURN:.4g} rad (a quarter turn) is allowed"
            )
        object.__setattr__(self, "position", position)
        object.__setattr__(self, "angle", angle)


@dataclass(frozen=True, slots=True)
class FrictionLevel:
    """What a coefficient of friction leaves of the guarantee.

    Below ``sigma_first`` [unit] a slow closing with Coulomb friction up to ``mu`` at the fingers
    ends within the ``tolerance`` of the target. ``jam`` is the far jam that limits it; None where
    the frictionless level does. ``sigma_first`` is None if there is neither.
    """

    mu: float
    sigma_first: float | None
    jam: Jam | None
    tolerance: JamTolerance


@geometry_told()
def friction_levels(
    cage: Cage, mus: Iterable[float], tolerance: JamTolerance | None = None
) -> tuple[FrictionLevel, ...]:
    """sigma_first for several coefficients of friction, in the order asked for.

    Every jam at one coefficient is one at all larger ones, so each search is bounded by what the
    smaller ones have found, and the levels never rise with mu.

    Parameters
    ----------
    cage:
        A cage of point fingers, planned by the cells.
    mus:
        [1] Coefficients of Coulomb friction, 0 or more. At 0 the level is the plan's own.
    tolerance:
        Which jams count as the target; None for 0.005 diameters and 0.02 rad.

    Raises
    ------
    InputError:
        Disc fingers; a coefficient that is negative or no number.
    MethodError:
        The cage was planned by the contact space: plan it by the cells.

    Examples
    --------
    >>> from icage.planner import plan
    >>> cage = plan(
    ...     [[0, 0], [1, 0], [0.5, 0.75**0.5]],
    ...     [[0.5, 0], [0.75, 0.1875**0.5], [0.25, 0.1875**0.5]],
    ... )
    >>> [round(level.sigma_first, 4) for level in friction_levels(cage, (0.0, 0.3))]
    [0.866, 0.5001]
    """
    if cage.finger_radius > 0.0:
        raise InputError(
            f"friction is computed for point fingers only; the fingers of this cage are discs of "
            f"radius {cage.finger_radius:g}"
        )
    asked = tuple(_checked(mu) for mu in mus)
    chosen = JamTolerance() if tolerance is None else tolerance
    work = work_of(cage)
    best = FrictionLevel(0.0, cage.sigma_first, None, chosen)
    found = {0.0: best}
    for mu in sorted(set(asked)):
        if mu > 0.0:
            best = replace(best, mu=mu)
            if work is not None:
                best = _limited(cage, work, best)
            found[mu] = best
    return tuple(found[mu] for mu in asked)


def _checked(mu: float) -> float:
    value = a_number(mu, "mu")
    if value < 0.0:
        raise InputError(f"mu is {value:g}; a coefficient of friction is 0 or more")
    return value + 0.0  # -0.0 is 0


def _limited(cage: Cage, work: CageWork, level: FrictionLevel) -> FrictionLevel:
    """The same, lowered to the least far jam of its coefficient."""
    found = work.search
    free_space = found.free_space
    size = free_space.pieces.diameter
    # at sigma_first itself the search goes on into other basins, and the puncture is an equilibrium
    first = np.inf if cage.sigma_first is None else cage.sigma_first * (1.0 - 2.0 * LEVEL)
    inside = int(np.searchsorted(found.node_level, first))
    least = least_jam(
        free_space.pieces, free_space.z, np.ascontiguousarray(found.cells[:inside]),
        np.ascontiguousarray(found.node_level[:inside]), contacts_of(free_space.pieces, level.mu),
        touching_subsets(len(free_space.z)), _near(cage, work, level.tolerance),
        first if level.jam is None else level.jam.sigma, JAM_THICK * size,
    )  # fmt: skip
    if not np.isfinite(least.sigma):
        return level
    return replace(level, sigma_first=float(least.sigma), jam=_jam(cage, work, least))


def touching_subsets(fingers: int) -> BoolArray:
    """(k, fingers) every way in which two fingers or more touch, the fewest first."""
    rows = [row for row in product((True, False), repeat=fingers) if sum(row) >= 2]
    return np.array(sorted(rows, key=sum), dtype=np.bool_)


def _near(cage: Cage, work: CageWork, tolerance: JamTolerance) -> Near:
    """The hands that count as the target, in the frame of the pieces."""
    free_space = work.search.free_space
    size = free_space.pieces.diameter
    fingers = NearFrame.of(cage.outline).into(cage.contacts) - free_space.origin
    at, ahead = fingers.mean(axis=0), fingers[1] - fingers[0]
    ahead = ahead / np.hypot(ahead[0], ahead[1])
    mid = free_space.z.mean(axis=0)
    return Near(
        float(at[0]), float(at[1]), tolerance.position * size, float(ahead[0]), float(ahead[1]),
        tolerance.angle, float(mid[0]), float(mid[1]), _FINE * size,
    )  # fmt: skip


def _jam(cage: Cage, work: CageWork, least: LeastJam) -> Jam:
    free_space = work.search.free_space
    d_x, d_y, w_x, w_y = least.hand.tolist()
    hand = complex(d_x, d_y) + complex(w_x, w_y) * free_space.hand.z
    fingers = np.column_stack([hand.real, hand.imag]) + free_space.origin
    touching = tuple((np.flatnonzero(least.touches) + 1).tolist())
    return Jam(touching, NearFrame.of(cage.outline).back(fingers), float(least.sigma))
