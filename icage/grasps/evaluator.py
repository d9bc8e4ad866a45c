"""One outline, cut into pieces once: how good are the grasps on these contacts? Our own."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from icage.arrays import FloatArray, IntArray
from icage.discs.offsets import offsets
from icage.geometry.exterior import Pieces, exterior_pieces
from icage.grasps.features import (
    VERTEX,
    Features,
    balanced_triples,
    features_of,
    further_points,
    neighbours,
)
from icage.grasps.findings import Findings
from icage.grasps.kernels.climb import climb, tried_jobs
from icage.grasps.kernels.evaluate import Evaluated, Sought, Verdict, evaluate
from icage.grasps.kernels.hands import HandLimits as Limits
from icage.grasps.kernels.shaping import shaped_points
from icage.grasps.stretches import stretch
from icage.grasps.wanted import LEAST_GAP, Candidate, Wanted
from icage.hand import HandShape
from icage.outline import Outline

SEGMENTS = 16
"""Segments of an arc per quadrant where levels are compared."""

WIDEST = 8.0
"""Longest over shortest side of the hands that are searched; beyond it they are poor hands."""

_SEARCH_LIMIT = 20_000
"""Cells after which the search from a candidate is broken off; how many were is told."""

_OF_TOLERANCE = 10.0
"""[tolerance] How far apart two fingers must be at least: nearer, their hand is all error."""

_LEAST = 1e-3
"""[diameter] ... and this far in any case."""

_TOUCHING = 1e-9
"""[diameter] A finger this much further off than its radius still touches."""


class Tried(NamedTuple):
    """What came of candidates: the rows of those that are cages, these, and the cells visited."""

    rows: IntArray
    found: Findings
    cells: int


class GraspEvaluator:
    """One outline, cut into pieces once for all hands that are tried on it.

    Parameters
    ----------
    outline:
        Near its origin (``geometry.near_frame``), as in a search: far from it an offset polygon
        may have more corners than there are floats for.
    radius:
        [unit] Of the fingers. Discs stand on the inner offset polygon with ``segments`` a quadrant.
    """

    def __init__(
        self, outline: Outline, radius: float, wanted: Wanted, segments: int = SEGMENTS
    ) -> None:
        self.radius = radius
        self.wanted = wanted
        self.broken_off = 0
        grown = offsets(outline, radius, segments) if radius > 0.0 else None
        self.outline = outline if grown is None else grown.inner
        arc = None if grown is None else (outline.vertices, radius, grown.sagitta)
        self.features: Features = features_of(self.outline, arc=arc)
        # whoever asks for corners keeps them
        own = np.arange(len(self.features.kind))[:, None]
        self.beside = own if wanted.corners else neighbours(self.features)
        self.limits = _limits(outline, radius, wanted)
        self._pieces: Pieces
        widest = HandShape(complex(0.5, (WIDEST**2 - 0.25) ** 0.5))
        self._pieces, self._origin = exterior_pieces(self.outline, widest)
        self._ring = np.ascontiguousarray(self.outline.vertices - self._origin)
        avoided = np.concatenate(
            [np.empty((0, 4)), *(stretch(outline, *ends) for ends in wanted.avoid)]
        )
        reach = radius + _TOUCHING * outline.diameter
        self._sought = Sought(wanted.aim != "cage", avoided, reach, _SEARCH_LIMIT)

    def evaluate(
        self, contacts: FloatArray, triple: Iterable[int] = (-1, -1, -1)
    ) -> Candidate | None:
        """The grasp next to these contacts (3, 2), None if it is no cage of a hand that is wanted.

        Contacts are counterclockwise.
        """
        x, y = np.ascontiguousarray(contacts[:, 0]), np.ascontiguousarray(contacts[:, 1])
        x, y = x.copy(), y.copy()
        verdict, first, sigma_0, level, cells = evaluate(
            self._pieces, self._origin, self._ring, x, y, self.limits, self._sought
        )
        one = Evaluated(
            np.array([verdict]), np.column_stack([x, y])[None], np.array([[sigma_0, level]]),
            np.array([first]), np.array([cells]),
        )  # fmt: skip
        _, found = self._kept(one, np.array([list(triple)], np.int64), np.zeros((1, 2)))
        return found.candidates()[0] if len(found) else None

    def at(self, triple: IntArray, p: FloatArray) -> Candidate | None:
        """The grasp of three features whose lines of force meet at P."""
        found = self.grasps(np.asarray(triple)[None], np.asarray(p)[None])
        return found.candidates()[0] if len(found) else None

    def grasps(self, triples: IntArray, points: FloatArray) -> Findings:
        """Those of some triples (n, 3) with their points of concurrency (n, 2) that are cages."""
        return self.tried(triples, points).found

    def tried(self, triples: IntArray, points: FloatArray) -> Tried:
        """The same, the rows that they came from, and the cells that all searches visited."""
        every, used = tried_jobs(
            self._pieces, self._origin, self._ring, self.features, self.beside, triples, points,
            self.limits, self._sought,
        )  # fmt: skip
        self.broken_off += int((every.verdict == Verdict.BROKEN_OFF).sum())
        rows, found = self._kept(every, used, points)
        return Tried(rows, found, int(every.cells.sum()))

    def climbed(
        self, triple: IntArray, start: FloatArray, stride: float, steps: int
    ) -> tuple[Findings, int]:
        """The best of at most so many candidates on the way up from a point (2,), in one row or
        none, and how many there were.

        ``stride`` [unit] is the size of the first simplex.
        """
        best, used, point, spent = climb(
            self._pieces, self._origin, self._ring, self.features, self.beside, self.limits,
            self._sought, triple, start, stride, steps,
        )  # fmt: skip
        return self._kept(best, used, point)[1], int(spent)

    def _kept(
        self, every: Evaluated, triples: IntArray, points: FloatArray
    ) -> tuple[IntArray, Findings]:
        """Cages of hands that are wanted, read from their finger 1, and their rows."""
        rows = np.flatnonzero(every.verdict == Verdict.CAGE)
        turn = (every.first[rows, None] + np.arange(3)) % 3
        before = every.contacts[rows]
        own = np.take_along_axis(before, turn[:, :, None], axis=1)
        longer = _side(own) / np.maximum(_side(before), 1e-300)
        levels = every.levels[rows]
        found = Findings(
            np.take_along_axis(triples[rows], turn, axis=1), points[rows], own,
            levels[:, 0] * longer, levels[:, 1] * longer, every.cells[rows],
        )  # fmt: skip
        deep = found.level - found.sigma_0 >= self.wanted.tolerance
        return rows[deep], found.of(np.flatnonzero(deep))

    def triples(self, part: int = 0, parts: int = 1) -> tuple[IntArray, FloatArray]:
        """All triples (n, 3) that can balance, and a point of concurrency (n, 2) for each.

        Of ``parts`` shares that are all of them together.
        """
        any_shape = self.limits._replace(within=math.inf)
        triples, points = balanced_triples(self.features, self.outline, any_shape, part, parts)
        corners = (self.features.kind[triples] == VERTEX).sum(axis=1)
        use = corners >= self.wanted.corners
        return triples[use], points[use]

    def further(self, triple: IntArray, most: int) -> tuple[IntArray, FloatArray]:
        """A triple at a few points of concurrency all over its set."""
        any_shape = self.limits._replace(within=math.inf)
        triples, points = further_points(self.features, self.outline, any_shape, triple)
        few = np.linspace(0, len(points) - 1, min(most, len(points))).round().astype(int)
        return triples[few], points[few]

    def shaped(self, triples: IntArray, points: FloatArray) -> tuple[IntArray, FloatArray]:
        """Where a shape of hand is wanted: the points moved to where the hands have it."""
        if self.wanted.near is None:
            return triples, points
        phi_1, phi_2, within = self.wanted.near
        moved, off = shaped_points(
            self.features, triples, points, phi_1, phi_2, self.outline.diameter
        )
        use = off <= within
        return triples[use], moved[use]

    def on_features(self, found: Findings) -> tuple[IntArray, FloatArray]:
        """Triples and points of grasps that were found on another polygon of the same object.

        Each contact goes to the nearest feature that its line of force can pass.
        """
        near = 0.1 * self.radius + 1e-9 * self.outline.diameter
        slack = 1e-3 * self.outline.diameter
        features = self.features
        points = found.points
        inside = np.ones((len(points), len(features.kind)), dtype=bool)
        for side in range(2):
            plane = features.planes[:, side]
            inside &= points @ plane[:, :2].T >= plane[:, 2] - slack
        triples = np.empty((len(points), 3), np.int64)
        good = np.ones(len(points), dtype=bool)
        for finger in range(3):
            gap = features.feet(points) - found.contacts[:, finger][:, None]
            off = np.where(inside, np.hypot(gap[..., 0], gap[..., 1]), np.inf)
            triples[:, finger] = np.argmin(off, axis=1)
            good &= off.min(axis=1) <= near
        return triples[good], points[good]


def _side(contacts: FloatArray) -> FloatArray:
    """(n,) distance of the first two contacts (n, 3, 2)."""
    side = contacts[:, 1] - contacts[:, 0]
    return np.hypot(side[:, 0], side[:, 1])


def _limits(outline: Outline, radius: float, wanted: Wanted) -> Limits:
    """The limits of the hand in numbers for the kernels."""
    hand = wanted.limits
    gap = LEAST_GAP * outline.diameter if hand.least_gap is None else hand.least_gap
    phi_1, phi_2, within = (0.0, 0.0, math.inf) if wanted.near is None else wanted.near
    return Limits(
        least_distance=max(
            2.0 * radius + gap,
            2.02 * radius,
            _LEAST * outline.diameter,
            _OF_TOLERANCE * wanted.tolerance,
        ),
        # whoever asks for a shape gets it, however flat
        least_angle=0.0 if wanted.near is not None else hand.least_angle,
        widest=WIDEST,
        sigma_least=hand.sigma_least,
        sigma_most=hand.sigma_most,
        phi_1=phi_1,
        phi_2=phi_2,
        within=within,
    )
