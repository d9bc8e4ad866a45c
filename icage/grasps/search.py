"""Good target grasps of an outline: all triples of contacts that squeeze, the best made better.

On real tools most immobilizing grasps have useless cages, so enumeration alone is not enough:
every triple of features is tried, the promising ones at more points of concurrency, and the best
are improved by moving their contacts continuously. Our own; the sets are those of [Bunis2018,
Sec. VII-A] with the squeezing test.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from multiprocessing import get_context
from typing import Literal, TypeAlias

import numpy as np
from scipy.optimize import minimize

from icage.arrays import FloatArray, IntArray
from icage.cells.free_space import FreeSpace, search
from icage.cells.largest_sigma import largest_sigma_in
from icage.cells.target import contacts_as_configuration, find_target
from icage.discs.offsets import offsets
from icage.errors import GraspError, HandError, InputError
from icage.geometry.exterior import Pieces, exterior_pieces, shortest_side
from icage.geometry.near_frame import NearFrame
from icage.grasps.features import (
    EDGE,
    VERTEX,
    Features,
    balanced_triples,
    features_of,
    further_points,
)
from icage.hand import HandShape
from icage.kernels.locate import depth_inside
from icage.outline import Outline
from icage.tolerance import FREE_FINGER, NOT_A_CAGE

Aim: TypeAlias = Literal["first", "cage"]
"""What is ranked: sigma_first / sigma_0, or sigma_max / sigma_0."""

_SEGMENTS = 16
_WIDEST = 8.0
"""Longest over shortest side of the hands that are searched; beyond it they are poor hands."""

_FLATTEST = 0.05
"""Least height over longest side of the hands that are searched: the same."""

_SEARCH_LIMIT = 20_000
"""Cells after which the search from a candidate is broken off; how many were is told."""

_CHUNK = 64
_MOST_TRIPLES = 20_000
"""Triples that are tried, a random choice if there are more; how many are left out is told."""

_FURTHER = 12
"""Points of concurrency at which a triple is tried before it is given up."""

_FEW = 100
"""Triples up to which all are tried at so many points."""

_MORE_POINTS = 8
_PROMISING = 300
_IMPROVED = 32
_STEPS = 90

_SAME_PLACE = 0.02
"""[diameter] Grasps whose contacts are all nearer to each other than this are one."""


@dataclass(frozen=True, slots=True)
class Wanted:
    """Which grasps are looked for.

    ``aim`` is what is ranked; ``corners`` the least number of fingers in concave corners (three
    straight edges are of second-order immobility only); ``near`` = (phi_1, phi_2, within), [rad],
    keeps to hands of about one shape, read from any finger.
    """

    aim: Aim = "first"
    corners: int = 0
    near: tuple[float, float, float] | None = None

    def shape_error(self, hand: HandShape) -> FloatArray:
        """Difference (phi_1, phi_2) from the wanted shape in the best of the three readings."""
        if self.near is None:
            return np.zeros(2)
        phis = np.array([hand.relabelled(first).phi for first in range(3)])
        errors = phis - np.array(self.near[:2])
        return errors[int(np.argmin(np.abs(errors).max(axis=1)))]

    def allows(self, hand: HandShape) -> bool:
        """Whether the hand has about the wanted shape."""
        if self.near is None:
            return True
        return bool(np.abs(self.shape_error(hand)).max() <= self.near[2])


@dataclass(frozen=True, slots=True)
class Candidate:
    """A grasp and its levels as found on the polygon that was searched, [unit]."""

    contacts: FloatArray
    triple: tuple[int, int, int]
    """Contact features (see Features), counterclockwise."""
    sigma_0: float
    sigma_first: float
    sigma_max: float
    score: float


@dataclass(frozen=True, slots=True)
class Ranking:
    """Everything that was found, best first, and what was not looked at.

    ``candidates`` may be near each other. ``broken_off`` counts grasps whose search was larger than
    allowed, ``triples_left_out`` those of all ``triples`` of contact features that were not drawn.
    """

    candidates: tuple[Candidate, ...]
    triples: int
    triples_left_out: int
    broken_off: int


_Job: TypeAlias = tuple[IntArray, FloatArray]
_Found: TypeAlias = tuple[Candidate | None, FloatArray]


class GraspEvaluator:
    """One outline, cut into pieces once for all hands that are tried on it."""

    def __init__(self, outline: Outline, radius: float, wanted: Wanted) -> None:
        self.radius = radius
        self.wanted = wanted
        self.broken_off = 0
        self.triples = self.triples_left_out = 0
        self.outline = offsets(outline, radius, _SEGMENTS).inner if radius > 0.0 else outline
        chord = 2.1 * radius * np.sin(0.25 * np.pi / _SEGMENTS)
        self.features: Features = features_of(self.outline, longer_than=float(chord))
        self.apart = max(2.02 * radius, 1e-3 * outline.diameter)
        self._pieces: Pieces
        widest = HandShape(complex(0.5, (_WIDEST**2 - 0.25) ** 0.5))
        self._pieces, self._origin = exterior_pieces(self.outline, widest)

    def evaluate(
        self, contacts: FloatArray, triple: Iterable[int] = (-1, -1, -1)
    ) -> Candidate | None:
        """The grasp next to these contacts and its levels, None if no cage (or a poor hand)."""
        try:
            hand = HandShape.from_contacts(contacts)
        except HandError:
            return None
        if not self.wanted.allows(hand):
            return None
        sides = [1.0, abs(hand.z_3), abs(hand.z_3 - 1.0)]
        longest = max(sides)
        if longest > _WIDEST * min(sides) or hand.z_3.imag < _FLATTEST * longest**2:
            return None
        if float(np.hypot(*(contacts[1] - contacts[0]))) * shortest_side(hand) < self.apart:
            return None
        free_space = FreeSpace.of_pieces(self.outline, hand, self._pieces, self._origin)
        target = find_target(free_space, contacts_as_configuration(free_space, contacts))
        if target is None or target.plateau is not None:
            return None
        own = free_space.contacts(target.at)
        if self._leaves_a_finger_free(own):
            return None
        found = search(free_space, target.cell, target.sigma_0, limit=_SEARCH_LIMIT)
        if found.gave_up:
            self.broken_off += 1
            return None
        top = largest_sigma_in(found) if found.never_escapes else found.level
        first = min(found.sigma_first(), top)
        if top / target.sigma_0 - 1.0 < NOT_A_CAGE:
            return None
        score = (first if self.wanted.aim == "first" else top) / target.sigma_0
        a, b, c = triple
        return Candidate(own, (a, b, c), target.sigma_0, first, top, score)

    def _leaves_a_finger_free(self, contacts: FloatArray) -> bool:
        """Where two fingers already hold: the best grasps of three lie beside such ones."""
        middle = contacts.mean(axis=0)
        depth = depth_inside(self.outline.vertices - middle, contacts - middle, 0.0)
        return float(depth.min()) < -FREE_FINGER * self.outline.diameter

    def at(self, triple: IntArray, p: FloatArray) -> Candidate | None:
        """The grasp of three features whose lines of force meet at P."""
        if not self.features.allows(triple, p):
            return None
        return self.evaluate(self.features.contacts(triple, p), (int(k) for k in triple))

    def elsewhere(self, triple: IntArray) -> list[_Found]:
        """The grasps of a triple at a few points of concurrency all over its set."""
        fair = (_WIDEST, _FLATTEST)
        jobs = further_points(self.features, self.outline, self.apart, triple, fair)
        few = np.linspace(0, len(jobs) - 1, min(_FURTHER, len(jobs))).round().astype(int)
        return [(self.at(*jobs[k]), jobs[k][1]) for k in few]

    def jobs(self, rng: np.random.Generator) -> list[_Job]:
        """A triple of features and a point of concurrency each: where the search starts.

        All triples that can balance, or a random choice of ``_MOST_TRIPLES`` of them.
        """
        triples, points = balanced_triples(self.features, self.outline, self.apart)
        corners = (self.features.kind[triples] == VERTEX).sum(axis=1)
        use = np.flatnonzero(corners >= self.wanted.corners)
        self.triples = len(use)
        self.triples_left_out = max(0, len(use) - _MOST_TRIPLES)
        if self.triples_left_out:
            use = np.sort(rng.choice(use, _MOST_TRIPLES, replace=False))
        jobs: list[_Job] = list(zip(triples[use], points[use], strict=True))
        if self.wanted.near is None:
            return jobs
        solved = [(triple, self._shaped(triple, p)) for triple, p in jobs]
        return [(triple, p) for triple, p in solved if p is not None]

    def _shaped(self, triple: IntArray, p: FloatArray) -> FloatArray | None:
        """A point of concurrency near P that gives the wanted shape of hand (Gauss-Newton)."""
        step = 1e-6 * self.outline.diameter

        def error(q: FloatArray) -> FloatArray | None:
            try:
                hand = HandShape.from_contacts(self.features.contacts(triple, q))
            except HandError:
                return None
            return self.wanted.shape_error(hand)

        for _ in range(12):
            here = error(p)
            if here is None:
                return None
            if np.abs(here).max() < 1e-9:
                break
            ahead = [error(p + step * np.eye(2)[k]) for k in range(2)]
            if ahead[0] is None or ahead[1] is None:
                return None
            slope = np.column_stack([ahead[0] - here, ahead[1] - here]) / step
            move = np.linalg.lstsq(slope, -here, rcond=1e-6)[0]
            longest = 0.1 * self.outline.diameter
            p = p + move * min(1.0, longest / max(float(np.hypot(*move)), 1e-300))
        return p if self.features.allows(triple, p) else None

    def movable(self, triple: IntArray) -> bool:
        """Whether any contact of the triple can move (is on an edge)."""
        return bool((self.features.kind[triple] == EDGE).any())


_evaluator: GraspEvaluator | None = None


def _start_worker(outline: FloatArray, radius: float, wanted: Wanted) -> None:
    global _evaluator
    _evaluator = GraspEvaluator(Outline(outline), radius, wanted)


_Done: TypeAlias = tuple[list[_Found], int]
"""What came of a chunk of jobs, and how many searches were broken off in it."""


def _try_chunk(jobs: list[_Job]) -> _Done:
    assert _evaluator is not None
    before = _evaluator.broken_off
    found = [(_evaluator.at(triple, p), p) for triple, p in jobs]
    return found, _evaluator.broken_off - before


def _elsewhere_chunk(jobs: list[_Job]) -> _Done:
    """What each triple has anywhere: for those that have nothing where they were tried first."""
    assert _evaluator is not None
    before = _evaluator.broken_off
    found: list[_Found] = []
    for triple, p in jobs:
        good = _ranked(_evaluator.elsewhere(triple))
        found += good or [(None, p)]
    return found, _evaluator.broken_off - before


def _improve_chunk(jobs: list[_Job]) -> _Done:
    assert _evaluator is not None
    before = _evaluator.broken_off
    found = [improved(_evaluator, triple, p) for triple, p in jobs]
    return found, _evaluator.broken_off - before


def improved(evaluator: GraspEvaluator, triple: IntArray, start: FloatArray) -> _Found:
    """Move the contacts of a grasp by moving P: Nelder-Mead on the score, bounded steps."""
    best: list[_Found] = [(evaluator.at(triple, start), start)]
    size = evaluator.outline.diameter

    def loss(p: FloatArray) -> float:
        found = evaluator.at(triple, p)
        if found is None:
            return 1.0
        if best[0][0] is None or found.score > best[0][0].score:
            best[0] = (found, p.copy())
        return -found.score

    for step in (0.03, 0.004):
        p = best[0][1]
        simplex = p + size * step * np.array([[0.0, 0.0], [1.0, 0.3], [-0.3, 1.0]])
        minimize(
            loss, p, method="Nelder-Mead",
            options={"initial_simplex": simplex, "maxfev": _STEPS // 2, "xatol": 1e-6 * size},
        )  # fmt: skip
    return best[0]


Progress: TypeAlias = Callable[[str, int, int], None]


def _silent(_stage: str, _done: int, _total: int) -> None:
    """No progress report."""


def ranked_grasps(
    outline: Outline,
    *,
    finger_radius: float = 0.0,
    wanted: Wanted = Wanted(),
    rng: np.random.Generator,
    workers: int = 1,
    progress: Progress = _silent,
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
        Processes; the result does not depend on it.

    Raises
    ------
    GraspError:
        No immobilizing grasp was found.
    """
    frame = NearFrame.of(outline)
    outline = frame.outline_into(outline)
    evaluator = GraspEvaluator(outline, finger_radius, wanted)
    with _Workers(outline, finger_radius, wanted, workers, evaluator) as pool:
        jobs = evaluator.jobs(rng)
        found = pool.run(_try_chunk, jobs, "every triple", progress)
        few = len(jobs) <= _FEW
        without = [job for job, (c, _) in zip(jobs, found, strict=True) if few or c is None]
        found += pool.run(_elsewhere_chunk, without, "elsewhere", progress)
        ranked = _ranked(found)
        more: list[_Job] = []
        for candidate, p in ranked[:_PROMISING]:
            triple = np.array(candidate.triple)
            if evaluator.movable(triple):
                more += [(triple, q) for q in _around(p, evaluator, rng)]
        ranked = _ranked(found + pool.run(_try_chunk, more, "promising ones", progress))
        seeds: list[_Job] = [
            (np.array(c.triple), p) for c, p in _starts(ranked, 0.1 * evaluator.outline.diameter)
        ]
        better = pool.run(_improve_chunk, seeds, "improving", progress)
    best = [c for c, _ in _ranked(better + [(c, p) for c, p in ranked])]
    if not best:
        raise GraspError("no immobilizing three-finger grasp was found on this outline")
    return Ranking(
        tuple(replace(c, contacts=frame.back(c.contacts)) for c in best),
        evaluator.triples, evaluator.triples_left_out, pool.broken_off,
    )  # fmt: skip


