"""How much of the engine's speed is left in a study, and what an object of its own costs a trial.

    python -m benchmarks.study                         ratios beside the baseline
    python -m benchmarks.study --case saw models/cases/T_best.json   of other objects
    python -m benchmarks.study --long [--threads 2]    100,000 frictionless closings: time, memory

A bare loop takes every step that the study has taken and looks at nothing: from where the hands
are before their first touch, as many steps as were computed are computed (``sim.closing.push``),
and the engine steps the others, both in the study's batches and strides. Beside it the same number
of the engine's own ``mj_step``, one simulation at a time. All in one run, in turns, on one thread,
in processor seconds, best of ``--passes``; the study's share is everything: drawing the starts,
asking the planner, closing, watching, judging, writing shards and the table.
"""

from __future__ import annotations

import argparse
import json
import resource
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.closing import bare_step
from benchmarks.timing import timed
from experiments.study.run.missing_trials import missing
from experiments.study.run.session import Session, session_of
from experiments.study.run.shard import Study, run_trials
from experiments.study.run.shards import SHARD, on_threads, run_study
from icage.kernels.compiled import machine_code_at_once
from sim.closing.approach import approached
from sim.closing.computed_step import empty_room, go_on
from sim.closing.plant import plant_of
from sim.closing.push import push
from sim.closing.step_check import StepCheck
from sim.closing.varied_shapes import LOOK_EVERY
from sim.world.engine import Batch
from sim.world.scene import Scene

BASELINE = Path(__file__).with_name("study_baseline.json")

VARIED: dict[str, dict[str, str]] = {
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
    parser.add_argument(
        "--case", nargs="+", default=["pliers"], help="only the first has a baseline"
    )
    parser.add_argument("--trials", type=int, default=4000)
    parser.add_argument("--passes", type=int, default=3)
    parser.add_argument("--threads", type=int, default=2, help="for --long")
    parser.add_argument("--long", action="store_true")
    parser.add_argument("--json", type=Path, help="write the figures")
    parser.add_argument("--update-baseline", action="store_true")
    options = parser.parse_args()
    if options.long:
        _long(options.case[0], options.threads)
        return
    machine_code_at_once()
    for case in options.case[1:]:
        for name, value in _ratios(case, options.trials, options.passes).items():
            print(f"{case}: {name:<44} {value:10.4g}", flush=True)
    base = json.loads(BASELINE.read_text()) if BASELINE.exists() else {}
    figures = _ratios(options.case[0], options.trials, options.passes)
    figures |= _varied(options.case[0], options.trials // 4, options.passes)
    for name, value in figures.items():
        was = f"   ({base[name]:.3g} in the baseline)" if name in base else ""
        print(f"{name:<44} {value:10.4g}{was}")
    for path in [BASELINE] * options.update_baseline + [options.json] * bool(options.json):
        path.write_text(json.dumps(figures, indent=1) + "\n")


def _ratios(case: str, trials: int, passes: int) -> dict[str, float]:
    with _session(case, 20, {}) as session:
        _study(session)  # compiles what is compiled once
    bare, whole, engine, steps = [], [], [], 0
    shards: list[_Steps] = []
    for _ in range(passes):  # in turns, so that a busy neighbour strikes all
        with _session(case, trials, {}) as session:
            seconds, table = timed(lambda session=session: _study(session))
            shards = shards or _steps_of(session.study)  # the same in every pass
        whole.append(seconds)
        steps = int(np.sum(table["steps"].to_numpy()))
        bare.append(_bare(shards))
        engine.append(bare_step(shards[0].scene, shards[0].starts))
    return {
        "share of the bare loop's steps per second": min(bare) / min(whole),
        "steps per second over bare mj_step's": 1e-6 * min(engine) * steps / min(whole),
        "bare loop, us a step": 1e6 * min(bare) / steps,
        "mj_step, us a step": min(engine),
        "steps a trial": steps / trials,
        "fixed shapes: trials per second and core": trials / min(whole),
    }


def _varied(case: str, trials: int, passes: int) -> dict[str, float]:
    figures: dict[str, float] = {}
    for name, vary in VARIED.items():
        seconds = []
        for _ in range(passes):
            with _session(case, trials, vary) as session:
                seconds.append(timed(lambda session=session: _study(session))[0])
        figures[f"{name}: trials per second and core"] = trials / min(seconds)
    return figures


@contextmanager
def _session(case: str, trials: int, vary: dict[str, str]) -> Iterator[Session]:
    with tempfile.TemporaryDirectory(prefix="icage-") as folder:
        given: dict[str, Any] = {"case": case, "trials": trials, "vary": vary}
        yield session_of(given, folder, False)


def _study(session: Session) -> Any:
    backend = on_threads(1)
    return run_study(session.study, session.folder, backend, SHARD, lambda *_: None)[0]


@dataclass
class _Steps:
    """What a study steps in one shard: hands before their first touch, how many steps of each are
    computed and how many are the engine's, and where they end.
    """

    scene: Scene
    starts: np.ndarray
    begin: np.ndarray
    computed: np.ndarray
    by_engine: np.ndarray
    end: np.ndarray


def _steps_of(study: Study) -> list[_Steps]:
    """The steps of every shard of a study of fixed shapes and usual worlds."""
    total = study.design.total
    found: list[_Steps] = []
    for first, last in missing([], total, SHARD):
        ran = run_trials(study, np.arange(first, last + 1))
        scene, closings = study.variants.planned.scene, ran.closings.closings
        qpos = scene.start_positions(closings.start)
        begin = approached(scene, qpos)
        check = StepCheck.over(scene, qpos, LOOK_EVERY)
        push(scene, begin, check)
        by_engine = closings.steps - check.steps
        found.append(
            _Steps(scene, closings.start, begin, check.steps.copy(), by_engine, closings.end)
        )
    return found


def _bare(shards: list[_Steps]) -> float:
    """Seconds of nothing but the same steps; they end at the same bits."""
    seconds = 0.0
    for one in shards:
        scene, count = one.scene, len(one.begin)
        plant, room, most = plant_of(scene), empty_room(), scene.config.computed_contacts
        state, peak = np.zeros((count, 3, 6)), np.zeros(count)
        state[:, 0] = one.begin
        batch = Batch(scene.model, nsim=count, nthread=1)
        start = time.process_time()
        left = one.computed.copy()
        while len(ids := np.flatnonzero(left > 0)):
            go_on(ids, plant, room, most, LOOK_EVERY, state, peak)
            left[ids] -= LOOK_EVERY
        batch.qpos, batch.qvel, batch.qacc_warmstart = (np.copy(state[:, k]) for k in range(3))
        batch.ctrl = scene.closing_force
        left = one.by_engine.copy()
        while len(ids := np.flatnonzero(left > 0)):
            batch.step(ids.astype(np.int32), nstep=LOOK_EVERY)
            left[ids] -= LOOK_EVERY
        seconds += time.process_time() - start
        if not np.array_equal(scene.placements(batch.qpos), one.end):
            raise RuntimeError("the bare loop has not stepped what the study has")
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
