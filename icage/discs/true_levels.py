"""The levels of a cage found on a polygon, solved on the true curve.

The polygon tells which minima and punctures there are and which features touch at each; every one
of them is then solved as a critical hand of the true curve. A minimum that only chords have is
followed down the true curve to the minimum that it is part of, so that a merge with it is none, and
depths are judged by solved levels. What cannot be solved is left as the polygon has it and named.
[docs/theory.md, Sec. 4]
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from icage.arrays import FloatArray
from icage.cage import Cage, GraspMinimum, Puncture
from icage.discs.critical import Critical, CriticalHands
from icage.tolerance import DEPTH_CUT, DEPTH_ROUGH, LEVEL

SAME = 1e-7
"""[diameter] Two solved minima whose fingers are this near are one."""

_FAR = 0.05
"""[1] A solved puncture whose level is further (relative) from the polygon's is another one."""

REACH = 2.0
"""[sagitta] Features that a finger of the polygon's hand is this near to touching are tried."""


@dataclass(frozen=True, slots=True)
class TrueLevels:
    """Grasps and punctures of a cage of disc fingers on the true curve.

    ``sigma_first`` and ``sigma_max`` [unit] are None where nothing is joined or the hand never
    escapes. ``first_solved`` and ``max_solved`` say whether they are solved on the true curve; a
    level that is not is the polygon's. ``unsolved`` are ids of grasps that are not, ``origin`` has
    for each grasp the id of the polygon's grasp that led to it.
    """

    sigma_0: float
    sigma_first: float | None
    sigma_max: float | None
    grasps: tuple[GraspMinimum, ...]
    punctures: tuple[Puncture, ...]
    first_solved: bool
    max_solved: bool
    unsolved: tuple[int, ...]
    origin: tuple[int, ...]
    rough_first: float | None
    """sigma_first if only minima counted that are deeper than 1e-6 of the diameter."""
    polygon_first: float | None
    """The polygon's own level of the puncture at sigma_first."""
    polygon_joins: float | None
    """The least level at which the polygon joins to the target what the true curve joins to it at
    sigma_first or later: below it the polygon's cells are the target's. Less than
    ``polygon_first`` where several of its punctures are one on the true curve."""


def true_levels(
    critical: CriticalHands, cage: Cage, sagitta: float, target: Critical | None = None
) -> TrueLevels:
    """The levels on the true curve of a cage that a method has found on a polygon.

    Parameters
    ----------
    critical:
        Of the outline, the radius and the hand of the cage.
    cage:
        What ``LocalCage.cage`` gives for an inner or outer polygon: by either method, status not
        ``not_a_cage``.
    sagitta:
        [unit] How far the polygon lies off the true curve at most.
    target:
        The target on the true curve, where it is known.

    Notes
    -----
    About 0.5 ms for each grasp and puncture of the cage.
    """
    solving = _Solving(critical, cage, sagitta)
    return solving.levels(target)


