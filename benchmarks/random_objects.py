"""Objects and targets that benchmarks draw."""

from __future__ import annotations

import numpy as np

from icage.grasps.evaluator import GraspEvaluator
from icage.grasps.wanted import Wanted
from icage.outline import Outline

_SHARE = 20
"""Features that may come first in a triple of those from which targets are drawn."""


def star(n: int, rng: np.random.Generator) -> Outline:
    """A star-shaped polygon with n vertices."""
    angle = np.sort(rng.uniform(0.0, 2.0 * np.pi, n))
    radius = rng.uniform(0.35, 1.0, n)
    return Outline(np.column_stack([radius * np.cos(angle), radius * np.sin(angle)]))


def targets(outline: Outline, count: int, rng: np.random.Generator) -> list[np.ndarray]:
    """Contacts of immobilizing grasps of the outline, half of them with a useful cage."""
    bench = GraspEvaluator(outline, 0.0, Wanted())
    shares = max(1, len(outline.vertices) // _SHARE)  # all triples of 300 edges take a minute
    triples, points = bench.triples(int(rng.integers(shares)), shares)
    found: list[np.ndarray] = []
    for k in rng.permutation(len(triples)):
        candidate = bench.at(triples[k], points[k])
        if candidate is None:
            continue
        if candidate.score > 1.02 or len(found) % 2 == 0:
            found.append(candidate.contacts)
        if len(found) == count:
            break
    return found
