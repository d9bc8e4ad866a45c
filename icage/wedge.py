"""Guarantees that only an exact fit holds: hands stuck as wedges, and walls of no thickness.

The levels are those of the object and the fingers as given, to rounding. A hand that stands slanted
in a slot just as wide as its side is a strict minimum, and fingers a millionth thinner find a way
on; where it stands upright, fingers a millionth thicker stick slanted. So the plan is asked again
with the fingers a hair thinner and a hair thicker. Our own. [docs/theory.md, Sec. 2.8]
"""

from __future__ import annotations

import math
from collections.abc import Iterator
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
from icage.near_hands import are_beside
from icage.tolerance import DEPTH_CUT, PINCHED
from icage.values import Value

if TYPE_CHECKING:
    from icage.cage import Cage

FIT: Final = 1e-5
"""[diameter] Fingers are made this much thinner and thicker: as well as the target is known
(``tolerance.TARGET_SHIFT``), and a tenth of what fingers of a simulation sink in."""

SAME: Final = 25.0
"""[FIT] A level that moves by more is not that of the same passage."""

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
    contacts:
        (fingers, 2) where a hand with such fingers may end instead; None if the object escapes.
    """

    sigma: float
    kind: WedgeKind
    fit: float
    contacts: FloatArray | None

    def __post_init__(self) -> None:
        if self.contacts is not None:
            own = read_only(np.array(self.contacts, dtype=np.float64))
            object.__setattr__(self, "contacts", own)


class _Found(NamedTuple):
    """Where closing from the guaranteed set may end with fingers of another radius.

    ``near`` is the least end (fingers, 2) that is the target, None if that is lost; ``level``
    [unit] the least size from which on there is another end, inf if there is none; ``end``
    (fingers, 2) is that end, None if it is the object's escape.
    """

    near: FloatArray | None
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
            return least
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
        shelf = None if cage.shelf is None else cage.shelf.sigma
        brink = None if cage.brink is None else cage.brink.sigma
        ends = (cage.sigma_first, work.polygon_first, shelf, brink)
        least = min((one for one in ends if one is not None), default=math.inf)
        hair = SAME * FIT * cage.outline.diameter
        if least - hair <= cage.sigma_0 + hair:
            return None
        return cls(cage, work, least - hair, NearFrame.of(cage.outline).into(cage.contacts))

    def wedge(self, kind: WedgeKind, sign: float) -> Wedge | None:
        """What fingers thicker (``sign`` 1) or thinner (-1) by ``FIT`` show."""
        sigma_0, fit = self.cage.sigma_0, FIT * self.cage.outline.diameter
        first = self.found(self._all(sign * fit))
        if first.near is None:
            return Wedge(sigma_0, kind, fit, self._back(first.end))
        known = self._of_chords() if np.isfinite(first.level) else ()
        if known:
            first = self.found(self._all(sign * fit), known)
        if math.isinf(first.level):
            return None
        # the smaller the change, the smaller the hand that sticks
        found = [(first, fit)]
        found += [(self.found(self._all(sign * h * fit), known), h * fit) for h in _LESS]
        least, by = min(found, key=lambda one: one[0].level)
        return Wedge(max(least.level, sigma_0), kind, by, self._back(least.end))

    def _all(self, change: float) -> FloatArray:
        """Every edge of the object moved by the same, [unit]."""
        return np.full(len(self.work.search.free_space.pieces.wall_from), change)

    def found(self, change: FloatArray, known: tuple[FloatArray, ...] = ()) -> _Found:
        """Where closing from the set may end if the edges are moved by ``change`` (walls,) [unit].

        Ends beside ``known`` ones (fingers, 2) are no others.
        """
        near: FloatArray | None = None
        level, sigma, end = math.inf, math.inf, None
        for ends, hands in self._ends(change):
            own = [len(one) > 0 and self._beside(one, self.target) for one in hands]
            for bottom, one in ((ends.bottoms[k], hands[k]) for k in np.flatnonzero(own)):
                if bottom.sigma < sigma:
                    off = np.abs(one - self.target).max(axis=(1, 2))
                    sigma, near = bottom.sigma, one[np.argmin(off)]
            right = [
                is_own or (len(one) > 0 and any(self._beside(one, other) for other in known))
                for is_own, one in zip(own, hands, strict=True)
            ]
            here = _other_end(ends, right)
            if here < level:
                point = PINCHED * self.cage.outline.diameter
                far = [
                    (bottom.sigma, k)
                    for k, bottom in enumerate(ends.bottoms)
                    if len(hands[k]) and not right[k] and bottom.sigma > point
                ]
                low = min(far, default=(0.0, None))[1]
                level, end = here, None if low is None else hands[low][0]
        return _Found(near, level, end)

    def _ends(self, change: FloatArray) -> Iterator[tuple[Ends, list[FloatArray]]]:
        """The components of the set with the edges moved, and the hands of their minima."""
        search, size = self.work.search, self.cage.outline.diameter
        free_space = replace(
            search.free_space, pieces=with_walls_moved(search.free_space.pieces, change)
        )
        cells = search.cells[search.node_level < self.top]
        depth = max(DEPTH_CUT * size, _DEPTH * float(np.abs(change).max()))
        for ends in ends_below(free_space, cells, self.top, depth):
            yield ends, [_fingers(free_space, one) for one in ends.bottoms]

    def _of_chords(self) -> tuple[FloatArray, ...]:
        """Minima (fingers, 2) that only the polygon of discs has: they lead on to the target."""
        if self.cage.finger_radius == 0.0:
            return ()
        return tuple(
            one for _, hands in self._ends(self._all(0.0)) for some in hands for one in some
        )

    def _beside(self, hands: FloatArray, other: FloatArray) -> bool:
        """Whether hands (k, fingers, 2) all are as near to another as jams that are the target."""
        return bool(are_beside(hands, other, self.cage.outline.diameter).all())

    def _back(self, hand: FloatArray | None) -> FloatArray | None:
        """A hand in the object's own frame."""
        return None if hand is None else NearFrame.of(self.cage.outline).back(hand)


def _other_end(ends: Ends, right: list[bool]) -> float:
    """The least size from which on hands of a component may end elsewhere, inf if none do.

    ``right`` says which of its minima are where closing is said to end.
    """
    if not any(right):
        return ends.least
    for meeting in ends.meetings:
        # no component is mixed yet: each is what its lowest minimum is
        if right[meeting.keep] != right[meeting.lose]:
            return min(ends.escape, meeting.level)
    return ends.escape


def _fingers(free_space: FreeSpace, bottom: Bottom) -> FloatArray:
    """The hands (k, fingers, 2) of a minimum."""
    fingers = bottom.d[:, None] + bottom.w[:, None] * free_space.hand.z
    return np.stack([fingers.real, fingers.imag], axis=2) + free_space.origin