def best_grasps(
    outline: Outline,
    *,
    finger_radius: float = 0.0,
    top: int = 10,
    wanted: Wanted = Wanted(),
    rng: np.random.Generator,
    workers: int = 1,
    progress: Progress = _silent,
) -> list[Candidate]:
    """The ``top`` best of ``ranked_grasps``, no two with nearly the same contacts."""
    if top < 1:
        raise InputError(f"top = {top}; at least 1 is needed")
    ranking = ranked_grasps(
        outline, finger_radius=finger_radius, wanted=wanted, rng=rng, workers=workers,
        progress=progress,
    )  # fmt: skip
    kept: list[Candidate] = []
    for candidate in ranking.candidates:
        if not any(same_place(outline, candidate.contacts, other.contacts) for other in kept):
            kept.append(candidate)
            if len(kept) == top:
                break
    return kept


def _around(p: FloatArray, evaluator: GraspEvaluator, rng: np.random.Generator) -> FloatArray:
    """Points of concurrency near P, at several scales."""
    scale = evaluator.outline.diameter * np.array([0.02, 0.05, 0.1, 0.2])
    size = np.resize(scale, _MORE_POINTS)
    return p + size[:, None] * rng.standard_normal((_MORE_POINTS, 2))


def _ranked(found: Iterable[_Found]) -> list[tuple[Candidate, FloatArray]]:
    good = [(c, p) for c, p in found if c is not None]
    return sorted(good, key=lambda pair: (-pair[0].score, pair[0].triple))


