"""Placements of every verdict that a case has, outside the cage too, and pages of cases."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

import icage
from icage.cage import Cage
from icage.cells.membership import VERDICTS, query
from icage.cells.sublevels import minima_in
from icage.geometry.near_frame import NearFrame
from icage.hand import Placement
from models import CASES, HARD
from tests.icage.cells.wandering import wander

Floats = NDArray[np.float64]

SIX = (
    "pliers",
    "disc_Y",
    "spiral_first_close",
    "cross_multi",
    "never_escapes_b",
    "hook_deep_multi",
)
"""Point fingers and discs, one that never escapes, one whose chords join too early."""

IN_CAGE = ("target", "caged")
HOLDS = ("target", "caged", "other")


def source_of(name: str) -> str:
    """What names a shipped case for ``icage.load``."""
    for folder in (CASES, HARD):
        if (folder / f"{name}.json").exists():
            return str(Path(folder) / f"{name}.json")
    return name


@cache
def cage_of(name: str) -> Cage:
    """A shipped case, planned once."""
    return icage.plan(icage.load(source_of(name)))


def all_over(cage: Cage, rng: Generator, count: int = 2000) -> Floats:
    """``count`` placements (n, 4): at the grasps and levels, and of every class that walks met.

    A class is a verdict, in the cage or not; each has the same share, where it was met so often.
    """
    size = cage.outline.diameter
    hands = [g.contacts for g in cage.grasps] + [p.contacts for p in cage.punctures]
    special = np.array([Placement.from_contacts(contacts).as_array() for contacts in hands])
    far = np.array([[10.0 * size, size, 1.0, 3.0 * size], [*special[0, :3], 0.0]])
    walks = ((special[:1], ("target",)), (special, IN_CAGE), (_minima(cage), HOLDS))
    parts = [walked(cage, starts, rng, kept) for starts, kept in walks]
    rows = np.vstack([*parts, wander(cage, HOLDS, rng, count // 4, steps=60)])
    answers = query(cage, rows)
    kind = 2 * answers.verdict + answers.in_cage
    kinds = np.unique(kind)
    share = (count - len(special) - len(far)) // len(kinds)
    parts = [rng.permutation(rows[kind == k])[:share] for k in kinds]
    rest = rng.permutation(rows)[: count - len(special) - len(far) - sum(map(len, parts))]
    return np.vstack([special, far, *parts, rest])


def held_elsewhere(cage: Cage, rng: Generator, count: int) -> Floats:
    """Placements outside the cage that hold the object."""
    rows = walked(cage, _minima(cage), rng, HOLDS)
    answers = query(cage, rows)
    other = VERDICTS.index("other")
    return rng.permutation(rows[(answers.verdict == other) & ~answers.in_cage])[:count]


def walked(
    cage: Cage, starts: Floats, rng: Generator, kept: tuple[str, ...], walkers: int = 250
) -> Floats:
    """All placements (n, 4) that walkers tried which keep to these verdicts."""
    at = starts[rng.integers(len(starts), size=walkers)]
    scale = np.array([cage.sigma_0, cage.sigma_0, 1.0, cage.sigma_0])
    met: list[Floats] = []
    for _ in range(40):
        step = rng.normal(size=at.shape) * scale * 10.0 ** rng.uniform(-5.0, 0.0, (walkers, 1))
        tried = at + step
        tried[:, 3] = np.abs(tried[:, 3])
        met.append(tried)
        good = np.isin(query(cage, tried).verdict, [VERDICTS.index(word) for word in kept])
        at = np.where(good[:, None], tried, at)
    return np.vstack(met)


def _minima(cage: Cage) -> Floats:
    """Placements (k, 4) of all minima of the hand, in the cage and elsewhere."""
    assert cage.work is not None
    found = minima_in(cage.work.search.free_space)
    back = NearFrame.of(cage.outline).back
    return np.array([Placement.from_contacts(back(c)).as_array() for c in found.contacts])
