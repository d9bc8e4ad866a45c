"""sigma_first with friction: below it, closing ends within a tolerance of the target.

Below the frictionless sigma_first the cells that the search has reached are the target's component,
and it holds no other minimum: whatever hand lies in them joins the target at its own sigma. So the
first jam that matters is the one of least sigma in these cells, outside the tolerance. Our own.
[docs/theory.md, Sec. 10]
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

import numpy as np

from icage.cage import Cage
from icage.cells.work import work_of
from icage.checks import a_number, an_instance
from icage.errors import InputError
from icage.friction.ends import JamEnds, jam_ends
from icage.friction.jam import Jam, JamTolerance
from icage.friction.jam_search import JamSearch
from icage.library_faults import geometry_told
from icage.tolerance import LEVEL

__all__ = [
    "FrictionLevel", "Jam", "JamEnds", "JamTolerance", "checked_mu", "friction_levels", "limited",
]  # fmt: skip


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
    _cage: Cage | None = field(default=None, repr=False, compare=False)

    @property
    def ends(self) -> JamEnds | None:
        """How far from the target closings from below ``sigma_first`` may stop; at most the
        tolerance. None for what is not a cage: from nowhere does closing end at the target.
        """
        if self._cage is None:
            return JamEnds(self.tolerance.position, self.tolerance.angle)
        if work_of(self._cage) is None:
            return None
        return jam_ends(self._cage, self)


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
        Of point or disc fingers, planned by the cells.
    mus:
        [1] Coefficients of Coulomb friction, 0 or more. At 0 the level is the plan's own.
    tolerance:
        Which jams count as the target; None for 0.005 diameters and 0.02 rad.

    Raises
    ------
    InputError:
        A coefficient that is negative or no number; no cage.
    GeometryError:
        Disc fingers on an object that has no true curve: two parts of it are just two radii apart.
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
    an_instance(cage, Cage, "cage", "; icage.plan makes one")
    try:
        asked = tuple(checked_mu(mu) for mu in mus)
    except TypeError as error:
        several = "several coefficients are needed, such as (0.1, 0.2)"
        raise InputError(f"mus is {mus!r}; {several}") from error
    chosen = JamTolerance() if tolerance is None else tolerance
    work = work_of(cage)
    best = FrictionLevel(0.0, cage.sigma_first, None, chosen, cage)
    search = None if work is None else JamSearch(cage, work)
    found = {0.0: best}
    for mu in sorted(set(asked)):
        if mu > 0.0:
            best = replace(best, mu=mu)
            if search is not None:
                best = limited(search, best)
            found[mu] = best
    return tuple(found[mu] for mu in asked)


def checked_mu(mu: float, name: str = "mu") -> float:
    """A coefficient of friction, or an InputError that calls it by this name."""
    value = a_number(mu, name)
    if value < 0.0:
        raise InputError(f"{name} is {value:g}; a coefficient of friction is 0 or more")
    return value + 0.0  # -0.0 is 0


def limited(search: JamSearch, level: FrictionLevel) -> FrictionLevel:
    """A level of less friction, or none, lowered to the least far jam of its own coefficient."""
    if level.sigma_first is None or search.known < level.sigma_first * (1.0 - 2.0 * LEVEL):
        # the polygon lets go a little earlier than the true curve of discs: beyond nothing is known
        level = replace(level, sigma_first=search.known if np.isfinite(search.known) else None)
    below = search.known if level.jam is None else level.jam.sigma
    least = search.least(level.mu, search.near(level.tolerance), below)
    if not np.isfinite(least.sigma):
        return level
    # within rounding of the target no hand of the set is smaller than it
    sigma = max(float(least.sigma), search.sigma_0)
    return replace(level, sigma_first=sigma, jam=search.jam(least))
