"""Closings per second per core from guaranteed sets, and how that compares with bare engine steps.

    python -m benchmarks.closing                    all targets, one thread
    python -m benchmarks.closing --trials 1000 --threads 2 --json FILE
    python -m benchmarks.closing --against CHECKOUT [--outcomes]    beside another checkout

Starts are drawn as ``replay`` draws them: from the whole guaranteed set of each grasp's plan. Every
closing must end in the target, or the figure means nothing: the last column tells. Early stop is
included; free travel before the first touch and the way to where a grasp may be are computed, not
simulated, so "step / bare" is below 1. Seconds are processor
seconds of all threads, so a busy machine blurs the figures less, and the best of ``--passes``: the
neighbours of a shared machine only ever add to it. Machines, and one machine from minute to minute,
differ by a factor of two: compare the ratios, to ``mj_step`` alone over the same motion and to the
planner's yardstick, all measured in the same run.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from pathlib import Path

import mujoco
import numpy as np

from benchmarks import timing
from benchmarks.closing_against import ALL, GRASPS, SETS, compare_outcomes, compare_speed
from icage.planner import plan
from icage.sampling import draw_starts
from sim.closing.approach import approached
from sim.closing.batch import close_many
from sim.closing.judge import judge
from sim.closing.one import data_at
from sim.world.scene import Scene
from tests.sim.grasps import KnownGrasp, starts_near, triangle

BASELINE = Path(__file__).with_name("closing_baseline.json")

TARGETS = ("T", "L", "pliers", "saw")


def main() -> None:
    """Print a table beside the baseline."""
    parser = argparse.ArgumentParser(description=__doc__, allow_abbrev=False)
    parser.add_argument("--trials", type=int, default=300)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--passes", type=int, default=5)
    parser.add_argument("--json", type=Path, help="write the figures")
    parser.add_argument("--update-baseline", action="store_true")
    parser.add_argument("--against", type=Path, help="a checkout of another commit")
    parser.add_argument("--outcomes", action="store_true", help="with it: every verdict")
    parser.add_argument("--only", nargs="*", choices=ALL, help="grasps for --against")
    parser.add_argument(
        "--sets", nargs="*", choices=SETS, default=list(SETS), help="starts for --outcomes"
    )
    options = parser.parse_args()
    if options.against is not None:
        _against(options)
        return
    yardstick = timing.yardstick()
    base = json.loads(BASELINE.read_text()) if BASELINE.exists() else None
    print(
        f"{options.trials} closings each, {options.threads} thread(s), best of {options.passes}; "
        "baseline in brackets"
    )
    print(
        "per second  steps each  us/step  bare us/step  step / bare    closing / yardstick  reached"
    )
    figures: dict[str, float] = {"yardstick": yardstick}
    for name in TARGETS:
        grasp = ALL[name]()
        starts = guaranteed_starts(grasp, options.trials)
        figures |= _report(name, grasp, starts, options, yardstick, base)
    apart = triangle()  # no corner: slow to settle, and starts near the target only
    starts = starts_near(apart, options.trials, seed=1, opening=1.1)
    figures |= _report("triangle", apart, starts, options, yardstick, base)
    ratios = {k: v for k, v in (base or {}).items() if "_ratio_" in k}
    for path in [BASELINE] * options.update_baseline + [options.json] * bool(options.json):
        path.write_text(json.dumps(figures | ratios, indent=1) + "\n")


def _against(options: argparse.Namespace) -> None:
    """Beside another checkout: verdicts, or speed, which the baseline keeps too."""
    if options.outcomes:
        differ = compare_outcomes(
            options.against, options.trials, options.only or list(ALL), options.sets
        )
        raise SystemExit(f"{differ} verdicts differ" if differ else 0)
    figures = compare_speed(
        options.against, options.trials, options.passes, options.only or list(GRASPS)
    )
    for path in [BASELINE] * options.update_baseline + [options.json] * bool(options.json):
        kept = json.loads(path.read_text()) if path.exists() else {}
        path.write_text(json.dumps(kept | figures, indent=1) + "\n")


def guaranteed_starts(grasp: KnownGrasp, count: int) -> np.ndarray:
    """Placements (count, 4) from the guaranteed set of the grasp's plan."""
    cage = plan(grasp.outline, grasp.contacts, grasp.radius)
    return draw_starts(cage, "guaranteed", count, np.random.default_rng(1)).placements


def _report(
    name: str,
    grasp: KnownGrasp,
    starts: np.ndarray,
    options: argparse.Namespace,
    yardstick: float,
    base: dict[str, float] | None,
) -> dict[str, float]:
    scene = grasp.scene()
    close_many(scene, starts[:2], options.threads)  # compile and warm up
    seconds, bare = math.inf, math.inf
    for _ in range(options.passes):
        bare = min(bare, bare_step(scene, starts))
        begin = time.process_time()
        closings = close_many(scene, starts, options.threads)
        seconds = min(seconds, time.process_time() - begin)
    reached = judge(closings, [grasp], grasp.outline).counts()["target"]
    per_step = 1e6 * seconds / float(closings.steps.sum())
    figures = {
        f"{name}_seconds_per_closing": seconds / len(starts),
        f"{name}_steps": float(closings.steps.mean()),
        f"{name}_us_per_step": per_step,
        f"{name}_us_per_bare_step": bare,
    }
    was = figures | {"yardstick": yardstick} if base is None else base
    print(
        f"{len(starts) / seconds:10.0f}  {closings.steps.mean():10.0f}  {per_step:7.1f}"
        f"  {bare:12.1f}  {per_step / bare:5.2f} ({_over_bare(was, name):.2f})"
        f"  {_over_yardstick(figures, name, yardstick):10.3f}"
        f" ({_over_yardstick(was, name, was['yardstick']):.3f})"
        f"  {reached}/{len(starts)}  {name}"
    )
    return figures


def _over_bare(figures: dict[str, float], name: str) -> float:
    return figures[f"{name}_us_per_step"] / figures[f"{name}_us_per_bare_step"]


def _over_yardstick(figures: dict[str, float], name: str, yardstick: float) -> float:
    return figures[f"{name}_seconds_per_closing"] / yardstick


def bare_step(scene: Scene, starts: np.ndarray) -> float:
    """[us] One ``mj_step`` in the C loop, over the same motion."""
    spent, steps, rows = 0.0, 300, 20
    for row in approached(scene, scene.start_positions(starts[:rows])):
        data = data_at(scene, row)
        begin = time.process_time()
        mujoco.mj_step(scene.model, data, steps)
        spent += time.process_time() - begin
    return 1e6 * spent / (min(rows, len(starts)) * steps)


if __name__ == "__main__":
    main()
