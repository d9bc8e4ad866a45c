"""The paper's own condition, against the joint query. [Bunis2018, Sec. III-B, Sec. VII-B]

"Each finger in its caging region and sigma < sigma_max" is necessary for a placement to be in the
cage. Is it sufficient? The regions are shadows of a set of hands, and a hand may stand in all three
shadows without being in the set. Here the condition is sampled and the query has the last word.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from icage.arrays import FloatArray
from icage.cage import Cage
from icage.cells.membership import VERDICTS, query
from icage.cells.regions import caging_regions
from icage.kernels.locate import depth_inside
from icage.region_points import region_points

_CHUNK = 20_000
_MOST_TRIES = 5_000_000

_BELOW_TOP = 1.0 - 1e-9
"""[1] Hands are drawn this far (relative) below sigma_max: at it the puncture opens."""


@dataclass(frozen=True, slots=True)
class ConditionReport:
    """Placements that meet the condition: how many, and what the query says of them.

    ``outside`` counts those that are not in the cage by verdict; ``..._open`` count those at
    sigma >= sigma_0 only. ``counterexample`` (4,): the one with sigma nearest to sigma_0.
    """

    tested: int
    tried: int
    in_cage: int
    tested_open: int
    in_cage_open: int
    outside: dict[str, int]
    counterexample: FloatArray | None

    @property
    def share_right(self) -> float:
        """[1] How often the condition is right."""
        return self.in_cage / self.tested if self.tested else float("nan")


def sample_condition(cage: Cage, count: int, rng: np.random.Generator) -> ConditionReport:
    """Draw up to ``count`` placements that meet the condition, uniform in dx dy d^2 w.

    Each finger is in the *inner* bound of its region, so that it is in the region for certain, and
    clear of the object. Bounded: fewer are tested where the condition is hard to meet.
    """
    inner = [region.geometry for region in caging_regions(cage) if region.bound == "inner"]
    for geometry in inner:
        shapely.prepare(geometry)
    top = np.inf if cage.sigma_max is None else cage.sigma_max * _BELOW_TOP
    z = cage.hand.z
    pairs = ((0, 1), (1, 2), (2, 0))
    i, j = min(pairs, key=lambda p: inner[p[0]].area * inner[p[1]].area / abs(z[p[1]] - z[p[0]]))
    k = 3 - i - j
    found: list[FloatArray] = []
    have = tried = 0
    while have < count and tried < _MOST_TRIES:
        f_i, f_j = (region_points(inner[f], rng, _CHUNK) for f in (i, j))
        tried += _CHUNK
        w = (f_j - f_i) / (z[j] - z[i])
        d = f_i - w * z[i]
        third = d + w * z[k]
        keep = (np.abs(w) < top) & shapely.contains_xy(inner[k], third.real, third.imag)
        rows = np.column_stack([d.real, d.imag, np.angle(w), np.abs(w)])[keep]
        fingers = cage.hand.fingers(rows).reshape(-1, 2)
        depth = depth_inside(cage.outline.vertices, fingers, cage.finger_radius)
        rows = rows[(depth.reshape(-1, len(z)) <= 0.0).all(axis=1)][: count - have]
        found.append(rows)
        have += len(rows)
    return _judged(cage, np.concatenate(found), tried)


def _judged(cage: Cage, rows: FloatArray, tried: int) -> ConditionReport:
    answers = query(cage, rows)
    wrong = np.flatnonzero(~answers.in_cage)
    names = [VERDICTS[int(v)] for v in answers.verdict[wrong]]
    near = np.abs(np.log(rows[wrong, 3] / cage.sigma_0))
    example = rows[wrong[np.argmin(near)]] if len(wrong) else None
    outside = {name: names.count(name) for name in sorted(set(names))}
    open_hand = rows[:, 3] >= cage.sigma_0
    return ConditionReport(
        tested=len(rows),
        tried=tried,
        in_cage=int(answers.in_cage.sum()),
        tested_open=int(open_hand.sum()),
        in_cage_open=int((answers.in_cage & open_hand).sum()),
        outside=outside,
        counterexample=example,
    )
