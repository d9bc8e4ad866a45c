"""Guarantees that only an exact fit holds: hands stuck as wedges, and walls of no thickness.

The levels are those of the object and the fingers as given, to rounding. A hand that stands slanted
in a slot just as wide as its side is a strict minimum, and fingers a millionth thinner find a way
on; where it stands upright, fingers a millionth thicker stick slanted. So the plan is asked again
with the fingers a hair thinner and a hair thicker. Our own. [docs/theory.md, Sec. 2.8]
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from icage.arrays import FloatArray, read_only
from icage.cells.ends import Bottom, Ends, ends_below
from icage.cells.free_space import FreeSpace
from icage.cells.moved_walls import with_walls_moved
from icage.cells.work import CageWork
from icage.geometry.near_frame import NearFrame
from icage.tolerance import DEPTH_CUT, NEAR_POSITION, NEAR_TURN
from icage.values import Value

if TYPE_CHECKING:
    from icage.cage import Cage

FIT: Final = 1e-5
"""[diameter] Fingers are made this much thinner and thicker: as well as the target is known
(``tolerance.TARGET_SHIFT``), and a tenth of what fingers of a simulation sink in."""

FORCE: Final = 25.0
"""[1] Contacts that press this many times as hard as the motor make a wedge, and a level that moves
by this many times as much as the fingers' radius is not that of the same passage."""

_DEPTH: Final = 10.0
"""[FIT] Minima that are shallower do not count here: that much the change itself may make."""

_LESS: Final = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5)
"""[FIT] Smaller changes, asked where the first one has found another end."""


class WedgeKind(StrEnum):
    """What makes a guarantee hang on an exact fit."""

    THINNER = "thinner"
    """Fingers a hair thinner find a way to another end."""
    THICKER = "thicker"
    """Fingers a hair thicker stop at another end."""
    FORCE = "force"
    """The contacts press so much harder than the motor pulls that what gives is not negligible."""


@dataclass(frozen=True, slots=True, eq=False)
class Wedge(Value):
    """Why, and from which size on, closing ends in the target only if everything fits exactly.

    Attributes
    ----------
    sigma:
        [unit] Below it closing ends in the target all the same; sigma_0: nothing is left.
    kind:
        What the exact fit is about.
    fit:
        [unit] The change of the fingers' radius that shows it, positive.
    force:
        [1] Sum of the forces at the target's contacts over the motor's pull; None where the target
        is lost.
    contacts:
        (fingers, 2) where a hand with such fingers may end instead; the target for ``kind`` force;
        None if the object escapes.
    """

    sigma: float
    kind: WedgeKind
    fit: float
    force: float | None
    contacts: FloatArray | None

    def __post_init__(self) -> None:
        if self.contacts is not None:
            own = read_only(np.array(self.contacts, dtype=np.float64))
            object.__setattr__(self, "contacts", own)


class _Found(NamedTuple):
    """Where closing from the guaranteed set may end with fingers of another radius.

    ``near`` [unit] is the least end that is the target, inf if it is lost; ``level`` [unit] the
    least size from which on there is another end, inf if there is none; ``end`` (fingers, 2) is
    that end, None if it is the object's escape.
    """

    near: float
    level: float
    end: FloatArray | None


def wedge_of(cage: Cage, work: CageWork) -> Wedge | None:
    """What of a cage's guaranteed set hangs on an exact fit, or None.

    Complexity: two searches of the cells of the set.
    """
    asked = _Asked.of(cage, work)
    if asked is None:
        return None
    least: Wedge | None = None
    for kind, sign in ((WedgeKind.THICKER, 1.0), (WedgeKind.THINNER, -1.0)):
        found = asked.wedge(kind, sign)
        if found is not None and (least is None or found.sigma < least.sigma):
            least = found
        if least is not None and least.sigma <= cage.sigma_0:
            break
    return least


