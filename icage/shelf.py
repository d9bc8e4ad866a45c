"""Where closing may stop although nothing holds it: hands that can only slide along parallel edges.

Fingers on opposing parallel edges may balance the motor in a hand that keeps its size while it
slides. If one end of that slide leads down the hand is no minimum and no level tells of it, and yet
nothing drives it along: a closing that comes there may stay. Our own. [docs/theory.md, Sec. 2.7]
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from icage.arrays import BoolArray, ComplexArray, FloatArray, IntArray, read_only
from icage.cells.free_space import FreeSpace
from icage.cells.kernels.columns import BIRTH_SIGMA, BIRTH_WX, BIRTH_WY
from icage.cells.kernels.minimum import is_local_minimum
from icage.cells.kernels.near import Hand
from icage.cells.kernels.plateau import translations
from icage.cells.work import CageWork
from icage.geometry.near_frame import NearFrame
from icage.tolerance import PLATEAU
from icage.values import Value

if TYPE_CHECKING:
    from icage.cage import Cage

_PARALLEL: Final = 1e-6
"""[rad] Edges that differ by more are not parallel: along them a hand slides open or shut."""

_INSIDE: Final = (0.5, 0.27, 0.81)
"""[slide] Where along a slide it is asked whether there is a way down."""

_REACH: Final = 1e-7
"""[diameter] How near a disc is to what it touches."""


@dataclass(frozen=True, slots=True, eq=False)
class Shelf(Value):
    """The least hands that may stop short of the target, below sigma_first.

    Attributes
    ----------
    sigma:
        [unit] Their size: below it closing ends only in the target.
    contacts:
        (2, fingers, 2) finger centres at both ends of the slide (of the part of it that one cell of
        the planner holds).
    """

    sigma: float
    contacts: FloatArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "contacts", read_only(np.array(self.contacts, dtype=np.float64)))


def shelf_of(cage: Cage, work: CageWork) -> Shelf | None:
    """The least shelf of a cage below its sigma_first, or None.

    A shelf is a local minimum that is not strict, so it is the least point of a cell that holds a
    part of it: every cell of the target's component below sigma_first is looked at that has
    parallel edges. With discs the edges have to be straight on the true curve, too.
    """
    found, tree = work.search, work.tree
    free_space = found.free_space
    nodes, level = work.below_first(cage.sigma_first)
    opposed = _may_slide(free_space)[found.cells[nodes]].sum(axis=1) >= 2
    nodes, level = nodes[opposed], level[opposed]
    for place in np.argsort(level, kind="stable").tolist():
        node = int(nodes[place])
        w = complex(*tree.birth[node, [BIRTH_WX, BIRTH_WY]].tolist())
        slide = _slide(free_space, found.cells[node], w, float(tree.birth[node, BIRTH_SIGMA]))
        if slide is None:
            continue
        fingers = slide[:, None] + w * free_space.hand.z
        near = np.stack([fingers.real, fingers.imag], axis=2) + free_space.origin
        contacts = NearFrame.of(cage.outline).back(near.reshape(-1, 2)).reshape(near.shape)
        if cage.finger_radius == 0.0 or _slides_on_edges(cage, contacts):
            return Shelf(float(level[place]), contacts)
    return None


def _may_slide(free_space: FreeSpace) -> BoolArray:
    """Which pieces (m,) touch an edge of the object that another one opposes."""
    pieces = free_space.pieces
    walls = pieces.slot_neighbour < 0
    owner = np.repeat(np.arange(pieces.total), np.diff(pieces.ptr))[walls]
    angle = np.arctan2(pieces.normal_y[walls], pieces.normal_x[walls])
    ordered = np.sort(np.concatenate([angle, angle - 2.0 * np.pi, angle + 2.0 * np.pi]))
    behind = np.searchsorted(ordered, angle - np.pi - _PARALLEL)
    ahead = np.searchsorted(ordered, angle - np.pi + _PARALLEL, side="right")
    opposed = np.zeros(pieces.total, dtype=np.bool_)
    opposed[owner[ahead > behind]] = True
    return opposed


def _slide(free_space: FreeSpace, cell: IntArray, w: complex, sigma: float) -> ComplexArray | None:
    """Both ends d (2,) of the translations of the least hand of a cell, if it may stop there."""
    pieces, z = free_space.pieces, free_space.z
    corners = translations(pieces, z, np.ascontiguousarray(cell), w.real, w.imag)
    if len(corners) < 2:
        return None
    d = corners[:, 0] + 1j * corners[:, 1]
    apart = np.abs(d[:, None] - d)
    i, j = np.unravel_index(int(np.argmax(apart)), apart.shape)
    if apart[i, j] <= PLATEAU * pieces.diameter:
        return None
    for share in _INSIDE:
        at = d[i] + share * (d[j] - d[i])
        here = Hand(at.real, at.imag, w.real, w.imag)
        if is_local_minimum(pieces, z, here, sigma, free_space.cap, free_space.worst):
            return np.array([d[i], d[j]])
    return None


def _slides_on_edges(cage: Cage, contacts: FloatArray) -> bool:
    """Whether discs half way along a slide touch edges that let them slide, and no chords."""
    from icage.discs.critical import CriticalHands

    middle = contacts.mean(axis=0)
    size = cage.outline.diameter
    critical = CriticalHands(cage.outline, cage.finger_radius, cage.hand)
    rests = critical.minimum(middle, _REACH * size)
    if rests is None or not rests.level:
        return False
    return bool(np.abs(rests.contacts - middle).max() <= 10.0 * _REACH * size)
