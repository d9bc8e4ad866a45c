r"""Discs on true curves against fine polygons: random targets, radius 1 to 8 % of the diameter.

    python -m benchmarks.sweeps.true_levels --targets 330 --seed 23 \
        --json benchmarks/sweeps/true_levels.json

Told of each target: whether it fell back on polygons, whether sigma_max lies between the levels of
the inner and the outer polygon of 48 segments a quadrant, and whether sigma_first is further from
theirs than 7e-4. There every minimum that a polygon joins to the target before the plan's
sigma_first is followed down the true curve: ``missed`` counts those that do not end in the target.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

import numpy as np

from icage.cage import Cage
from icage.cells.method import CELLS, CellsLocalCage
from icage.discs.critical import CriticalHands
from icage.discs.curve import TrueCurve
from icage.errors import GraspError
from icage.outline import Outline
from icage.planner import plan
from tests.oracles.targets import random_target

SEGMENTS = 48
ROUNDING = 1e-9
FAR = 7e-4
"""[1] sigma_first of a polygon of 48 segments may be this far off (relative)."""


def polygons(cage: Cage, curve: TrueCurve) -> list[CellsLocalCage | None]:
    """What the cells find on the inner and the outer polygon."""
    chord = curve.radius * np.pi / SEGMENTS / cage.outline.diameter
    on = curve.on_arcs(cage.contacts)
    reach, turn = (chord, 10.0 * chord) if len(on) else (1e-5, 1e-3)
    return [
        CELLS.local_cage(polygon, cage.hand, cage.contacts, max(1e-5, reach), max(1e-3, turn))
        for polygon in (curve.inner(SEGMENTS, on), curve.outer(SEGMENTS, on))
    ]


def missed(cage: Cage, curve: TrueCurve, found: list[CellsLocalCage | None]) -> int:
    """Minima joined before sigma_first that do not end in the target on the true curve."""
    critical = CriticalHands(cage.outline, curve.radius, cage.hand)
    reach = 2.0 * curve.sagitta(SEGMENTS)
    first = np.inf if cage.sigma_first is None else cage.sigma_first
    count = 0
    for local_cage in found:
        if local_cage is None:
            continue
        for grasp in local_cage.cage(cage.contacts, cage.outline, curve.radius).grasps:
            if grasp.target or grasp.joined_at >= first * (1.0 - 1e-5):
                continue
            end = critical.minimum(grasp.contacts, reach) or critical.below(grasp.contacts, reach)
            far = np.inf if end is None else float(np.abs(end.contacts - cage.contacts).max())
            count += far > 1e-7 * cage.outline.diameter
    return count


def judge(seed: int, number: int) -> dict[str, object] | None:
    """One target; None if a contact stands in a pocket that the fingers close."""
    rng = np.random.default_rng([seed, number])
    target = random_target(rng, radius=float(rng.uniform(0.01, 0.08)))
    try:
        cage = plan(Outline(target.vertices), target.contacts, target.radius)
    except GraspError:
        return None
    row: dict[str, object] = {"number": number, "family": target.family, "status": cage.status}
    if cage.status == "not_a_cage":
        return row
    curve = TrueCurve.of(cage.outline, target.radius)
    found = polygons(cage, curve)
    level = np.inf if cage.sigma_max is None else cage.sigma_max
    first = np.inf if cage.sigma_first is None else cage.sigma_first
    low, high = (np.nan if f is None else f.sigma_max for f in found)
    row["bracket_only"] = any("not solved" in w for w in cage.warnings)
    row["outside"] = bool(low > level * (1.0 + ROUNDING) or level > high * (1.0 + ROUNDING))
    if cage.sigma_max_lower and cage.sigma_max_upper:
        row["width"] = cage.sigma_max_upper / cage.sigma_max_lower - 1.0
    off = [f.sigma_first != first and abs(f.sigma_first / first - 1.0) > FAR for f in found if f]
    row["first_differs"] = any(off)
    row["missed"] = missed(cage, curve, found) if any(off) else 0
    return row


def main() -> int:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--targets", type=int, default=330)
    parser.add_argument("--first", type=int, default=0, help="number of the first target")
    parser.add_argument("--seed", type=int, default=23)
    parser.add_argument("--json", type=Path, help="write the figures")
    options = parser.parse_args()
    rows = [
        row
        for k in range(options.first, options.first + options.targets)
        if (row := judge(options.seed, k)) is not None
    ]
    widths = [float(str(r["width"])) for r in rows if r.get("width") is not None]
    summary = {
        "seed": options.seed,
        "planned": len(rows),
        "not_a_cage": sum(r["status"] == "not_a_cage" for r in rows),
        "bracket_only": sum(bool(r.get("bracket_only")) for r in rows),
        "outside": sum(bool(r.get("outside")) for r in rows),
        "first_differs": [r["number"] for r in rows if r.get("first_differs")],
        "missed": sum(int(str(r.get("missed", 0))) for r in rows),
        "width_median": float(np.median(widths)),
        "width_max": max(widths),
    }
    print(summary)
    if options.json is not None:
        options.json.write_text(json.dumps(summary, indent=1) + "\n")
    return 1 if summary["outside"] or summary["missed"] else 0


if __name__ == "__main__":
    sys.exit(main())