def _starts(
    ranked: list[tuple[Candidate, FloatArray]], apart: float
) -> list[tuple[Candidate, FloatArray]]:
    """Where the improvement starts: the best of every triple, then others of it if room is left.

    A triple may hold in several places with nothing between; P of two starts are ``apart`` [unit].
    """
    first: dict[tuple[int, int, int], list[FloatArray]] = {}
    kept: list[tuple[Candidate, FloatArray]] = []
    others: list[tuple[Candidate, FloatArray]] = []
    for candidate, p in ranked:
        points = first.setdefault(candidate.triple, [])
        if all(float(np.hypot(*(p - q))) >= apart for q in points):
            (others if points else kept).append((candidate, p))
            points.append(p)
    return (kept + others)[:_IMPROVED]


def same_place(outline: Outline, a: FloatArray, b: FloatArray) -> bool:
    """Whether the contacts of two grasps all lie near each other (in any labelling)."""
    near = _SAME_PLACE * outline.diameter
    copies = (np.roll(a, k, axis=0) for k in range(len(a)))
    return any(float(np.hypot(*(c - b).T).max()) < near for c in copies)


class _Workers:
    """Chunks of jobs in order, in this process or in several."""

    def __init__(
        self,
        outline: Outline,
        radius: float,
        wanted: Wanted,
        workers: int,
        evaluator: GraspEvaluator,
    ) -> None:
        global _evaluator
        _evaluator = evaluator
        self.broken_off = 0
        self._pool: ProcessPoolExecutor | None = None
        if workers > 1:
            self._pool = ProcessPoolExecutor(
                workers, mp_context=get_context("spawn"), initializer=_start_worker,
                initargs=(outline.vertices, radius, wanted),
            )  # fmt: skip

    def __enter__(self) -> _Workers:
        return self

    def __exit__(self, *_: object) -> None:
        if self._pool is not None:
            self._pool.shutdown(cancel_futures=True)

    def run(
        self,
        work: Callable[[list[_Job]], _Done],
        jobs: list[_Job],
        stage: str,
        progress: Progress,
    ) -> list[_Found]:
        size = 1 if work is _improve_chunk else _CHUNK
        chunks = [jobs[k : k + size] for k in range(0, len(jobs), size)]
        results = self._pool.map(work, chunks) if self._pool else map(work, chunks)
        found: list[_Found] = []
        for done, broken_off in results:
            found += done
            self.broken_off += broken_off
            progress(stage, len(found), len(jobs))
        return found
