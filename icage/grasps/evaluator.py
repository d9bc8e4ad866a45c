"""One outline, cut into pieces once: how good is the grasp on these contacts? Our own."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeAlias

import numpy as np

from icage.arrays import FloatArray, IntArray
from icage.cells.free_space import FreeSpace, search
from icage.cells.largest_sigma import largest_sigma_in
from icage.cells.target import contacts_as_configuration, find_target
from icage.discs.offsets import offsets
from icage.errors import HandError
from icage.geometry.exterior import Pieces, exterior_pieces, shortest_side
from icage.grasps.features import (
    EDGE,
    VERTEX,
    Features,
    balanced_triples,
    features_of,
    further_points,
)
from icage.grasps.wanted import Candidate, Wanted
from icage.hand import HandShape
from icage.kernels.locate import depth_inside
from icage.outline import Outline
from icage.tolerance import FREE_FINGER, NOT_A_CAGE

_SEGMENTS = 16

_WIDEST = 8.0
"""Longest over shortest side of the hands that are searched; beyond it they are poor hands."""

_FLATTEST = 0.05
"""Least height over longest side of the hands that are searched: the same."""

_SEARCH_LIMIT = 20_000
"""Cells after which the search from a candidate is broken off; how many were is told."""

_MOST_TRIPLES = 20_000
"""Triples that are tried, a random choice if there are more; how many are left out is told."""

_FURTHER = 12
"""Points of concurrency at which a triple is tried before it is given up."""


Job: TypeAlias = tuple[IntArray, FloatArray]
Found: TypeAlias = tuple[Candidate | None, FloatArray]


class GraspEvaluator:
    """One outline, cut into pieces once for all hands that are tried on it."""

    def __init__(self, outline: Outline, radius: float, wanted: Wanted) -> None:
        self.radius = radius
        self.wanted = wanted
        self.broken_off = 0
        self.triples = self.triples_left_out = 0
        self.outline = offsets(outline, radius, _SEGMENTS).inner if radius > 0.0 else outline
        chord = 2.1 * radius * np.sin(0.25 * np.pi / _SEGMENTS)
        self.features: Features = features_of(self.outline, longer_than=float(chord))
        self.apart = max(2.02 * radius, 1e-3 * outline.diameter)
        self._pieces: Pieces
        widest = HandShape(complex(0.5, (_WIDEST**2 - 0.25) ** 0.5))
        self._pieces, self._origin = exterior_pieces(self.outline, widest)

    def evaluate(
        self, contacts: FloatArray, triple: Iterable[int] = (-1, -1, -1)
    ) -> Candidate | None:
        """The grasp next to these contacts and its levels, None if no cage (or a poor hand)."""
        try:
            hand = HandShape.from_contacts(contacts)
        except HandError:
            return None
        if not self.wanted.allows(hand):
            return None
        sides = [1.0, abs(hand.z_3), abs(hand.z_3 - 1.0)]
        longest = max(sides)
        if longest > _WIDEST * min(sides) or hand.z_3.imag < _FLATTEST * longest**2:
            return None
        if float(np.hypot(*(contacts[1] - contacts[0]))) * shortest_side(hand) < self.apart:
            return None
        free_space = FreeSpace.of_pieces(self.outline, hand, self._pieces, self._origin)
        target = find_target(free_space, contacts_as_configuration(free_space, contacts))
        if target is None or target.plateau is not None:
            return None
        own = free_space.contacts(target.at)
        if self._leaves_a_finger_free(own):
            return None
        found = search(free_space, target.cell, target.sigma_0, limit=_SEARCH_LIMIT)
        if found.gave_up:
            self.broken_off += 1
            return None
        top = largest_sigma_in(found) if found.never_escapes else found.level
        first = min(found.sigma_first(), top)
        if top / target.sigma_0 - 1.0 < NOT_A_CAGE:
            return None
        score = (first if self.wanted.aim == "first" else top) / target.sigma_0
        a, b, c = triple
        return Candidate(own, (a, b, c), target.sigma_0, first, top, score)

    def _leaves_a_finger_free(self, contacts: FloatArray) -> bool:
        """Where two fingers already hold: the best grasps of three lie beside such ones."""
        middle = contacts.mean(axis=0)
        depth = depth_inside(self.outline.vertices - middle, contacts - middle, 0.0)
        return float(depth.min()) < -FREE_FINGER * self.outline.diameter

    def at(self, triple: IntArray, p: FloatArray) -> Candidate | None:
        """The grasp of three features whose lines of force meet at P."""
        if not self.features.allows(triple, p):
            return None
        return self.evaluate(self.features.contacts(triple, p), (int(k) for k in triple))

    def elsewhere(self, triple: IntArray) -> list[Found]:
        """The grasps of a triple at a few points of concurrency all over its set."""
        fair = (_WIDEST, _FLATTEST)
        jobs = further_points(self.features, self.outline, self.apart, triple, fair)
        few = np.linspace(0, len(jobs) - 1, min(_FURTHER, len(jobs))).round().astype(int)
        return [(self.at(*jobs[k]), jobs[k][1]) for k in few]

    def jobs(self, rng: np.random.Generator) -> list[Job]:
        """A triple of features and a point of concurrency each: where the search starts.

        All triples that can balance, or a random choice of ``_MOST_TRIPLES`` of them.
        """
        triples, points = balanced_triples(self.features, self.outline, self.apart)
        corners = (self.features.kind[triples] == VERTEX).sum(axis=1)
        use = np.flatnonzero(corners >= self.wanted.corners)
        self.triples = len(use)
        self.triples_left_out = max(0, len(use) - _MOST_TRIPLES)
        if self.triples_left_out:
            use = np.sort(rng.choice(use, _MOST_TRIPLES, replace=False))
        jobs: list[Job] = list(zip(triples[use], points[use], strict=True))
        if self.wanted.near is None:
            return jobs
        solved = [(triple, self._shaped(triple, p)) for triple, p in jobs]
        return [(triple, p) for triple, p in solved if p is not None]

    def _shaped(self, triple: IntArray, p: FloatArray) -> FloatArray | None:
        """A point of concurrency near P that gives the wanted shape of hand (Gauss-Newton)."""
        step = 1e-6 * self.outline.diameter

        def error(q: FloatArray) -> FloatArray | None:
            try:
                hand = HandShape.from_contacts(self.features.contacts(triple, q))
            except HandError:
                return None
            return self.wanted.shape_error(hand)

        for _ in range(12):
            here = error(p)
            if here is None:
                return None
            if np.abs(here).max() < 1e-9:
                break
            ahead = [error(p + step * np.eye(2)[k]) for k in range(2)]
            if ahead[0] is None or ahead[1] is None:
                return None
            slope = np.column_stack([ahead[0] - here, ahead[1] - here]) / step
            move = np.linalg.lstsq(slope, -here, rcond=1e-6)[0]
            longest = 0.1 * self.outline.diameter
            p = p + move * min(1.0, longest / max(float(np.hypot(*move)), 1e-300))
        return p if self.features.allows(triple, p) else None

    def movable(self, triple: IntArray) -> bool:
        """Whether any contact of the triple can move (is on an edge)."""
        return bool((self.features.kind[triple] == EDGE).any())


def best_first(found: Iterable[Found]) -> list[tuple[Candidate, FloatArray]]:
    """Those that are grasps, best first."""
    good = [(c, p) for c, p in found if c is not None]
    return sorted(good, key=lambda pair: (-pair[0].score, pair[0].triple))
