"""Placements inside the tolerance that ``icage place`` promises, closed in MuJoCo.

    python -m benchmarks.placements [--cases pliers,saw] [--closings 300] [--update-baseline]

For every case, with the opening known and with an error of it, and with friction where the planner
has a level for it: hands drawn inside the tolerance of the best placement, half of them with a
finger off by all of it, closed as `icage replay` closes, or with friction as `experiments.jams`
does. Without friction every closing has to end in the target; with friction the middle of the
fingers within 0.005 diameters and the hand within 0.02 rad of it, in the object's frame, which is
what the level is for. Cases with point fingers are closed and placed with discs
(`experiments.cases.with_discs`).
A case fails that has any other ending. [docs/decisions/0017-placement.md]
"""

from __future__ import annotations

import argparse
import json
import math
import sys
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from experiments.cases.with_discs import PhysicalCase, physical_case
from experiments.io.intervals import rate_upper, wilson
from experiments.jams.closings import close_from
from icage.arrays import BoolArray, FloatArray
from icage.cage import Cage
from icage.errors import InputError
from icage.formats.json_out import json_text
from icage.formats.load import load
from icage.kernels.compiled import machine_code_at_once
from icage.placing.best import place
from icage.placing.misplaced import draw_misplaced
from icage.tolerance import NEAR_POSITION, NEAR_TURN
from models import CASES
from models import FRICTION as FRICTION_CASES
from sim.closing.batch import close_many
from sim.closing.judge import OUTCOMES, judge
from sim.grip.stick import moved
from sim.world.config import SimConfig
from sim.world.scene import Scene

BASELINE = Path(__file__).with_name("placements.json")
NAMES = (
    "pliers", "saw", "wrench", "T_best", "L_best", "disc_hammer", "disc_Y", "pliers_best",
    "rand16_best", "handsaw_best", "triangle_eq_best", "hammer_best", "pliers_friction",
    "saw_friction", "wrench_friction",
)  # fmt: skip
FRICTION = (0.05, 0.2)
CLOSINGS = 300
SEED = 17


def row(
    name: str, physical: PhysicalCase, mu: float, errs: bool, opening: float | None, closings: int
) -> dict[str, Any]:
    """One placement: what is promised, and where closings from inside the promise ended."""
    cage = physical.cage
    best = place(cage, mu, opening, errs)
    seed = [SEED, NAMES.index(name) if name in NAMES else 0]
    rng = np.random.default_rng(seed)
    half = closings // 2
    inside = draw_misplaced(best, closings - half, rng)
    starts = np.concatenate([inside, draw_misplaced(best, half, rng, furthest=True)])
    found = _with_friction(physical, mu, starts) if mu > 0.0 else _without(cage, starts)
    good = int(found.good.sum())
    return {
        "case": name,
        "fingers": physical.origin,
        "mu": mu,
        "opening": "error" if errs else "best" if opening is None else "known",
        "sigma": best.placement.sigma / cage.sigma_0,
        "level": None if best.level is None else best.level / cage.sigma_0,
        "tolerance": best.tolerance / cage.outline.diameter,
        "closings": len(starts),
        "good": good,
        "interval": wilson(good, len(starts)),
        "failures_at_most": rate_upper(len(starts) - good, len(starts)),
        "shift_max": float(np.nanmax(found.shift)),
        "turn_max": float(np.nanmax(found.turn)),
        "penetration_max": found.penetration,
        "time_step": SimConfig().time_step,
        "seed": seed,
        **_failed(starts, found.good),
    }


class Found(NamedTuple):
    """Closings (n,): whether each kept the promise, how far from the target each ended, [diameter]
    and [rad] in the object's frame, and the deepest finger, [diameter].
    """

    good: BoolArray
    shift: FloatArray
    turn: FloatArray
    penetration: float


def _without(cage: Cage, starts: FloatArray) -> Found:
    scene = Scene(cage.outline, cage.hand, cage.finger_radius, SimConfig())
    done = close_many(scene, starts, threads=1)
    shift, turn = moved(scene, cage.target_placement.as_array(), done.end)
    good = judge(done, cage.grasps, cage.outline).outcome == OUTCOMES.index("target")
    return Found(good, shift, turn, float(done.penetration_max.max()))


def _with_friction(physical: PhysicalCase, mu: float, starts: FloatArray) -> Found:
    ends = close_from(physical, physical.cage.friction(mu), "below", starts)
    return Found(ends.in_target, ends.position, ends.angle, ends.penetration)


def _failed(starts: FloatArray, good: BoolArray) -> dict[str, Any]:
    """The first starts that broke the promise."""
    bad = np.flatnonzero(~good)
    return {"failed_starts": starts[bad[:3]].tolist()} if len(bad) else {}


def measured(names: tuple[str, ...], closings: int) -> list[dict[str, Any]]:
    """All rows, printed as they come."""
    rows: list[dict[str, Any]] = []
    for name in names:
        files = [folder / f"{name}.json" for folder in (CASES, FRICTION_CASES)]
        physical = physical_case(load(next((file for file in files if file.exists()), name)))
        cage = physical.cage
        first = cage.sigma_first
        between = None if first is None else cage.sigma_0 + 0.6 * (first - cage.sigma_0)
        kinds: list[tuple[float, bool, float | None]] = [(0.0, False, None), (0.0, True, None)]
        kinds += [] if between is None else [(0.0, False, between)]
        kinds += [(mu, True, None) for mu in FRICTION]
        for mu, errs, opening in kinds:
            try:
                one = row(name, physical, mu, errs, opening, closings)
            except InputError as error:
                print(f"{name} mu {mu:g}: not asked, {error}", flush=True)
                continue
            rows.append(one)
            print(
                f"{name:17} mu {mu:<5g} {one['opening']:6} sigma {one['sigma']:.4f} sigma_0  "
                f"r {one['tolerance']:.5f} diameters  {one['good']}/{one['closings']}  "
                f"deepest {one['penetration_max']:.1e}",
                flush=True,
            )
    return rows


def main() -> int:
    """Close, print, keep; 1 if a promise was broken."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--cases", default=",".join(NAMES))
    parser.add_argument("--closings", type=int, default=CLOSINGS)
    parser.add_argument("--update-baseline", action="store_true")
    args = parser.parse_args()
    machine_code_at_once()
    rows = measured(tuple(args.cases.split(",")), args.closings)
    total, good = (sum(one[key] for one in rows) for key in ("closings", "good"))
    document = {
        "command": "python -m benchmarks.placements --update-baseline",
        "closings": total,
        "good": good,
        "failures_at_most": rate_upper(total - good, total),
        "penetration_max": max((one["penetration_max"] for one in rows), default=math.nan),
        "near": {"position": NEAR_POSITION, "angle": NEAR_TURN},
        "rows": rows,
    }
    print(f"{good} of {total} closings kept the promise; deepest {document['penetration_max']:.2e}")
    if args.update_baseline:
        json.loads(json_text(document))
        BASELINE.write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
    return 0 if good == total else 1


if __name__ == "__main__":
    sys.exit(main())
