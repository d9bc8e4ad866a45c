"""Brute force: a flood of the hand's 4-D configuration space that brackets sigma_max.

Shares nothing with the planner: no triangulation, no convex cells, no contact space. A
configuration is (d, w), finger k at d + w z_k. The plane of w is cut into a log-polar grid; while
w is in one grid cell, finger k strays from its middle by at most rho |z_k|. So with the object

- *eroded* by that much, the d in the free set are at least those of any w in the cell (optimistic),
- *dilated* by that much, the d in the free set are free for every w in the cell (pessimistic).

Both sets of d are polygons, a plain overlay of three shifted copies of the object: d needs no grid.
The flood runs from the target over the pieces of these sets, joined where they overlap in
neighbouring grid cells, one shell of |w| after the other, up to a piece that reaches infinity.
Every true way out runs through optimistic pieces that overlap, so sigma_max is at least the inner
radius of the highest shell needed; every pessimistic way out is a true one, so it is at most the
outer radius of the highest shell needed there.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
import shapely
from numpy.typing import NDArray

from icage.hand import HandShape
from icage.outline import Outline
from tests.oracles.geometry import Floats

Cell = tuple[int, int]  # shell of |w|, sector of arg w, both counted from the target's
Node = tuple[int, int, int]  # shell, sector, number of a piece of the free set there

SIDES_OF_DISC = 16
"""A disc is replaced by the regular polygon around it: 2 % too large, nowhere too small."""
SLACK = 1e-9
"""[diameter] Every disc is larger by this, far above the rounding of the overlays."""
FLOOR = 0.2
"""[sigma_0] Below it the optimistic hand counts as escaped, the pessimistic one does not go."""
SEED_TURN, SEED_OPENING = 0.15, 0.2
"""[rad], [log sigma] How far from the target the pessimistic flood looks for its seeds."""


class FloodError(Exception):
    """No bracket: one of the floods does not get out. A smaller step may help."""


@dataclass(frozen=True, slots=True)
class Bracket:
    """sigma_max is in [lower, upper], for certain, [unit]."""

    lower: float
    upper: float

    @property
    def width(self) -> float:
        """[1] Relative width."""
        return self.upper / self.lower - 1.0

    def admits(self, sigma: float | None) -> bool:
        """May ``sigma`` be the true sigma_max? With 1e-9 relative for rounding."""
        return sigma is not None and self.lower * (1 - 1e-9) <= sigma <= self.upper * (1 + 1e-9)


def bracket_sigma_max(outline: Outline, contacts: Floats, step: float) -> Bracket:
    """Guaranteed bracket of sigma_max for point fingers with contacts (3, 2) at the target.

    ``step`` [1] is the grid's, in log |w| and arg w; the width comes out at about 3 steps.
    """
    below = Flood(outline, contacts, step, optimistic=True)
    above = Flood(outline, contacts, step, optimistic=False)
    lower, upper = below.escape_shell(), above.escape_shell()
    if lower is None or upper is None:
        raise FloodError(f"no way out of the {'eroded' if lower is None else 'dilated'} object")
    return Bracket(below.radius(lower), above.radius(upper + 1))


def never_escapes(outline: Outline, contacts: Floats, step: float) -> bool:
    """True is a proof that the hand cannot escape, at any opening; False proves nothing."""
    return Flood(outline, contacts, step, optimistic=True).escape_shell() is None


@dataclass(slots=True)
class Flood:
    """One flood: the object eroded all through (``optimistic``) or dilated all through."""

    outline: Outline
    contacts: Floats
    step: float
    optimistic: bool
    z: NDArray[np.complex128] = field(init=False)
    d_0: complex = field(init=False)
    w_0: complex = field(init=False)
    sectors: int = field(init=False)
    shells: tuple[int, int] = field(init=False)
    box: shapely.Polygon = field(init=False)
    _inside: shapely.Geometry = field(init=False)
    reached: set[Node] = field(default_factory=set)
    _pieces: dict[Cell, NDArray[np.object_]] = field(default_factory=dict)
    _obstacles: dict[int, list[shapely.Geometry]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        hand = HandShape.from_contacts(self.contacts)
        fingers = self.contacts[:, 0] + 1j * self.contacts[:, 1]
        # d is the middle of the smallest circle round the fingers: from there they stray least.
        middle = middle_of_hand(hand.z)
        self.z = hand.z - middle
        self.w_0 = complex(fingers[1] - fingers[0])
        self.d_0 = complex(fingers[0] + self.w_0 * middle)
        self.sectors = math.ceil(math.tau / self.step)
        # With all sides above the diameter at most one finger is in the hull: it can leave.
        shortest = float(abs(hand.z - np.roll(hand.z, 1)).min()) * abs(self.w_0)
        highest = max(1.0, self.outline.diameter / shortest)
        self.shells = tuple(round(math.log(part) / self.step) for part in (FLOOR, 1.1 * highest))
        reach = 2 * self.radius(self.shells[1]) * abs(self.z).max() + self.outline.diameter
        grow = np.array([-reach, -reach, reach, reach])
        self.box = shapely.box(*(np.array(self.outline.polygon.bounds) + grow))
        # The contacts lie on the outline only up to rounding, so its skin does not count as inside.
        self._inside = shapely.difference(self.outline.polygon, rim(self.outline, 0.0))
        shapely.prepare(self._inside)

    def radius(self, shell: int) -> float:
        """Inner radius of a shell, [unit]. The target is in the middle of shell 0."""
        return abs(self.w_0) * math.exp((shell - 0.5) * self.step)

    def escape_shell(self) -> int | None:
        """The highest shell needed on the best way from the target to infinity, if there is one."""
        fresh: set[Node] = set()
        for level in range(self.shells[1]):
            fresh |= self._seeds(level)
            while fresh:
                if any(self._is_out(node) for node in fresh):
                    return level
                self.reached |= fresh
                fresh = self._beside(fresh, ((0, 1), (0, -1), (-1, 0), (1, 0)), level)
            rim_of_flood = [node for node in self.reached if node[0] == level]
            fresh = self._beside(rim_of_flood, ((1, 0),), level + 1)
        return None

    def _is_out(self, node: Node) -> bool:
        """Does the piece reach the rim of the box, far from all obstacles, or count as pinched?"""
        if node[0] <= self.shells[0]:
            return self.optimistic
        return self._pieces[node[:2]][node[2]].bounds == self.box.bounds

    def _beside(self, nodes: Iterable[Node], moves: tuple[Cell, ...], level: int) -> set[Node]:
        """Nodes not reached yet, up to shell ``level``, one move from a node and overlapping it.

        No diagonal moves: a path through the corner of four grid cells is there in all four.
        """
        steps = [
            (self._pieces[shell, sector][piece], (shell + up, (sector + turn) % self.sectors))
            for shell, sector, piece in nodes
            for up, turn in moves
            if self.shells[0] + (not self.optimistic) <= shell + up <= level
        ]
        self._overlay({cell for _, cell in steps})
        ways = [
            (here, there, (*cell, number))
            for here, cell in steps
            for number, there in enumerate(self._pieces[cell])
            if (*cell, number) not in self.reached
        ]
        here, there = (np.array([way[side] for way in ways], dtype=object) for side in (0, 1))
        return {ways[n][2] for n in np.flatnonzero(shapely.intersects(here, there))}

    def _overlay(self, cells: Iterable[Cell]) -> None:
        """Fill in the pieces of free d over grid cells: the box minus three shifted objects."""
        new = sorted(set(cells) - self._pieces.keys())
        if not new:
            return
        middles = np.array([self._middle(*cell) for cell in new])
        blocked = []
        for k, z_k in enumerate(self.z):
            copies = np.array([self._seen_by_finger(shell)[k] for shell, _ in new], dtype=object)
            points, owner = shapely.get_coordinates(copies, return_index=True)
            moved = points - np.column_stack([(middles * z_k).real, (middles * z_k).imag])[owner]
            blocked.append(shapely.set_coordinates(copies, moved))
        free = shapely.difference(self.box, shapely.union_all(np.array(blocked), axis=0))
        for cell, geometry in zip(new, free, strict=True):
            self._pieces[cell] = shapely.get_parts(geometry)

    def _middle(self, shell: int, sector: int) -> complex:
        """Middle of a grid cell: the centre of the circle through its four corners."""
        turn = math.tau / self.sectors
        size = (self.radius(shell) + self.radius(shell + 1)) / (2 * math.cos(turn / 2))
        return complex(self.w_0 / abs(self.w_0) * size * np.exp(1j * turn * sector))

    def _seen_by_finger(self, shell: int) -> list[shapely.Geometry]:
        """What stops fingers 1, 2, 3 for any w of a cell of the shell, or for every w of it."""
        if shell not in self._obstacles:
            corner = self.radius(shell) * np.exp(0.5j * math.tau / self.sectors)
            stray = abs(corner - abs(self._middle(shell, 0)))
            change = shapely.difference if self.optimistic else shapely.union
            self._obstacles[shell] = [
                change(self.outline.polygon, rim(self.outline, stray * float(abs(z_k))))
                for z_k in self.z
            ]
        return self._obstacles[shell]

    def _seeds(self, shell: int) -> set[Node]:
        """Nodes of the shell that are joined to the target without any flood.

        Optimistic: the pieces at the target. Pessimistic: the pieces straight ahead of it.
        """
        if shell * self.step > (0.0 if self.optimistic else SEED_OPENING):
            return set()
        if self.optimistic:
            self._overlay([(0, 0)])
            home = shapely.Point(self.d_0.real, self.d_0.imag)
            at_home = shapely.intersects(self._pieces[0, 0], home)
            return {(0, 0, int(piece)) for piece in np.flatnonzero(at_home)}
        turns = round(SEED_TURN / self.step)
        cells = [(shell, turn % self.sectors) for turn in range(-turns, turns + 1)]
        self._overlay(cells)
        pieces = {(*cell, n) for cell in cells for n in range(len(self._pieces[cell]))}
        return {node for node in pieces - self.reached if self._is_straight_ahead(node)}

    def _is_straight_ahead(self, node: Node) -> bool:
        """Does a straight line in (d, w) lead from the target to some point of the piece?

        Then every finger runs along a segment, and |w| never exceeds the larger of its ends.
        """
        piece = self._pieces[node[:2]][node[2]]
        inner = shapely.get_coordinates(piece.representative_point())
        spots = np.vstack([inner, shapely.get_coordinates(piece.exterior)]) @ [1, 1j]
        ends = spots[:, None] + self._middle(*node[:2]) * self.z
        starts = np.broadcast_to(self.d_0 + self.w_0 * self.z, ends.shape)
        runs = np.stack([starts, ends], axis=-1)
        segments = shapely.linestrings(np.stack([runs.real, runs.imag], axis=-1))
        return not shapely.intersects(self._inside, segments).any(axis=1).all()


def middle_of_hand(z: NDArray[np.complex128]) -> complex:
    """Centre of the smallest circle round three points: middle of a side, or circumcentre."""
    a, b = z[1] - z[0], z[2] - z[0]
    through_all = z[0] + a * b * (a - b).conjugate() / (a.conjugate() * b - a * b.conjugate())
    centres = [(z[0] + z[1]) / 2, (z[1] + z[2]) / 2, (z[2] + z[0]) / 2, through_all]
    return complex(min(centres, key=lambda centre: abs(z - centre).max()))


def rim(outline: Outline, radius: float) -> shapely.Geometry:
    """A set with every point within ``radius`` [unit] of the edges: discs swept along them."""
    turns = np.arange(SIDES_OF_DISC) * (math.tau / SIDES_OF_DISC)
    size = (radius + SLACK * outline.diameter) / math.cos(math.pi / SIDES_OF_DISC)
    disc = size * np.column_stack([np.cos(turns), np.sin(turns)])
    ends = np.stack([outline.vertices, np.roll(outline.vertices, -1, axis=0)], axis=1)
    swept = (ends[:, :, None] + disc).reshape(len(ends), -1, 2)
    return shapely.union_all(shapely.convex_hull(shapely.multipoints(swept)))
