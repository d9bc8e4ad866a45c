"""A random target for point fingers: raw triangles, merged pieces and rotations must agree."""

from __future__ import annotations

import math

import numpy as np

from icage.outline import Outline
from icage.planner import plan
from tests.oracles.against_itself.levels import Levels, difference, levels
from tests.oracles.against_itself.outcome import Outcome
from tests.oracles.polygons import rotated
from tests.oracles.targets import Target, random_target

ROTATIONS = (0.0, 1.0, 0.5 * math.pi, 2.5)
"""[rad] As drawn, two general ones, and a quarter turn (whose cosine is 6e-17, not 0)."""


def judge(seed: int, number: int) -> Outcome:
    """Plan one target in all ways and compare."""
    target = random_target(np.random.default_rng([seed, number]))
    outcome = Outcome(number, target.family)
    try:
        _compare(target, outcome)
    except Exception as error:  # the sweep's business is to find them all
        outcome.exceptions.append(f"{type(error).__name__}: {error}")
    return outcome


def _compare(target: Target, outcome: Outcome) -> None:
    reference: Levels | None = None
    for angle in ROTATIONS:
        vertices, contacts = rotated(target.vertices, angle), rotated(target.contacts, angle)
        for merge in (True, False):
            found = levels(vertices, contacts, merge=merge)
            if reference is None:
                reference = found
            way = f"rotation {angle:.3g}, {'merged' if merge else 'raw'}"
            outcome.add(way, difference(reference, found))
    assert reference is not None
    cage = plan(Outline(target.vertices), target.contacts)
    outcome.verdict = cage.status
    outcome.opening = cage.sigma_max / cage.sigma_0 if cage.sigma_max else None
    if cage.status != "not_a_cage":
        whole = Levels(
            cage.sigma_0,
            np.inf if cage.sigma_first is None else cage.sigma_first,
            np.inf if cage.sigma_max is None else cage.sigma_max,
        )
        outcome.add("plan()", difference(reference, whole))