@dataclass(frozen=True, slots=True)
class _Asked:
    """The guaranteed set below ``top`` [unit], and the target, near the object (near_frame)."""

    cage: Cage
    work: CageWork
    top: float
    target: FloatArray

    @classmethod
    def of(cls, cage: Cage, work: CageWork) -> _Asked | None:
        """None where the set is so shallow that a hair more or less says nothing."""
        ends = [cage.sigma_first, work.polygon_first, None if cage.shelf is None else cage.shelf.sigma]
        least = min((one for one in ends if one is not None), default=math.inf)
        hair = FORCE * FIT * cage.outline.diameter
        if least - hair <= cage.sigma_0 + hair:
            return None
        return cls(cage, work, least - hair, NearFrame.of(cage.outline).into(cage.contacts))

    def wedge(self, kind: WedgeKind, sign: float) -> Wedge | None:
        """What fingers thicker (``sign`` 1) or thinner (-1) by ``FIT`` show."""
        cage = self.cage
        fit = FIT * cage.outline.diameter
        first = self.found(sign * fit)
        if math.isinf(first.near):
            return Wedge(cage.sigma_0, kind, fit, None, first.end)
        force = (first.near - cage.sigma_0) / (sign * fit)
        if force > FORCE:
            return Wedge(cage.sigma_0, WedgeKind.FORCE, fit, force, cage.contacts)
        if math.isinf(first.level):
            return None
        # the smaller the change, the smaller the hand that sticks
        found = [(first, fit)]
        found += [(self.found(sign * part * fit), part * fit) for part in _LESS]
        least, by = min(found, key=lambda one: one[0].level)
        return Wedge(max(least.level, cage.sigma_0), kind, by, force, least.end)

    def found(self, change: float) -> _Found:
        """Where closing from the set may end if the radius is ``change`` [unit] larger."""
        search, size = self.work.search, self.cage.outline.diameter
        free_space = replace(
            search.free_space, pieces=with_walls_moved(search.free_space.pieces, change)
        )
        cells = search.cells[search.node_level < self.top]
        depth = max(DEPTH_CUT * size, _DEPTH * abs(change))
        near, level, end = math.inf, math.inf, None
        for ends in ends_below(free_space, cells, self.top, depth):
            hands = [_fingers(free_space, one) for one in ends.bottoms]
            is_near = [len(one) > 0 and self._is_near(one) for one in hands]
            here = _other_end(ends, is_near)
            near = min([near, *(ends.bottoms[k].sigma for k in np.flatnonzero(is_near))])
            if here < level:
                level = here
                far = [k for k, one in enumerate(hands) if len(one) and not is_near[k]]
                low = min(far, key=lambda k: ends.bottoms[k].sigma, default=None)
                end = None if low is None else NearFrame.of(self.cage.outline).back(hands[low][0])
        return _Found(near, level, end)

    def _is_near(self, hands: FloatArray) -> bool:
        """Whether hands (k, fingers, 2) all count as the target, as jams do."""
        off = hands.mean(axis=1) - self.target.mean(axis=0)
        side, own = hands[:, 1] - hands[:, 0], self.target[1] - self.target[0]
        turn = np.arctan2(
            own[0] * side[:, 1] - own[1] * side[:, 0], own[0] * side[:, 0] + own[1] * side[:, 1]
        )
        near = np.hypot(off[:, 0], off[:, 1]) <= NEAR_POSITION * self.cage.outline.diameter
        return bool((near & (np.abs(turn) <= NEAR_TURN)).all())


def _other_end(ends: Ends, is_near: list[bool]) -> float:
    """The least size from which on hands of one component may end elsewhere, inf if none do."""
    if not any(is_near):
        return ends.least
    level = ends.escape
    for meeting in ends.meetings:
        # up to here no component is mixed: each is as near as its lowest minimum
        if is_near[meeting.keep] != is_near[meeting.lose]:
            return min(level, meeting.level)
    return level


def _fingers(free_space: FreeSpace, bottom: Bottom) -> FloatArray:
    """The hands (k, fingers, 2) of a minimum."""
    fingers = bottom.d[:, None] + bottom.w[:, None] * free_space.hand.z
    return np.stack([fingers.real, fingers.imag], axis=2) + free_space.origin
