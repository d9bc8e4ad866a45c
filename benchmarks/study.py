"""How much of the engine's speed is left in a study, and what an object of its own costs a trial.

    python -m benchmarks.study                         ratios beside the baseline
    python -m benchmarks.study --long [--threads 2]    100,000 frictionless closings: time, memory

A bare loop takes every closing of the study to where its object has been pushed
(``sim.closing.push``), steps the same model from there, every simulation for as long as the study
took it, and looks at nothing more. Both in the same run, on one thread, in processor seconds, best
of ``--passes``; the study's share is everything: drawing the starts, asking the planner, closing,
watching, judging, writing shards and the table.
"""

from __future__ import annotations

import argparse
import json
import resource
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from experiments.study.run.session import Session, session_of
from experiments.study.run.shard import run_trials
from experiments.study.run.shards import SHARD, on_threads, run_study
from sim.closing.approach import approached
from sim.closing.push import push
from sim.closing.step_check import StepCheck
from sim.closing.varied_shapes import LOOK_EVERY
from sim.world.engine import Batch

BASELINE = Path(__file__).with_name("study_baseline.json")

VARIED: dict[str, dict[str, str]] = {
    "fixed shapes": {},
    "friction, 0 to 0.1": {"friction": "0:0.1"},
    "mass, speed, force, tilt": {
        "mass": "0.5:2",
        "speed": "0.5:2",
        "force": "0.5:2",
        "tilt": "0:20deg",
    },
    "20 finger radii": {"finger_radius": "grid:-0.2:0.2:20"},
    "a radius each": {"finger_radius": "-0.2:0.2"},
    "an outline each": {"outline_noise": "0.2mm"},
}


def main() -> None:
    """Print a table beside the baseline."""
    parser = argparse.ArgumentParser(description=__doc__, allow_abbrev=False)
    parser.add_argument("--case", default="pliers")
    parser.add_argument("--trials", type=int, default=1000)
    parser.add_argument("--passes", type=int, default=3)
    parser.add_argument("--threads", type=int, default=2, help="for --long")
    parser.add_argument("--long", action="store_true")
    parser.add_argument("--json", type=Path, help="write the figures")
    parser.add_argument("--update-baseline", action="store_true")
    options = parser.parse_args()
    if options.long:
        _long(options.case, options.threads)
        return
    base = json.loads(BASELINE.read_text()) if BASELINE.exists() else {}
    figures = _ratios(options.case, options.trials, options.passes)
    for name, value in figures.items():
        was = f"   ({base[name]:.3g} in the baseline)" if name in base else ""
        print(f"{name:<44} {value:10.4g}{was}")
    for path in [BASELINE] * options.update_baseline + [options.json] * bool(options.json):
        path.write_text(json.dumps(figures, indent=1) + "\n")


def _ratios(case: str, trials: int, passes: int) -> dict[str, float]:
    with _session(case, 20, {}) as session:
        _study(session)  # compiles what is compiled once
    figures: dict[str, float] = {}
    bare, whole, steps = [], [], 0
    for _ in range(passes):  # in turns, so that a busy neighbour strikes both
        with _session(case, trials, {}) as session:
            seconds, table = _timed(lambda session=session: _study(session))
            whole.append(seconds)
            steps = int(np.sum(table["steps"].to_numpy()))
            bare.append(_bare(session))
    figures["share of the bare loop's steps per second"] = min(bare) / min(whole)
    figures["bare loop, us a step"] = 1e6 * min(bare) / steps
    figures["steps a trial"] = steps / trials
    for name, vary in VARIED.items():
        seconds = []
        for _ in range(passes):
            with _session(case, trials, vary) as session:
                seconds.append(_timed(lambda session=session: _study(session))[0])
        figures[f"{name}: trials per second and core"] = trials / min(seconds)
    return figures


@contextmanager
def _session(case: str, trials: int, vary: dict[str, str]) -> Iterator[Session]:
    with tempfile.TemporaryDirectory(prefix="icage-") as folder:
        given: dict[str, Any] = {"case": case, "trials": trials, "vary": vary}
        yield session_of(given, folder, False, SHARD)


def _study(session: Session) -> Any:
    backend = on_threads(1)
    return run_study(session.study, session.folder, backend, session.shard, lambda *_: None)[0]


def _timed(run: Callable[[], Any]) -> tuple[float, Any]:
    begin = time.process_time()
    done = run()
    return time.process_time() - begin, done


def _bare(session: Session) -> float:
    """Seconds of the engine alone for the same steps from the same starts."""
    study, total = session.study, session.study.design.total
    seconds = 0.0
    for first in range(0, total, SHARD):
        ran = run_trials(study, np.arange(first, min(first + SHARD, total)))
        scene = study.variants.planned.scene
        qpos = scene.start_positions(ran.starts)
        batch = Batch(scene.model, nsim=len(qpos), nthread=1)
        start = time.process_time()
        check = StepCheck.over(scene, qpos, LOOK_EVERY)
        begun = push(scene, approached(scene, qpos), check)
        left = ran.closings.closings.steps - check.steps
        batch.qpos, batch.qvel, batch.ctrl = begun.positions, begun.velocities, scene.closing_force
        ids = np.flatnonzero(left > 0).astype(np.int32)
        while len(ids):
            batch.step(ids, nstep=LOOK_EVERY)
            left[ids] -= LOOK_EVERY
            ids = ids[left[ids] > 0]
        seconds += time.process_time() - start
    return seconds


def _long(case: str, threads: int) -> None:
    """100,000 frictionless closings: wall time, processor time, memory as it goes."""
    with _session(case, 100_000, {}) as session:
        start, used = time.perf_counter(), time.process_time()

        def report(done: int, total: int) -> None:
            if done % 10_000 < SHARD:
                print(f"{done:7d} trials, {time.perf_counter() - start:6.0f} s, {_peak():6.0f} MB")

        study, folder = session.study, session.folder
        table, _ = run_study(study, folder, on_threads(threads), SHARD, report)
        reached = sum(word == "target" for word in table["outcome"].to_pylist())
        print(
            f"{reached} of {len(table)} in the target; {time.perf_counter() - start:.0f} s, "
            f"{time.process_time() - used:.0f} s of processor time on {threads} threads, "
            f"at most {_peak():.0f} MB"
        )


def _peak() -> float:
    """[MB] Most memory this process has had."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


if __name__ == "__main__":
    main()
