"""Starts of closings: placements drawn from a cage, uniform in dx dy dtheta dsigma. Our own.

The *guaranteed set* is the component of the target below sigma_first, drawn below
``safe_level(sigma_first)``; the *rest* is what the cage holds besides (the target's component
below sigma_max without the guaranteed set, neighbours' basins included), drawn below
``safe_level(sigma_max)``; the *cage* is both together. Every start is clear of the true outline,
not of a polygonal offset.

Rejection from a box that holds the set for certain: two fingers i, j are drawn uniformly from the
*outer* bounds of their caging regions. Then d and w = (f_j - f_i) / (z_j - z_i) are uniform in
dx dy d^2 w = dx dy sigma dsigma dtheta; keeping a hand with probability (least sigma) / sigma makes
it uniform in dx dy dsigma dtheta, and the membership query has the last word.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import shapely
from numpy.typing import NDArray

from icage.arrays import BoolArray, FloatArray, read_only
from icage.cage import Cage
from icage.cells.membership import TARGET, query
from icage.cells.regions import outer_bounds
from icage.errors import GeometryError, IcageError
from icage.kernels.locate import depth_inside
from icage.library_faults import geometry_told
from icage.region_points import Area, Region, Uniform

StartSet = Literal["guaranteed", "rest", "cage"]

TRIES_PER_START = 100_000
"""Hands tried per start asked for before giving up: the rates seen are 1e-3 to 0.2."""

_CHUNK = 25_000
"""Hands whose random numbers are drawn at once."""

_FEWEST = 4
"""Hands looked at together per placement that is wanted: of the sets seen, a sixth to a
thirty-fourth of the hands is in the set."""

_GAP = 0.02
"""[1] Bounds of the regions this close cost little time and a few more tries."""

_LEAST_SIGMA = 1.0 - 1e-6
"""[1] The least sigma of a set is that of its minima, known to better than this (relative)."""

_ROOM = 4e-9
"""[diameter] The outer bounds of regions are noded on a grid of a quarter of this."""


class SamplingError(IcageError):
    """A set of placements is too small in its box to be drawn from."""


@dataclass(frozen=True, slots=True)
class Starts:
    """Placements (n, 4) = x, y, theta, sigma, and how many hands were tried for them."""

    placements: FloatArray
    tried: int

    def __len__(self) -> int:
        return len(self.placements)

    @property
    def acceptance_rate(self) -> float:
        """[1] Share of the hands tried that lay in the set."""
        return len(self) / self.tried if self.tried else 0.0


def safe_level(sigma: float | None, sigma_0: float) -> float:
    """A little below a level: S - min(0.005 S, 0.05 (S - sigma_0)); inf for no level.

    >>> safe_level(2.0, 1.0), round(safe_level(1.01, 1.0), 6), safe_level(None, 1.0)
    (1.99, 1.0095, inf)
    """
    if sigma is None:
        return np.inf
    return sigma - min(0.005 * sigma, 0.05 * (sigma - sigma_0))


def has_rest(cage: Cage) -> bool:
    """Whether the cage holds placements outside the guaranteed set below safe_level(sigma_max)."""
    first = cage.sigma_guaranteed
    if first is None or cage.status == "not_a_cage":
        return False
    top = safe_level(cage.sigma_max, cage.sigma_0)
    return first < top or any(grasp.sigma < top for grasp in cage.grasps[1:])


def has_guaranteed(cage: Cage) -> bool:
    """Whether anything is guaranteed: of a wedge that only an exact fit holds nothing is."""
    first = cage.sigma_guaranteed
    return cage.status != "not_a_cage" and (first is None or first > cage.sigma_0)


def same_set(cage: Cage, which: StartSet) -> StartSet:
    """The whole cage is its guaranteed set if it has no rest."""
    return "guaranteed" if which == "cage" and not has_rest(cage) else which


@geometry_told()
def draw_starts(
    cage: Cage,
    which: StartSet,
    count: int,
    rng: np.random.Generator,
    progress: Callable[[int], None] | None = None,
    box: Box | None = None,
) -> Starts:
    """Draw ``count`` placements from one set of a cage.

    Parameters
    ----------
    progress:
        Called with the number of placements found since the last call.
    box:
        ``Box.around`` this set of this cage, for whoever draws from it many times.

    Raises
    ------
    SamplingError:
        The set is empty, or ``TRIES_PER_START`` hands a start were not enough; says how many were
        found in how many tries.
    """
    return draw_starts_of_each(cage, which, count, [rng], progress, box)[0]


@geometry_told()
def draw_starts_of_each(
    cage: Cage,
    which: StartSet,
    count: int,
    rngs: Sequence[np.random.Generator],
    progress: Callable[[int], None] | None = None,
    box: Box | None = None,
) -> list[Starts]:
    """``draw_starts`` with each of several generators: the same starts, in less time.

    Hands of all of them are looked at together. Raises what ``draw_starts`` raises.
    """
    which = same_set(cage, which)
    if cage.status == "not_a_cage" or (which == "rest" and not has_rest(cage)):
        raise SamplingError(f"this cage has no {which} set of placements")
    if which == "guaranteed" and not has_guaranteed(cage):
        raise SamplingError(
            "nothing of this cage is guaranteed: closing ends in the target by an exact fit only "
            "(a wedge)"
        )
    box = Box.around(cage, which) if box is None else box
    drawings = [_Drawing(rng, count) for rng in rngs]
    while lacking := [drawing for drawing in drawings if drawing.have < count]:
        # what a first chunk is not enough for is drawn one by one: it may be hopeless, for all
        lacking = [drawing for drawing in lacking if not drawing.tried] or lacking[:1]
        hands = [drawing.hands() for drawing in lacking]
        rows, places = box.of_the_set(cage, which, _Hands.joined(hands))
        ends = np.cumsum([len(some.kept) for some in hands])
        cuts = np.searchsorted(places, ends)
        begins = zip([0, *ends.tolist()], [0, *cuts.tolist()], cuts.tolist(), strict=False)
        for drawing, (begin, first, last) in zip(lacking, begins, strict=True):
            found = drawing.take(rows[first:last], places[first:last] - begin)
            if progress is not None and found is not None:
                progress(found)
            if drawing.have < count and drawing.tried >= TRIES_PER_START * count:
                raise SamplingError(
                    f"the {which} set is too small to draw from: {drawing.have} of {count} "
                    f"placements found in {drawing.tried} tries"
                )
    return [drawing.starts() for drawing in drawings]


@dataclass(slots=True)
class _Drawing:
    """Starts drawn with one generator: the hands to look at next, and what is found of them.

    All random numbers of ``_CHUNK`` hands are drawn, but no more hands are looked at than it takes:
    the first ``count`` of the set in the order of the hands, in parts of whatever size.
    """

    rng: np.random.Generator
    count: int
    have: int = 0
    tried: int = 0
    _rows: list[FloatArray] = field(default_factory=list[FloatArray])
    _chunk: _Hands | None = None
    _begin: int = 0
    _size: int = 0
    _found: int = 0
    _last: int = 0

    def hands(self) -> _Hands:
        """The hands to look at next."""
        if self._chunk is None:
            self._chunk = _Hands.of_size(self.rng, _CHUNK)
            self._begin, self._found = 0, 0
            self._size = _FEWEST * (self.count - self.have)
        return self._chunk.part(slice(self._begin, min(self._begin + self._size, _CHUNK)))

    def take(self, rows: FloatArray, places: NDArray[np.int64]) -> int | None:
        """Take those of the hands that are in the set; how many a chunk gave when it is done."""
        wanted = self.count - self.have
        rows = rows[: wanted - self._found]
        if len(rows):
            self._last = self._begin + int(places[len(rows) - 1])
        self._rows.append(rows)
        self._found += len(rows)
        self._begin = min(self._begin + self._size, _CHUNK)
        if self._found < wanted and self._begin < _CHUNK:
            more = (wanted - self._found) * self._begin // max(self._found, 1)
            self._size = _FEWEST * wanted + more
            return None
        # tries after the last start taken do not count
        self.tried += self._last + 1 if self._found == wanted else _CHUNK
        self.have += self._found
        self._chunk = None
        return self._found

    def starts(self) -> Starts:
        """What was drawn."""
        return Starts(read_only(np.concatenate([np.empty((0, 4)), *self._rows])), self.tried)


@dataclass(frozen=True, slots=True)
class Box:
    """Two fingers in their regions, the third in the bounds of its own, sigma in [floor, top)."""

    z: NDArray[np.complex128]
    pair: tuple[int, int]
    areas: tuple[Area, Area]
    third: Region
    floor: float
    top: float

    @classmethod
    def around(cls, cage: Cage, which: StartSet, below: float = np.inf) -> Box:
        """A box that holds the set: a placement of it has each finger in the finger's region.

        ``below`` [unit] leaves of the guaranteed set what is smaller than that: below a level with
        friction, for one.
        """
        which = same_set(cage, which)
        if which == "guaranteed":
            top = min(safe_level(cage.sigma_guaranteed, cage.sigma_0), below)
            level, floor = (None if np.isinf(top) else top), cage.sigma_0
        else:
            top = safe_level(cage.sigma_max, cage.sigma_0)
            level, floor = None, min(grasp.sigma for grasp in cage.grasps)
        room = _ROOM * cage.outline.diameter
        outer = outer_bounds(cage, level, _GAP)
        regions = [geometry.buffer(room, join_style="mitre") for geometry in outer]
        pairs = ((0, 1), (1, 2), (2, 0))
        z = cage.hand.z
        volumes = [regions[i].area * regions[j].area / abs(z[j] - z[i]) ** 2 for i, j in pairs]
        i, j = pairs[int(np.argmin(volumes))]
        third = regions[3 - i - j]
        shapely.prepare(third)
        areas = (Area.of(regions[i]), Area.of(regions[j]))
        return cls(z, (i, j), areas, third, floor * _LEAST_SIGMA, top)

    def of_the_set(
        self, cage: Cage, which: StartSet, hands: _Hands
    ) -> tuple[FloatArray, NDArray[np.int64]]:
        """Placements (k, 4) of the set among hands (n), and which of the hands they are."""
        d, w = self._hands(hands.one, hands.other)
        sigma = np.abs(w)
        # A hand smaller than the floor would have to be kept more than once: there is none in the
        # set, or the floor is wrong.
        too_small = np.flatnonzero(sigma < self.floor)
        keep = (hands.kept * sigma < self.floor) & (sigma >= self.floor) & (sigma < self.top)
        places = np.flatnonzero(keep)
        rows = _placements(d, w, places)
        at = cage.hand.fingers(rows)[:, 3 - sum(self.pair)]
        near = shapely.contains_xy(self.third, at[:, 0], at[:, 1])
        rows, places = rows[near], places[near]
        asked = np.concatenate([rows, _placements(d, w, too_small)])  # one question for both
        inside, wrong = np.split(_belongs(cage, which, asked), [len(rows)])
        if wrong.any():
            raise GeometryError(f"a placement of the {which} set below its least sigma")
        return rows[inside], places[inside]

    def _hands(
        self, one: Uniform, other: Uniform
    ) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
        """Hands as d and w (n,), uniform in dx dy sigma dsigma dtheta over the two regions."""
        i, j = self.pair
        f_i, f_j = self.areas[0].points(one), self.areas[1].points(other)
        w = (f_j - f_i) / (self.z[j] - self.z[i])
        return f_i - w * self.z[i], w


def _placements(
    d: NDArray[np.complex128], w: NDArray[np.complex128], places: NDArray[np.int64]
) -> FloatArray:
    """Placements (k, 4) of some of the hands d + w z."""
    d, w = d[places], w[places]
    return np.column_stack([d.real, d.imag, np.angle(w), np.abs(w)])


@dataclass(frozen=True, slots=True)
class _Hands:
    """Random numbers of hands (n): of the points of two fingers, and ``kept`` (n,)."""

    one: Uniform
    other: Uniform
    kept: FloatArray

    @classmethod
    def of_size(cls, rng: np.random.Generator, count: int) -> _Hands:
        """Draw them for ``count`` hands."""
        return cls(Uniform.of_size(rng, count), Uniform.of_size(rng, count), rng.random(count))

    @classmethod
    def joined(cls, parts: Sequence[_Hands]) -> _Hands:
        """Those of all parts, one after another."""
        one, other = (
            Uniform(
                np.concatenate([some.triangle for some in pair]),
                np.concatenate([some.within for some in pair], axis=1),
            )
            for pair in ([part.one for part in parts], [part.other for part in parts])
        )
        return cls(one, other, np.concatenate([part.kept for part in parts]))

    def part(self, here: slice) -> _Hands:
        """Those of some of the hands."""
        return _Hands(self.one.part(here), self.other.part(here), self.kept[here])


def _belongs(cage: Cage, which: StartSet, placements: FloatArray) -> BoolArray:
    """Which placements (n, 4) are in the set and clear of the true outline, (n,)."""
    inside = np.zeros(len(placements), dtype=np.bool_)
    if not len(placements):
        return inside
    answers = query(cage, placements)
    target = answers.verdict == TARGET
    if which == "guaranteed":
        inside[:] = target
    else:
        inside[:] = answers.in_cage if which == "cage" else answers.in_cage & ~target
    at = np.flatnonzero(inside)
    fingers = cage.hand.fingers(placements[at]).reshape(-1, 2)
    depth = depth_inside(cage.outline.vertices, fingers, cage.finger_radius)
    inside[at] = (depth.reshape(-1, len(cage.hand.z)) <= 0.0).all(axis=1)
    return inside
