"""A grasp made better by moving its point of concurrency: a simplex that climbs. [NelderMead1965]

The score is a minimum of smooth functions, without a slope on its ridges. Where a point leaves the
set of a feature, the next one along the outline takes its finger over.
"""

# pyright: basic
from __future__ import annotations

import numpy as np

from icage.grasps.kernels.evaluate import CAGE, Evaluated, evaluate, is_in_set
from icage.grasps.kernels.triples import contact_at
from icage.kernels.compiled import compiled

_SIMPLEX = np.array([[0.0, 0.0], [1.0, 0.3], [-0.3, 1.0]])
"""[stride] First corners."""

_CLOSE = 0.02
"""[stride] A simplex this small has arrived: another one begins smaller."""


@compiled
def taken_over(features, beside, f, px, py):
    """Feature f if P lies in its set, else the nearest one along the outline that can use P."""
    if is_in_set(features.planes, f, px, py):
        return f
    for k in range(beside.shape[1]):
        if is_in_set(features.planes, beside[f, k], px, py):
            return beside[f, k]
    return f


@compiled
def tried(pieces, origin, ring, features, beside, limits, sought, triple, px, py, own, x, y):
    """Evaluate one point; ``own`` (3,) becomes the features used, x and y (3,) the contacts."""
    for k in range(3):
        f = taken_over(features, beside, triple[k], px, py)
        own[k] = f
        if not is_in_set(features.planes, f, px, py):
            return 0, 0, 0.0, 0.0, 0
        at = contact_at(features.kind[f], features.point[f], features.normal[f], px, py)
        x[k], y[k] = at.x, at.y
    return evaluate(pieces, origin, ring, x, y, limits, sought)


@compiled
def tried_jobs(pieces, origin, ring, features, beside, triples, points, limits, sought):
    """``Evaluated`` of each triple (n, 3) with its point (n, 2), and the triples that were used."""
    n = len(triples)
    verdict = np.zeros(n, np.int64)
    contacts = np.zeros((n, 3, 2))
    levels = np.zeros((n, 2))
    first = np.zeros(n, np.int64)
    cells = np.zeros(n, np.int64)
    used = triples.copy()
    x = np.empty(3)
    y = np.empty(3)
    for row in range(n):
        verdict[row], first[row], levels[row, 0], levels[row, 1], cells[row] = tried(
            pieces, origin, ring, features, beside, limits, sought, triples[row],
            points[row, 0], points[row, 1], used[row], x, y,
        )  # fmt: skip
        for k in range(3):
            contacts[row, k, 0], contacts[row, k, 1] = x[k], y[k]
    return Evaluated(verdict, contacts, levels, first, cells), used


@compiled
def climb(pieces, origin, ring, features, beside, limits, sought, triple, start, stride, steps):
    """The best of ``steps`` candidates of a simplex of size ``stride`` [unit] from a point (2,).

    One row of ``Evaluated``, the features used (1, 3) and the point (1, 2).
    """
    verdict = np.zeros(1, np.int64)
    contacts = np.zeros((1, 3, 2))
    levels = np.zeros((1, 2))
    first = np.zeros(1, np.int64)
    cells = np.zeros(1, np.int64)
    used = np.empty((1, 3), np.int64)
    used[0] = triple
    point = np.empty((1, 2))
    point[0] = start
    top = 0.0
    own = np.empty(3, np.int64)
    x = np.empty(3)
    y = np.empty(3)
    at = np.empty((3, 2))
    value = np.zeros(3)
    trial = np.empty(2)
    spent = 0
    # 0, 1, 2: first corners; 3 reflected, 4 expanded, 5 outside, 6 inside, 7 and 8 shrunk
    stage = 0
    reflected = 0.0
    mirror = np.empty(2)
    while spent < steps:
        if stage < 3:
            trial[0] = start[0] + stride * _SIMPLEX[stage, 0]
            trial[1] = start[1] + stride * _SIMPLEX[stage, 1]
        elif stage == 3:
            order = np.argsort(-value, kind="mergesort")
            at, value = at[order], value[order]
            size = max(
                np.hypot(at[1, 0] - at[0, 0], at[1, 1] - at[0, 1]),
                np.hypot(at[2, 0] - at[0, 0], at[2, 1] - at[0, 1]),
            )
            if size < _CLOSE * abs(stride):
                break
            for k in range(2):
                trial[k] = at[0, k] + at[1, k] - at[2, k]
        elif stage == 4:
            for k in range(2):
                trial[k] = 1.5 * (at[0, k] + at[1, k]) - 2.0 * at[2, k]
        elif stage == 5:
            for k in range(2):
                trial[k] = 0.75 * (at[0, k] + at[1, k]) - 0.5 * at[2, k]
        elif stage == 6:
            for k in range(2):
                trial[k] = 0.25 * (at[0, k] + at[1, k]) + 0.5 * at[2, k]
        else:
            for k in range(2):
                trial[k] = 0.5 * (at[0, k] + at[stage - 6, k])
        verdict_here, first_here, sigma_0, level, visited = tried(
            pieces, origin, ring, features, beside, limits, sought, used[0], trial[0], trial[1],
            own, x, y,
        )  # fmt: skip
        spent += 1
        score = level / sigma_0 if verdict_here == CAGE else 0.0
        if score > top:
            top = score
            verdict[0], first[0] = verdict_here, first_here
            levels[0, 0], levels[0, 1] = sigma_0, level
            cells[0] = visited
            for k in range(3):
                contacts[0, k, 0], contacts[0, k, 1] = x[k], y[k]
                used[0, k] = own[k]
            point[0] = trial
        if stage < 3:
            at[stage] = trial
            value[stage] = score
            stage += 1
        elif stage == 3:
            reflected = score
            mirror[:] = trial
            if score > value[0]:
                stage = 4
            elif score > value[1]:
                at[2], value[2] = trial, score
            elif score > value[2]:
                stage = 5
            else:
                stage = 6
        elif stage == 4:
            if score > reflected:
                at[2], value[2] = trial, score
            else:
                at[2], value[2] = mirror, reflected
            stage = 3
        elif stage == 5 or stage == 6:
            if score > (reflected if stage == 5 else value[2]):
                at[2], value[2] = trial, score
                stage = 3
            else:
                stage = 7
        else:
            at[stage - 6], value[stage - 6] = trial, score
            stage = 8 if stage == 7 else 3
    return Evaluated(verdict, contacts, levels, first, cells), used, point, spent
