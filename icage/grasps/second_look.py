"""Grasps ranked by what only a plan can tell: the best by sigma_first planned, one after another.

What is aimed at is a level that is never above sigma_first, so the candidates are looked at in the
order of that bound, until it says that no other can be among the best ideas. Then the best are
moved, each trial planned again. Our own; the simplex is that of [NelderMead1965].
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import minimize  # pyright: ignore[reportUnknownVariableType]

from icage.arrays import FloatArray, IntArray
from icage.cage import Cage
from icage.grasps.crew import Crew
from icage.grasps.evaluator import GraspEvaluator
from icage.grasps.findings import Findings, distinct, groups
from icage.grasps.planned import planned_or_why
from icage.grasps.scores import level_of
from icage.grasps.stages import Stages
from icage.outline import Outline

_NEAR = 0.004
"""[diameter] Candidates nearer to a better one are not looked at: moving the best makes up."""

_IDEAS = 10
"""Ideas that have to be better than what is left."""

_MOST_PLANNED = (6000, 600)
"""Candidates that are planned, of points and of discs; ..."""

_BATCH = 16
"""... so many between two looks at the best."""

_SLACK = (1.0, 1.02)
"""By how much the bound may be too low, of points and of discs, whose levels are of polygons."""

_ROUNDS = ((0.02, 40), (0.003, 30))
"""[diameter] Size of the first simplex, and candidates of each climb."""

_PLANNING, _MOVING = "planning the best", "moving the best"
"""Stages of the search."""

_CLIMBS = (8, 4)
"""Ideas that climb, of points and of discs."""


class SecondLook:
    """What has been planned so far; it may be ended at any time.

    Attributes
    ----------
    search:
        The stages that have found the candidates.
    judged:
        Grasps with their true levels, as they came.
    left_out:
        Candidates that were not planned although they might be among the best.
    """

    def __init__(self, search: Stages) -> None:
        self.search = search
        self.judged: list[Findings] = []
        self.left_out = 0

    def run(self, crew: Crew) -> None:
        """Plan the candidates and move the best; ``OutOfTimeError`` and Ctrl-C may end it."""
        crew.start_again()
        self._in_order(crew)
        best = Findings.together(self.judged).best_first()
        for stride, steps in _ROUNDS:
            best = self._climbs(crew, best, stride, steps)

    def best_first(self) -> Findings:
        """What there is."""
        return Findings.together(self.judged).best_first()

    @property
    def _discs(self) -> bool:
        return self.search.radius > 0.0

    def _in_order(self, crew: Crew) -> None:
        found = self.search.best_first()
        size = self.search.outline.diameter
        found = found.of(np.argsort(-found.score, kind="stable"))
        found = found.of(distinct(found.contacts, _NEAR * size))
        bound = found.score * _SLACK[self._discs]
        most = _MOST_PLANNED[self._discs]
        total = min(most, len(found))
        for begin in range(0, total, _BATCH):
            kept = self.best_first()
            self.judged = [kept]
            ideas = groups(kept.contacts, size, _IDEAS)
            if len(ideas) == _IDEAS and bound[begin] <= kept.score[ideas[-1][0]]:
                return
            rows = list(range(begin, min(begin + _BATCH, total)))
            planned = crew.map(lambda row: self._planned(found, row), rows, _PLANNING, begin, total)
            for one in planned:
                if one is not None:
                    self._keep(crew, [one])
        self.left_out = len(found) - total

    def _climbs(self, crew: Crew, best: Findings, stride: float, steps: int) -> Findings:
        """Where the best of each idea has come to."""
        evaluator = self.search.used[-1]
        size = self.search.outline.diameter
        ideas = groups(best.contacts, size, _CLIMBS[self._discs])
        starts = best.of(np.array([int(group[0]) for group in ideas], np.int64))
        triples, points = (
            evaluator.on_features(starts) if self._discs else (starts.triples, starts.points)
        )
        ways = list(range(len(triples)))
        reached: list[Findings] = [starts]
        for climbed in crew.map(
            lambda k: self._climbed(evaluator, triples[k], points[k], stride * size, steps),
            ways, _MOVING,
        ):  # fmt: skip
            self._keep(crew, climbed)
            reached += climbed
        return Findings.together(reached).best_first()

    def _climbed(
        self, evaluator: GraspEvaluator, triple: IntArray, start: FloatArray, stride: float,
        steps: int,
    ) -> list[Findings]:  # fmt: skip
        """All grasps that a simplex from a point (2,) has tried."""
        tried: list[Findings] = []

        def loss(p: FloatArray) -> float:
            there = evaluator.grasps(triple[None], np.ascontiguousarray(p)[None])
            one = self._planned(there, 0) if len(there) else None
            if one is None:
                return 0.0
            tried.append(one)
            return -float(one.score[0])

        simplex = start + stride * np.array([[0.0, 0.0], [1.0, 0.3], [-0.3, 1.0]])
        minimize(
            loss, start, method="Nelder-Mead",
            options={"initial_simplex": simplex, "maxfev": steps, "xatol": 0.0, "fatol": 0.0},
        )  # fmt: skip
        return tried

    def _planned(self, found: Findings, row: int) -> Findings | None:
        """One of them with its true level, None if it is no cage or not as deep as wanted."""
        wanted = self.search.wanted
        cage = _cage(self.search.outline, self.search.radius, found.contacts[row])
        if cage is None:
            return None
        level = min(level_of(cage, wanted), wanted.limits.sigma_most)
        if level - cage.sigma_0 < wanted.tolerance:
            return None
        one = found.of(np.array([row], np.int64))
        return Findings(
            one.triples, one.points, cage.contacts[None], np.array([cage.sigma_0]),
            np.array([level]), one.cells,
        )  # fmt: skip

    def _keep(self, crew: Crew, some: list[Findings]) -> None:
        self.judged += some
        crew.note(some)


def _cage(outline: Outline, radius: float, contacts: FloatArray) -> Cage | None:
    cage = planned_or_why(outline, radius, contacts)
    return None if isinstance(cage, str) else cage
