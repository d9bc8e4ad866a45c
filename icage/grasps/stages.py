"""The stages of a search for grasps: every triple, the promising ones, climbs, finer chords.

Every triple of features is tried, the promising ones at more points of concurrency and on the
features beside them, and the best are improved by moving their contacts continuously. A stage ends
by the cells that its searches have visited, not by time: the same on any machine. Our own.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from icage.arrays import FloatArray, IntArray
from icage.grasps.crew import Crew
from icage.grasps.evaluator import SEGMENTS, GraspEvaluator
from icage.grasps.findings import Findings, distinct, groups
from icage.grasps.wanted import Wanted
from icage.outline import Outline

_COARSE = 3
"""Segments of an arc per quadrant where discs are searched first: levels good to some 1e-3."""

_MOST_TRIPLES = 20_000
"""Triples that are tried, a random choice if there are more; how many are left out is told."""

_MOST_CELLS = 450_000
"""Cells that the searches from all triples may visit, and again those from other points: 2 to 5 s
on two cores. Triples that are not reached are told of with those left out."""

_IMPROVING_CELLS = 120_000
"""Cells for one round of improvement, by what its seeds have cost. Twice as many find nothing
better on any outline of the benchmark, with three seeds."""

_FEWEST = 4
"""Seeds that are improved whatever they cost."""

_MOST_FURTHER = 12_000
"""Candidates at other points of triples that had nothing where they were tried first."""

_FEW = 400
"""Triples up to which all are tried at other points."""

_PROMISING = 300
_AROUND = 8
"""Points round each of the promising ones, and ..."""

_BESIDE = 2
"""... points at which each finger is also put on the features beside its own."""

_OTHER_POINTS = 12
"""Points of concurrency of one triple, at most."""

_PARTS = 16
"""Shares into which the triples are cut for the threads, and ..."""

_SHARE = 64
"""... triples in a share whose other points are sought."""


class Round(NamedTuple):
    """A round of improvement: those that have come furthest go on to the next.

    Attributes
    ----------
    most:
        Grasps that are improved.
    stride:
        [diameter] Size of the first simplex.
    steps:
        Candidates of each.
    """

    most: int
    stride: float
    steps: int


_IMPROVED = (Round(64, 0.03, 40), Round(24, 0.008, 40), Round(10, 0.002, 40), Round(6, 0.0003, 40))

_MOST_STARTS = 6_000
"""Grasps, the best of all, among which the starts are sought."""

_BEST_IDEAS = 3
_MEMBERS = 10
"""Grasps of each of the best ideas that are improved once more."""

_RIDGES = (Round(24, 0.03, 40), Round(4, 0.001, 40))


class Polish(NamedTuple):
    """The best grasps of discs again, between finer chords.

    Attributes
    ----------
    segments:
        Of an arc per quadrant.
    ideas:
        That are compared there, with up to ``_OF_AN_IDEA`` grasps each.
    rounds:
        Of improvement there.
    others:
        The same for grasps that are unlike the best of their idea; none: they are left out.
    """

    segments: int
    ideas: int
    rounds: tuple[Round, ...]
    others: tuple[Round, ...] = ()


_OF_AN_IDEA = 4
"""Of one idea, so many of the best are compared between finer chords, and so many ..."""

_UNLIKE = 0.01
"""[diameter] ... further from each other than this: coarse chords are wrong by some 3 % at times,
and all that are nearer are wrong alike."""

_POLISHES = (
    Polish(8, 30, (Round(8, 0.003, 30), Round(4, 0.0005, 30)), (Round(4, 0.003, 30),)),
    Polish(SEGMENTS, 3, (Round(3, 0.0003, 30),)),
)
"""Levels are good to 1e-4 at 8 segments; ``plan`` has the last word."""


class Stages:
    """The stages of one search; what they find is kept as they go."""

    def __init__(
        self, outline: Outline, radius: float, wanted: Wanted, rng: np.random.Generator
    ) -> None:
        self.outline, self.radius, self.wanted, self.rng = outline, radius, wanted, rng
        self.triples = self.left_out = 0
        self.found: list[Findings] = []
        self.finer: list[list[Findings]] = []
        """What was found between finer chords, the finest first."""
        self.used: list[GraspEvaluator] = []

    @property
    def broken_off(self) -> int:
        """Searches that were too large."""
        return sum(evaluator.broken_off for evaluator in self.used)

    def best_first(self) -> Findings:
        """What there is: grasps compared between finer chords come first."""
        parts = [*self.finer, self.found]
        return Findings.together([_best(part) for part in parts])

    def run(self, crew: Crew) -> None:
        """All stages; ``OutOfTimeError`` and Ctrl-C may end them."""
        evaluator = self._evaluator(_COARSE if self.radius > 0.0 else SEGMENTS)
        self._every_triple(evaluator, crew)
        self._promising(evaluator, crew)
        self._improve(evaluator, crew, self._starts(), _IMPROVED, "improving", self.found)
        self._improve(evaluator, crew, self._ridges(), _RIDGES, "other ridges", self.found)
        if self.radius > 0.0:
            self._between_finer_chords(crew)

    def _evaluator(self, segments: int) -> GraspEvaluator:
        self.used.append(GraspEvaluator(self.outline, self.radius, self.wanted, segments))
        return self.used[-1]

    def _every_triple(self, evaluator: GraspEvaluator, crew: Crew) -> None:
        """Each once, and at other points where it has nothing there."""
        shares = list(
            crew.map(lambda part: evaluator.triples(part, _PARTS), list(range(_PARTS)), "triples")
        )
        triples = np.concatenate([t for t, _ in shares])
        points = np.concatenate([p for _, p in shares])
        self.triples = len(triples)
        self.left_out = max(0, self.triples - _MOST_TRIPLES)
        if self.left_out:
            use = np.sort(self.rng.choice(self.triples, _MOST_TRIPLES, replace=False))
            triples, points = triples[use], points[use]
        triples, points = evaluator.shaped(triples, points)
        # in any order, for the case that not all are reached
        mixed = self.rng.permutation(len(triples))
        triples, points = triples[mixed], points[mixed]
        rows = crew.grasps(evaluator, triples, points, "every triple", self.found, _MOST_CELLS)
        self.left_out += len(triples) - crew.tried
        triples, points = triples[: crew.tried], points[: crew.tried]
        without = np.ones(len(triples), dtype=bool)
        without[rows] = len(triples) <= _FEW
        again = np.flatnonzero(without)
        if not len(again):
            return
        most = max(1, min(_OTHER_POINTS, _MOST_FURTHER // len(again)))
        if len(again) > _MOST_FURTHER:
            again = np.sort(self.rng.choice(again, _MOST_FURTHER, replace=False))
        chunks = [again[k : k + _SHARE] for k in range(0, len(again), _SHARE)]

        def further(chunk: IntArray) -> tuple[IntArray, FloatArray]:
            each = [evaluator.further(triples[k], most) for k in chunk]
            return np.concatenate([t for t, _ in each]), np.concatenate([p for _, p in each])

        more = list(crew.map(further, chunks, "other points"))
        crew.grasps(
            evaluator,
            *evaluator.shaped(np.concatenate([t for t, _ in more]),
                              np.concatenate([p for _, p in more])),
            "elsewhere", self.found, _MOST_CELLS,
        )  # fmt: skip

    def _promising(self, evaluator: GraspEvaluator, crew: Crew) -> None:
        """Round the best, at several scales, and on the features beside theirs."""
        best = _best(self.found, _PROMISING)
        if not len(best):
            return
        size = self.outline.diameter
        scale = size * np.resize(np.array([0.02, 0.05, 0.1, 0.2]), (_AROUND, 1))
        shift = scale * self.rng.standard_normal((len(best), _AROUND, 2))
        points = (best.points[:, None] + shift).reshape(-1, 2)
        beside = evaluator.beside
        triples = [np.repeat(best.triples, _AROUND, axis=0)]
        where = [points]
        for finger in range(best.triples.shape[1]):
            other = best.triples.copy()
            for along in range(min(_BESIDE, beside.shape[1])):
                other[:, finger] = beside[best.triples[:, finger], along]
                triples.append(other.copy())
                where.append(best.points + 0.02 * size * self.rng.standard_normal((len(best), 2)))
        crew.grasps(
            evaluator, np.concatenate(triples), np.concatenate(where), "promising ones", self.found,
            0.6 * _MOST_CELLS,
        )  # fmt: skip

    def _starts(self) -> Findings:
        """Where the improvement starts: the best of every idea, then those of other triples."""
        best, most = _best(self.found, _MOST_STARTS), _IMPROVED[0].most
        ideas = [int(group[0]) for group in groups(best.contacts, self.outline.diameter, most // 2)]
        _, triples = np.unique(np.sort(best.triples, axis=1), axis=0, return_index=True)
        others = [k for k in np.sort(triples).tolist() if k not in ideas]
        return best.of(np.array((ideas + others)[:most], np.int64))

    def _ridges(self) -> Findings:
        """Other starts for the best ideas, which may have several ridges.

        The first of them have climbed to one place: these are from all over the better half.
        """
        best = _best(self.found)
        ideas = groups(best.contacts, self.outline.diameter, _BEST_IDEAS)
        rows = [k for g in ideas for k in g[1 : 1 + len(g) // 2 : 1 + len(g) // (2 * _MEMBERS)]]
        return best.of(np.array(rows, np.int64))

    def _between_finer_chords(self, crew: Crew) -> None:
        """The best grasps of discs again where their levels are better, and polished there."""
        best, size = _best(self.found), self.outline.diameter
        for polish in _POLISHES:
            if not len(best):  # none was left between the last chords
                return
            evaluator = self._evaluator(polish.segments)
            fine: list[Findings] = []
            self.finer.insert(0, fine)
            ideas = groups(best.contacts, size, polish.ideas)
            first = [group[:_OF_AN_IDEA] for group in ideas]
            unlike = [
                group[distinct(best.contacts[group], _UNLIKE * size)][:_OF_AN_IDEA]
                for group in ideas
            ]
            rows = np.concatenate(first)
            stage = f"polishing, {polish.segments} chords"
            self._polish(evaluator, crew, best.of(rows), polish.rounds, stage, fine)
            rows = np.setdiff1d(np.concatenate(unlike), rows)
            if len(rows) and polish.others:
                self._polish(
                    evaluator, crew, best.of(rows), polish.others, f"{stage}, others", fine
                )
            best = _best(fine)

    def _polish(
        self, evaluator: GraspEvaluator, crew: Crew, some: Findings, rounds: tuple[Round, ...],
        stage: str, keep: list[Findings],
    ) -> None:  # fmt: skip
        """Compare some grasps again, and improve the best of them."""
        again: list[Findings] = []
        triples, points = evaluator.on_features(some)
        crew.grasps(evaluator, triples, points, stage, again)
        keep += again
        found = _best(again)
        seeds = [g[0] for g in groups(found.contacts, self.outline.diameter, rounds[0].most)]
        best = found.of(np.array(seeds, np.int64))
        self._improve(evaluator, crew, best, rounds, stage, keep)

    def _improve(
        self, evaluator: GraspEvaluator, crew: Crew, seeds: Findings,
        rounds: tuple[Round, ...], stage: str, keep: list[Findings],
    ) -> None:  # fmt: skip
        """Move the contacts of the seeds; what they have become goes on to the next round."""
        size = self.outline.diameter
        for number, (most, stride, steps) in enumerate(rounds, 1):
            best = seeds.best_first()
            # many have come to one place
            rows = distinct(best.contacts, 0.3 * stride * size)[:most]
            cost = np.cumsum(best.cells[rows]) * steps
            seeds = best.of(rows[: max(_FEWEST, int(np.sum(cost <= _IMPROVING_CELLS)))])

            # a simplex may miss a ridge that its mirror image finds: the first are sent out twice
            ways = [(row, 1.0) for row in range(len(seeds))]
            ways += [(row, -1.0) for row in range(min((len(seeds) + 1) // 2, most // 3))]

            def climbed(
                way: tuple[int, float], seeds: Findings = seeds, stride: float = stride,
                steps: int = steps,
            ) -> tuple[Findings, int]:  # fmt: skip
                row, sign = way
                return evaluator.climbed(
                    seeds.triples[row], seeds.points[row], sign * stride * size, steps
                )

            told = f"{stage} ({number} of {len(rounds)})"
            seeds = Findings.together(list(crew.climbs(climbed, ways, told, keep)))


def _best(parts: list[Findings], most: int | None = None) -> Findings:
    """The best of all that was found so far, best first."""
    best = Findings.together(parts).best_first()
    return best if most is None else best.of(np.arange(min(most, len(best))))
