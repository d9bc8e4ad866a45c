"""Valid shapes of the zoo with a grasp of point fingers and one of discs, planned once."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from icage.cage import Cage
from icage.grasps.evaluator import GraspEvaluator
from icage.grasps.wanted import ANY_HAND, Candidate, Wanted
from icage.outline import Outline
from icage.planner import plan
from tests.oracles.geometry import Ring
from tests.oracles.statics import is_strict_minimum
from tests.zoo.shapes import VALID, Shape

RADIUS = 0.02
"""[diameter] Of the disc fingers."""
MOST_VERTICES = 5
"""Up to here discs have their regions drawn and the whole search is run."""
TRIED = 60
"""Triples of features that are looked at for a specimen's grasp."""
EXACT = 1e-9
ROUNDING = 1e-9
"""[diameter] Contacts and paths."""


@dataclass(frozen=True, slots=True, eq=False)
class Specimen:
    """A shape with a grasp of point fingers and, where one was found, of discs."""

    shape: Shape
    outline: Outline
    ring: Ring
    cage: Cage
    discs: Cage | None
    candidate: Candidate | None

    @property
    def cages(self) -> list[Cage]:
        """The one or two cages, points first."""
        return [self.cage] if self.discs is None else [self.cage, self.discs]

    @property
    def size(self) -> float:
        """Diameter, [unit]."""
        return self.outline.diameter


def held(outline: Outline, ring: Ring, radius: float) -> Candidate | None:
    """The best of a few grasps that hold beyond doubt and not only by a hair."""
    bench = GraspEvaluator(outline, radius, Wanted(limits=ANY_HAND))
    triples, points = bench.triples()
    few = np.linspace(0, len(triples) - 1, min(TRIED, len(triples)), dtype=int)
    tried = [bench.at(triples[k], points[k]) for k in few]
    good = [
        c
        for c in tried
        if c is not None
        and c.score > 1.001
        and is_strict_minimum(ring, c.contacts, radius, margin=1e-3)
    ]
    return max(good, key=lambda c: c.score, default=None)


@cache
def specimen(name: str) -> Specimen:
    shape = next(s for s in VALID if s.name == name)
    outline, ring = Outline(shape.vertices), Ring.of(shape.vertices)
    points = held(outline, ring, 0.0) if shape.contacts is None else None
    contacts = shape.contacts if points is None else points.contacts
    assert contacts is not None, "every valid shape of the zoo has a grasp"
    assert is_strict_minimum(ring, contacts)
    radius = RADIUS * outline.diameter
    discs = held(outline, ring, radius)
    return Specimen(
        shape, outline, ring, plan(outline, contacts),
        None if discs is None else plan(outline, discs.contacts, radius), points,
    )  # fmt: skip


def case_of(vertices: Any, contacts: Any, radius: float = 0.0) -> dict[str, Any]:
    return {
        "format": "icage-case/1", "name": "zoo", "unit": "mm", "finger_radius": radius,
        "outline": {"vertices": vertices}, "grasp": {"contacts": contacts},
    }  # fmt: skip