class _Solving:
    def __init__(self, critical: CriticalHands, cage: Cage, sagitta: float) -> None:
        self._critical = critical
        self._cage = cage
        self._least_depth = DEPTH_CUT * critical.size
        self._reach = REACH * sagitta + 1e-7 * critical.size
        self._grasps: list[GraspMinimum] = []
        self._origin: list[int] = []
        self._unsolved: set[int] = set()
        """Places in ``_grasps`` of those that are not solved."""
        self._at: dict[int, int] = {}
        """Id of the polygon's grasp -> place in ``_grasps``."""

    def levels(self, target: Critical | None) -> TrueLevels:
        for grasp in self._cage.grasps:
            self._add(grasp, target if grasp.target else None)
        joined = {0}
        punctures: list[Puncture] = []
        solved: list[bool] = []
        last: tuple[Puncture, bool] | None = None
        polygon_level: dict[float, float] = {}
        joinings: list[tuple[float, float]] = []
        rough: list[float] = []
        for puncture in self._cage.punctures:
            if puncture.kind == "escape":
                last = self._puncture(puncture)
                polygon_level[last[0].sigma] = puncture.sigma
                continue
            new = sorted({self._at[k] for k in puncture.joins} - joined)
            if not new:
                continue
            joined |= set(new)
            found, is_solved = self._puncture(puncture)
            polygon_level.setdefault(found.sigma, puncture.sigma)
            joinings.append((found.sigma, puncture.sigma))
            lowest = min(self._grasps[k].sigma for k in new)
            if found.sigma - lowest <= self._least_depth:
                continue
            punctures.append(replace(found, joins=tuple(new)))
            if found.sigma - lowest > DEPTH_ROUGH * self._critical.size:
                rough.append(found.sigma)
            # one minimum that is there and deep enough makes it a puncture
            deep = [k for k in new if found.sigma - self._grasps[k].sigma > self._least_depth]
            solved.append(is_solved and any(k not in self._unsolved for k in deep))
        levels = self._settled(punctures, solved, last)
        ends = [] if levels.sigma_max is None else [levels.sigma_max]
        first = levels.sigma_first
        return replace(
            levels,
            rough_first=min([*rough, *ends], default=None),
            polygon_first=None if first is None else polygon_level[first],
            polygon_joins=None if first is None else min(
                polygon_level[first],
                *(own for true, own in joinings if true >= first * (1.0 - 2.0 * LEVEL)),
                math.inf,
            ),
        )  # fmt: skip

    def _add(self, grasp: GraspMinimum, known: Critical | None) -> None:
        """Solve a grasp and give it its place, that of another one if they are the same."""
        found = known or self._critical.minimum(grasp.contacts, self._reach)
        if found is None and not grasp.target:
            found = self._critical.below(grasp.contacts, self._reach)
        if found is None:
            self._unsolved.add(len(self._grasps))
        elif found.level == 0 or grasp.plateau is None:
            for place, other in enumerate(self._grasps):
                off = float(np.abs(other.contacts - found.contacts).max())
                if off <= SAME * self._critical.size:
                    self._at[grasp.id] = place
                    return
            grasp = replace(
                grasp,
                contacts=found.contacts,
                sigma=found.sigma,
                plateau=None,
                free_fingers=self._free(found.contacts),
            )
        self._at[grasp.id] = len(self._grasps)
        self._origin.append(grasp.id)
        self._grasps.append(grasp)

    def _puncture(self, puncture: Puncture) -> tuple[Puncture, bool]:
        found = self._critical.puncture(puncture.contacts, self._reach)
        if found is None or abs(found.sigma / puncture.sigma - 1.0) > _FAR:
            return puncture, False
        return replace(
            puncture,
            sigma=found.sigma,
            contacts=found.contacts,
            free_fingers=self._free(found.contacts),
        ), True

    def _free(self, contacts: FloatArray) -> tuple[int, ...]:
        return self._critical.free_fingers(contacts)

    def _settled(
        self, punctures: list[Puncture], solved: list[bool], last: tuple[Puncture, bool] | None
    ) -> TrueLevels:
        """Punctures in ascending order with ties merged, and the grasps joined below the escape."""
        top = np.inf if last is None else last[0].sigma * (1.0 - 2.0 * LEVEL)
        order = sorted(range(len(punctures)), key=lambda k: punctures[k].sigma)
        merged: list[Puncture] = []
        merged_solved: list[bool] = []
        joined_at = {0: self._grasps[0].sigma}
        for k in order:
            one = punctures[k]
            if one.sigma >= top:
                continue
            for place in one.joins:
                joined_at[place] = one.sigma
            if merged and one.sigma <= merged[-1].sigma * (1.0 + 2.0 * LEVEL):
                joins = (*merged[-1].joins, *one.joins)
                merged[-1] = replace(merged[-1], joins=joins)
                continue
            merged.append(one)
            merged_solved.append(solved[k])
        kept = sorted(
            joined_at,
            key=lambda p: (
                p != 0, round(self._grasps[p].sigma, 12), self._grasps[p].contacts.ravel().tolist()
            ),
        )  # fmt: skip
        number = {place: k for k, place in enumerate(kept)}
        grasps = tuple(replace(self._grasps[p], id=number[p], joined_at=joined_at[p]) for p in kept)
        merged = [replace(p, joins=tuple(sorted(number[j] for j in p.joins))) for p in merged]
        max_solved = last is not None and last[1]
        if last is not None:
            merged.append(last[0])
            merged_solved.append(max_solved)
        return TrueLevels(
            sigma_0=grasps[0].sigma,
            sigma_first=merged[0].sigma if merged else None,
            sigma_max=None if last is None else last[0].sigma,
            grasps=grasps,
            punctures=tuple(merged),
            first_solved=not merged or merged_solved[0],
            max_solved=last is None or max_solved,
            unsolved=tuple(number[p] for p in sorted(self._unsolved) if p in number),
            origin=tuple(self._origin[p] for p in kept),
            rough_first=None,
            polygon_first=None,
            polygon_joins=None,
        )
