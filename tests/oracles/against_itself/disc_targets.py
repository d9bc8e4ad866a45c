"""A random target for discs: resolutions, raw and merged pieces, rotations must agree."""

from __future__ import annotations

import math

import numpy as np

from tests.oracles.against_itself.levels import Levels, difference, grown, levels
from tests.oracles.against_itself.outcome import Outcome
from tests.oracles.polygons import rotated
from tests.oracles.targets import Target, random_target

SEGMENTS = (4, 8, 32, 64)
ROTATIONS = (0.0, 1.0, 0.5 * math.pi, 2.5)
RADII = (0.01, 0.08)
"""[diameter]"""


def judge(seed: int, number: int, segments: tuple[int, ...] = SEGMENTS) -> Outcome:
    """All ways to the levels of one target."""
    rng = np.random.default_rng([seed, number])
    target = random_target(rng, radius=float(rng.uniform(*RADII)))
    outcome = Outcome(number, target.family)
    try:
        _compare(target, outcome, segments)
    except Exception as error:  # the sweep's business is to find them all
        outcome.exceptions.append(f"{type(error).__name__}: {error}")
    return outcome


def judge_one(seed: int, number: int) -> Outcome:
    """One target at one resolution, which goes round with its number."""
    return judge(seed, number, (SEGMENTS[number % len(SEGMENTS)],))


def _compare(target: Target, outcome: Outcome, resolutions: tuple[int, ...]) -> None:
    inner: list[Levels] = []
    outer: list[Levels] = []
    for segments in resolutions:
        for side, found in zip((inner, outer), _at(target, outcome, segments), strict=True):
            if not math.isnan(found.sigma_0):
                side.append(found)
    if not inner or not outer:
        outcome.verdict = "not_a_cage"
        return
    low, high = max(f.sigma_max for f in inner), min(f.sigma_max for f in outer)
    over = low / high - 1.0 if math.isfinite(high) else 0.0
    outcome.add("sigma_max of an inner polygon above an outer one's", max(0.0, over))
    if math.isfinite(low):
        outcome.opening = low / inner[-1].sigma_0
    else:
        outcome.verdict = "never_escapes"


def _at(target: Target, outcome: Outcome, segments: int) -> tuple[Levels, Levels]:
    """Levels on the inner and the outer polygon, all rotations and pieces compared."""
    references: list[Levels] = []
    for angle in ROTATIONS:
        vertices, contacts = rotated(target.vertices, angle), rotated(target.contacts, angle)
        *polygons, reach = grown(vertices, contacts, target.radius, segments)
        for side, polygon in enumerate(polygons):
            for merge in (True, False):
                found = levels(polygon, contacts, merge=merge, reach=reach)
                if len(references) == side:
                    references.append(found)
                way = (
                    f"{segments} segments, {('inner', 'outer')[side]}, rotation {angle:.3g}, "
                    f"{'merged' if merge else 'raw'}"
                )
                outcome.add(way, difference(references[side], found))
    return references[0], references[1]
