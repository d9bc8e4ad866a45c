"""Good target grasps of an outline: all triples of contacts that squeeze, the best made better.

On real tools most immobilizing grasps have useless cages, so enumeration alone is not enough:
every triple of features is tried, the promising ones at more points of concurrency, and the best
are improved by moving their contacts continuously. Our own; the sets are those of [Bunis2018,
Sec. VII-A] with the squeezing test.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from icage.arrays import FloatArray
from icage.errors import GraspError, InputError
from icage.geometry.near_frame import NearFrame
from icage.grasps.evaluator import GraspEvaluator, Job, best_first
from icage.grasps.wanted import Candidate, Wanted
from icage.grasps.workers import Progress, Workers, elsewhere_chunk, improve_chunk, try_chunk
from icage.outline import Outline

_ANY = Wanted()
"""Any grasp, by sigma_first / sigma_0."""

_FEW = 100
"""Triples up to which all are tried at so many points."""

_MORE_POINTS = 8

_PROMISING = 300

_IMPROVED = 32

_SAME_PLACE = 0.02
"""[diameter] Grasps whose contacts are all nearer to each other than this are one."""


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


def _silent(_stage: str, _done: int, _total: int) -> None:
    """No progress report."""


def ranked_grasps(
    outline: Outline,
    *,
    finger_radius: float = 0.0,
    wanted: Wanted = _ANY,
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
    with Workers(outline, finger_radius, wanted, workers, evaluator) as pool:
        jobs = evaluator.jobs(rng)
        found = pool.run(try_chunk, jobs, "every triple", progress)
        few = len(jobs) <= _FEW
        without = [job for job, (c, _) in zip(jobs, found, strict=True) if few or c is None]
        found += pool.run(elsewhere_chunk, without, "elsewhere", progress)
        ranked = best_first(found)
        more: list[Job] = []
        for candidate, p in ranked[:_PROMISING]:
            triple = np.array(candidate.triple)
            if evaluator.movable(triple):
                more += [(triple, q) for q in _around(p, evaluator, rng)]
        ranked = best_first(found + pool.run(try_chunk, more, "promising ones", progress))
        seeds: list[Job] = [
            (np.array(c.triple), p) for c, p in _starts(ranked, 0.1 * evaluator.outline.diameter)
        ]
        better = pool.run(improve_chunk, seeds, "improving", progress)
    best = [c for c, _ in best_first(better + [(c, p) for c, p in ranked])]
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
    wanted: Wanted = _ANY,
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
