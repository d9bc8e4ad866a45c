"""How near is a hand to a jam? For starts beside jams, and for stops that should be one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from icage.cells.membership import checked_placements
from icage.cells.work import work_of
from icage.errors import PlacementError
from icage.friction.jam import Jam
from icage.friction.jam_search import JamSearch
from icage.friction.levels import checked_mu
from icage.hand import Placement
from icage.library_faults import geometry_told

if TYPE_CHECKING:
    from icage.cage import Cage


@geometry_told()
def nearest_jam(
    cage: Cage, mu: float, placement: Placement | ArrayLike | Sequence[float]
) -> tuple[float, Jam | None]:
    """The jam in the target's component that a hand is nearest to, and how near.

    The distance is that of the finger that is farthest from its place in the jam, [unit]. All jams
    below sigma_first count, near the target or not, and for ``mu`` > 0 the target itself.

    Parameters
    ----------
    cage:
        Of point or disc fingers, planned by the cells.
    mu:
        [1] Coefficient of Coulomb friction, more than 0 or there are no jams.
    placement:
        A ``Placement`` or four numbers x, y, theta [rad], sigma in the object's frame.

    Returns
    -------
    The distance and the jam; inf and None if there is none.

    Raises
    ------
    InputError:
        A coefficient that is negative or no number.
    PlacementError:
        Not four finite numbers, or a negative sigma.
    MethodError:
        The cage was planned by the contact space: plan it by the cells.

    Examples
    --------
    >>> from icage.planner import plan
    >>> cage = plan(
    ...     [[0, 0], [1, 0], [0.5, 0.75**0.5]],
    ...     [[0.5, 0], [0.75, 0.1875**0.5], [0.25, 0.1875**0.5]],
    ... )
    >>> distance, jam = nearest_jam(cage, 0.1, cage.target_placement)
    >>> distance < 1e-6, jam.fingers
    (True, (1, 2, 3))
    """
    mu = checked_mu(mu)
    row = placement.as_array() if isinstance(placement, Placement) else placement
    try:
        rows = np.asarray(row, dtype=np.float64)[None]
    except (TypeError, ValueError) as error:
        raise PlacementError(
            f"a placement is a {type(row).__name__}; numbers x, y, theta, sigma are needed"
        ) from error
    rows = checked_placements(rows)
    work = work_of(cage)
    if work is None or mu == 0.0:
        return np.inf, None
    return JamSearch(cage, work).nearest(mu, cage.hand.fingers(rows)[0])
