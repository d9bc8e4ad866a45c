"""Good target grasps of an outline: all triples of contacts that squeeze, the best made better.

On real tools most immobilizing grasps have useless cages, so enumeration alone is not enough:
every triple of features is tried, the promising ones at more points of concurrency and on the
features beside them, and the best are improved by moving their contacts continuously. The search
may be stopped at any time and then has the best so far. Our own; the sets are those of [Bunis2018,
Sec. VII-A] with the squeezing test.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

import numpy as np

from icage.arrays import FloatArray, IntArray
from icage.errors import GraspError, InputError
from icage.geometry.near_frame import NearFrame
from icage.grasps.crew import Crew, OutOfTimeError, Progress
from icage.grasps.evaluator import SEGMENTS, GraspEvaluator
from icage.grasps.findings import Findings, distinct, groups
from icage.grasps.wanted import Candidate, Wanted
from icage.outline import Outline

_ANY = Wanted()
"""Any grasp, by sigma_first / sigma_0."""

_COARSE = 3
"""Segments of an arc per quadrant where discs are searched first: levels good to some 1e-3."""

_FINE = 8
"""... and where the best are compared and polished: good to 1e-4."""

_MOST_TRIPLES = 20_000
"""Triples that are tried, a random choice if there are more; how many are left out is told."""

_MOST_CELLS = 450_000
"""Cells that the searches from all triples may visit, and again those from other points: 2 to 5 s
on two cores. Triples that are not reached are told of with those left out."""

_IMPROVING_CELLS = 250_000
"""Cells for one round of improvement, by what its seeds have cost."""

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

_IMPROVED = ((64, 0.03, 40), (24, 0.008, 40), (10, 0.002, 40), (6, 0.0003, 40))
"""Grasps that are improved, by simplexes of which size [diameter], with how many candidates: those
that come furthest go on."""

_BEST_IDEAS = 3
_MEMBERS = 10
_RIDGES = ((24, 0.03, 40), (4, 0.001, 40))

_AGAIN = 120
"""Grasps of discs, found between coarse chords, that are compared between finer ones."""

_POLISHED = ((8, 0.003, 30), (4, 0.0005, 30))
_LAST = ((3, 0.0003, 30),)
"""Between the chords of ``SEGMENTS``; ``plan`` has the last word."""

Ended: TypeAlias = Literal["out of time", "interrupted"]


@dataclass(frozen=True, slots=True)
class Ranking:
    """Everything that was found, best first, and what was not looked at.

    Attributes
    ----------
    candidates:
        They may be near each other.
    triples, triples_left_out:
        Triples of contact features, and those of them that were not drawn.
    broken_off:
        Grasps whose search was larger than allowed.
    compared:
        Candidates that were looked at.
    ended:
        What ended the search before its own end, or None.
    """

    candidates: tuple[Candidate, ...]
    triples: int
    triples_left_out: int
    broken_off: int
    compared: int = 0
    ended: Ended | None = None


def _silent(_stage: str, _done: int, _total: int, _best: float | None) -> None:
    """No progress report."""


def ranked_grasps(
    outline: Outline,
    *,
    finger_radius: float = 0.0,
    wanted: Wanted = _ANY,
    rng: np.random.Generator,
    workers: int = 1,
    progress: Progress = _silent,
    seconds: float | None = None,
) -> Ranking:
    """All grasps that were found, best first.

    Parameters
    ----------
    finger_radius:
        Radius of disc fingers, [unit]; the search then runs on the inner offset polygon, so the
        levels are those of that polygon: plan the winners for certified ones.
    wanted:
        What is ranked and which grasps are looked at. aim "first" ranks by sigma_first / sigma_0,
        "cage" by sigma_max / sigma_0 (the largest sigma of the component for a hand that never
        escapes).
    workers:
        Threads; the result does not depend on their number.
    seconds:
        When to stop with what there is. Ctrl-C does the same. None: the search ends by itself.

    Raises
    ------
    GraspError:
        No immobilizing grasp within the limits was found.
    """
    frame = NearFrame.of(outline)
    outline = frame.outline_into(outline)
    search = _Search(outline, finger_radius, wanted, rng)
    ended: Ended | None = None
    with Crew(workers, progress, seconds) as crew:
        try:
            search.run(crew)
        except OutOfTimeError:
            ended = "out of time"
        except KeyboardInterrupt:
            ended = "interrupted"
    best = search.best_first()
    if not len(best):
        when = "" if ended is None else f" (the search was {ended})"
        raise GraspError(
            f"no immobilizing three-finger grasp was found on this outline{when}, within the "
            "limits of the hand and of where it may touch; wider limits may let some in"
        )
    return Ranking(
        tuple(replace(c, contacts=frame.back(c.contacts)) for c in best.candidates()),
        search.triples, search.left_out, search.broken_off, crew.compared, ended,
    )  # fmt: skip


class _Search:
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
        return Findings.together([Findings.together(part).best_first() for part in parts])

    def run(self, crew: Crew) -> None:
        """All stages; ``OutOfTimeError`` and Ctrl-C may end them."""
        segments = _COARSE if self.radius > 0.0 else SEGMENTS
        evaluator = GraspEvaluator(self.outline, self.radius, self.wanted, segments)
        self.used.append(evaluator)
        self._every_triple(evaluator, crew)
        self._promising(evaluator, crew)
        starts = self._starts(_IMPROVED[0][0])
        self._improve(evaluator, crew, starts, _IMPROVED, "improving", self.found)
        # the best ideas have several ridges: their other members start on these
        best = Findings.together(self.found).best_first()
        ideas = groups(best.contacts, self.outline.diameter, _BEST_IDEAS)
        # the first of them have climbed to one place: take them from all over the better half
        rows = [k for g in ideas for k in g[1 : 1 + len(g) // 2 : 1 + len(g) // (2 * _MEMBERS)]]
        again = best.of(np.array(rows, np.int64))
        self._improve(evaluator, crew, again, _RIDGES, "other ridges", self.found)
        if self.radius > 0.0:
            self._between_finer_chords(crew)

    def _every_triple(self, evaluator: GraspEvaluator, crew: Crew) -> None:
        """Each once, and at other points where it has nothing there."""
        parts = 16
        shares = list(
            crew.map(lambda part: evaluator.triples(part, parts), list(range(parts)), "triples")
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
        most = max(1, min(12, _MOST_FURTHER // len(again)))
        if len(again) > _MOST_FURTHER:
            again = np.sort(self.rng.choice(again, _MOST_FURTHER, replace=False))
        chunks = [again[k : k + 64] for k in range(0, len(again), 64)]

        def further(chunk: IntArray) -> tuple[IntArray, FloatArray]:
            each = [evaluator.further(triples[k], most) for k in chunk]
            return np.concatenate([t for t, _ in each]), np.concatenate([p for _, p in each])

        more = list(crew.map(further, chunks, "other points", 64))
        crew.grasps(
            evaluator,
            *evaluator.shaped(np.concatenate([t for t, _ in more]),
                              np.concatenate([p for _, p in more])),
            "elsewhere", self.found, _MOST_CELLS,
        )  # fmt: skip

    def _promising(self, evaluator: GraspEvaluator, crew: Crew) -> None:
        """Round the best, at several scales, and on the features beside theirs."""
        best = Findings.together(self.found).best_first()
        best = best.of(np.arange(min(_PROMISING, len(best))))
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

    def _starts(self, most: int) -> Findings:
        """Where the improvement starts: the best of every idea and of every triple, by turns."""
        best = Findings.together(self.found).best_first()
        best = best.of(np.arange(min(20 * _PROMISING, len(best))))
        size = self.outline.diameter
        ideas = [int(group[0]) for group in groups(best.contacts, size, most // 2)]
        _, triples = np.unique(np.sort(best.triples, axis=1), axis=0, return_index=True)
        others = [k for k in np.sort(triples).tolist() if k not in ideas]
        return best.of(np.array((ideas + others)[:most], np.int64))

    def _between_finer_chords(self, crew: Crew) -> None:
        """The best grasps of discs again where their levels are better, and polished there."""
        best = Findings.together(self.found).best_first()
        for segments, most, rounds, stage in (
            (_FINE, _AGAIN, _POLISHED, "polishing"), (SEGMENTS, 12, _LAST, "last polish"),
        ):  # fmt: skip
            evaluator = GraspEvaluator(self.outline, self.radius, self.wanted, segments)
            self.used.append(evaluator)
            ideas = groups(best.contacts, self.outline.diameter, most // 4)
            rows = np.concatenate([g[:4] for g in ideas]) if ideas else np.empty(0, np.int64)
            triples, points = evaluator.on_features(best.of(rows))
            fine: list[Findings] = []
            self.finer.insert(0, fine)
            crew.grasps(evaluator, triples, points, f"{stage}, to begin with", fine)
            again = Findings.together(fine).best_first()
            seeds = [g[0] for g in groups(again.contacts, self.outline.diameter, rounds[0][0])]
            self._improve(evaluator, crew, again.of(np.array(seeds, np.int64)), rounds, stage, fine)
            best = Findings.together(fine).best_first()

    def _improve(
        self, evaluator: GraspEvaluator, crew: Crew, seeds: Findings,
        rounds: tuple[tuple[int, float, int], ...], stage: str, keep: list[Findings],
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
            ) -> Findings:  # fmt: skip
                row, sign = way
                return evaluator.climbed(
                    seeds.triples[row], seeds.points[row], sign * stride * size, steps
                )

            told = f"{stage} ({number} of {len(rounds)})"
            seeds = Findings.together(list(crew.climbs(climbed, ways, told, steps, keep)))


def best_grasps(
    outline: Outline,
    *,
    finger_radius: float = 0.0,
    top: int = 10,
    wanted: Wanted = _ANY,
    rng: np.random.Generator,
    workers: int = 1,
    progress: Progress = _silent,
    seconds: float | None = None,
) -> list[Candidate]:
    """The ``top`` best of ``ranked_grasps``, each another idea (``icage.grasps.findings``)."""
    if top < 1:
        raise InputError(f"top = {top}; at least 1 is needed")
    ranking = ranked_grasps(
        outline, finger_radius=finger_radius, wanted=wanted, rng=rng, workers=workers,
        progress=progress, seconds=seconds,
    )  # fmt: skip
    contacts = np.array([c.contacts for c in ranking.candidates])
    return [ranking.candidates[int(group[0])] for group in groups(contacts, outline.diameter, top)]
