"""Placements inside the tolerance that ``icage place`` promises, closed in MuJoCo.

    python -m benchmarks.placements [--cases pliers,saw] [--closings 300] [--update-baseline]

For every case, with the opening known and with an error of it, and with friction where the planner
has a level for it: hands drawn inside the tolerance of the best placement, half of them with a
finger off by all of it, closed as `icage replay` closes. Without friction every closing has to end
in the target; with friction within 0.005 diameters and 0.02 rad of it, which is what the level is
for. Cases with point fingers are closed with discs (`experiments.cases.with_discs`) and placed with
these. A case fails that has any other ending. [docs/decisions/0017-placement.md]
"""

from __future__ import annotations

import argparse
import json
import math
import sys
from pathlib import Path
from typing import Any

import numpy as np

from experiments.cases.with_discs import physical_case
from experiments.io.intervals import rate_upper, wilson
from icage.cage import Cage
from icage.errors import InputError
from icage.formats.json_out import json_text
from icage.formats.load import load
from icage.kernels.compiled import machine_code_at_once
from icage.placing.best import BestPlacement, place
from icage.placing.misplaced import draw_misplaced
from icage.tolerance import NEAR_POSITION, NEAR_TURN
from models import CASES
from sim.closing.batch import close_many
from sim.closing.judge import judge
from sim.world.config import SimConfig
from sim.world.scene import Scene

BASELINE = Path(__file__).with_name("placements.json")
NAMES = (
    "pliers", "saw", "wrench", "T_best", "L_best", "disc_hammer", "disc_Y", "pliers_best",
    "rand16_best", "handsaw_best", "triangle_eq_best", "hammer_best",
)  # fmt: skip
FRICTION = (0.05, 0.2)
CLOSINGS = 300
SEED = 17


def row(
    name: str, cage: Cage, mu: float, errs: bool, opening: float | None, closings: int,
    origin: str,
) -> dict[str, Any]:  # fmt: skip
    """One placement: what is promised, and where closings from inside the promise ended."""
    best = place(cage, mu, opening, errs)
    rng = np.random.default_rng([SEED, NAMES.index(name) if name in NAMES else 0])
    half = closings // 2
    inside = draw_misplaced(best, closings - half, rng)
    starts = np.concatenate([inside, draw_misplaced(best, half, rng, furthest=True)])
    config = SimConfig(friction=mu)
    scene = Scene(cage.outline, cage.hand, cage.finger_radius, config)
    done = close_many(scene, starts, threads=1)
    found = judge(done, cage.grasps, cage.outline, friction=mu > 0.0)
    near = (found.position_error <= NEAR_POSITION) & (found.angle_error <= NEAR_TURN)
    counts = found.counts()
    good = int(near.sum()) if mu > 0.0 else counts["target"]
    size = cage.outline.diameter
    return {
        "case": name,
        "fingers": origin,
        "mu": mu,
        "opening": "error" if errs else "best" if opening is None else "known",
        "sigma": best.placement.sigma / cage.sigma_0,
        "level": None if best.level is None else best.level / cage.sigma_0,
        "tolerance": best.tolerance / size,
        "closings": len(done),
        "good": good,
        "interval": wilson(good, len(done)),
        "failures_at_most": rate_upper(len(done) - good, len(done)),
        "outcomes": {key: value for key, value in counts.items() if value},
        "position_error_max": float(np.nanmax(found.position_error)),
        "angle_error_max": float(np.nanmax(found.angle_error)),
        "penetration_max": float(done.penetration_max.max()),
        "penetration_rest_max": float(done.penetration_rest.max()),
        "time_step": config.time_step,
        "seed": [SEED, NAMES.index(name) if name in NAMES else 0],
        **_failed(best, starts, near if mu > 0.0 else found.outcome == 0),
    }


def _failed(best: BestPlacement, starts: np.ndarray, good: np.ndarray) -> dict[str, Any]:
    """The first starts that broke the promise."""
    bad = np.flatnonzero(~good)
    return {"failed_starts": starts[bad[:3]].tolist()} if len(bad) else {}


def measured(names: tuple[str, ...], closings: int) -> list[dict[str, Any]]:
    """All rows, printed as they come."""
    rows: list[dict[str, Any]] = []
    for name in names:
        file = CASES / f"{name}.json"
        physical = physical_case(load(file if file.exists() else name))
        cage, origin = physical.cage, physical.origin
        first = cage.sigma_first
        between = None if first is None else cage.sigma_0 + 0.6 * (first - cage.sigma_0)
        kinds: list[tuple[float, bool, float | None]] = [(0.0, False, None), (0.0, True, None)]
        kinds += [] if between is None else [(0.0, False, between)]
        kinds += [(mu, True, None) for mu in FRICTION]
        for mu, errs, opening in kinds:
            try:
                one = row(name, cage, mu, errs, opening, closings, origin)
            except InputError as error:
                print(f"{name} mu {mu:g}: not asked, {error}", flush=True)
                continue
            rows.append(one)
            print(
                f"{name:17} mu {mu:<5g} {one['opening']:6} sigma {one['sigma']:.4f} sigma_0  "
                f"r {one['tolerance']:.5f} diameters  {one['good']}/{one['closings']}  "
                f"deepest {one['penetration_max']:.1e}  {one['outcomes']}",
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
