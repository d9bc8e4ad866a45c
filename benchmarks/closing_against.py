"""The closings of another checkout beside those of this one: as fast, and the same ends?

    git worktree add out/older COMMIT
    python -m benchmarks.closing --against out/older                          speed, in turns
    python -m benchmarks.closing --against out/older --outcomes --trials 10000    every verdict

Both close from the same starts, each in a process of its own that lives as long as the run. Speed:
one pass of the one, one of the other, and again; the ratio is taken pass by pass, so that a busy
neighbour strikes both. Outcomes: every trial judged by this checkout, verdicts compared one by one.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.closing_worker import ALL, GRASPS
from icage.planner import plan
from icage.sampling import SamplingError, draw_starts
from sim.closing.judge import OUTCOMES, judge
from sim.closing.outcome import ClosingOutcomes
from tests.sim.grasps import KnownGrasp, starts_near

HERE = Path(__file__).resolve().parent.parent
SETS = ("guaranteed", "rest", "anywhere", "wild", "friction 0.05", "friction 0.2")


class Worker:
    """A process that closes with the code of one checkout."""

    def __init__(self, checkout: Path, folder: Path) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-P", str(HERE / "benchmarks" / "closing_worker.py")],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            cwd=checkout,
            env={**os.environ, "PYTHONPATH": str(checkout)},
        )
        self._folder = folder

    def close(self, grasp: str, starts: np.ndarray, friction: float = 0.0) -> dict[str, Any]:
        """Seconds, mean steps and the outcomes of closing from starts (N, 4)."""
        given, found = self._folder / "starts.npy", self._folder / "found.npz"
        np.save(given, starts)
        asked = {"grasp": grasp, "starts": str(given), "friction": friction, "out": str(found)}
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        print(json.dumps(asked), file=self._process.stdin, flush=True)
        line = self._process.stdout.readline()
        if not line:
            raise RuntimeError("the other checkout's closings ended; see above")
        with np.load(found) as arrays:
            return {**json.loads(line), "closings": ClosingOutcomes(**dict(arrays))}

    def end(self) -> None:
        """Let it go."""
        assert self._process.stdin is not None
        self._process.stdin.close()
        self._process.wait()


@contextmanager
def workers(checkout: Path) -> Iterator[tuple[Worker, Worker]]:
    """One of the other checkout, one of this."""
    with tempfile.TemporaryDirectory(prefix="icage-") as folder:
        both = Worker(checkout.resolve(), Path(folder)), Worker(HERE, Path(folder))
        try:
            yield both
        finally:
            for one in both:
                one.end()


def compare_speed(
    checkout: Path, trials: int, passes: int, names: Sequence[str] = tuple(GRASPS)
) -> dict[str, float]:
    """Print and return closings per processor second and their ratios."""
    figures: dict[str, float] = {}
    print("per second, other and here   ratio: min  median  max   steps, other and here")
    with workers(checkout) as (other, here):
        for name in names:
            starts = drawn(ALL[name](), "guaranteed", trials)
            for one in (other, here):
                one.close(name, starts[:5])
            pairs = [(other.close(name, starts), here.close(name, starts)) for _ in range(passes)]
            ratio = np.array([a["seconds"] / b["seconds"] for a, b in pairs])
            rates = [trials / np.median([p[k]["seconds"] for p in pairs]) for k in range(2)]
            figures[f"{name}_ratio_min"] = float(ratio.min())
            figures[f"{name}_ratio_median"] = float(np.median(ratio))
            figures[f"{name}_ratio_max"] = float(ratio.max())
            print(
                f"{rates[0]:10.0f} {rates[1]:10.0f}           {ratio.min():6.2f}"
                f"  {np.median(ratio):6.2f}  {ratio.max():5.2f}"
                f"   {pairs[0][0]['steps']:6.0f} {pairs[0][1]['steps']:6.0f}   {name}"
            )
    return figures


def compare_outcomes(checkout: Path, trials: int, names: Sequence[str], sets: Sequence[str]) -> int:
    """Print what differs; the number of trials with another verdict."""
    differing = 0
    with workers(checkout) as (other, here):
        for name in names:
            grasp = ALL[name]()
            for which in sets:
                differing += _compare_set(name, grasp, which, trials, other, here)
    return differing


def drawn(grasp: KnownGrasp, which: str, count: int) -> np.ndarray:
    """Starts (count, 4): of the plan's sets; anywhere near it, open up to 2.2 times; or wild ones,
    off by a third of the object and turned by anything, most of them no cage.
    """
    near = which != "guaranteed" and which != "rest"
    if which == "wild":
        return starts_near(grasp, count, seed=2, opening=2.5, shift=0.35, turn=3.1)
    if near or len(grasp.outline.vertices) == 3:  # the triangle's cage is a thin one
        wide = 2.2 if which == "anywhere" else 1.3 if which == "rest" else 1.1
        return starts_near(grasp, count, seed=1, opening=wide, turn=0.3 if near else 0.1)
    cage = plan(grasp.outline, grasp.contacts, grasp.radius)
    return draw_starts(cage, which, count, np.random.default_rng(1)).placements  # type: ignore[arg-type]


def _compare_set(
    name: str, grasp: KnownGrasp, which: str, trials: int, other: Worker, here: Worker
) -> int:
    friction = float(which.split()[1]) if which.startswith("friction") else 0.0
    cage = plan(grasp.outline, grasp.contacts, grasp.radius)
    grasps = cage.grasps or [grasp]
    try:
        starts = drawn(grasp, which, trials)
    except SamplingError as error:
        print(f"{name}, {which}: nothing drawn ({error})")
        return 0
    was, now = (one.close(name, starts, friction)["closings"] for one in (other, here))
    verdicts = [judge(c, grasps, grasp.outline, friction=friction > 0.0) for c in (was, now)]
    differ = (verdicts[0].outcome != verdicts[1].outcome) | (
        verdicts[0].grasp_id != verdicts[1].grasp_id
    )
    counts = {k: v for k, v in verdicts[1].counts().items() if v}
    fine = ~differ & (verdicts[0].grasp_id >= 0)
    shift = np.abs(verdicts[0].grasp_position_error - verdicts[1].grasp_position_error)[fine]
    turn = np.abs(verdicts[0].grasp_angle_error - verdicts[1].grasp_angle_error)[fine]
    print(
        f"{name}, {which}: {differ.sum()} of {trials} verdicts differ; {counts}; ends within "
        f"{shift.max(initial=0.0):.1e} diameters, {turn.max(initial=0.0):.1e} rad; "
        f"steps {was.steps.mean():.0f} -> {now.steps.mean():.0f}"
    )
    for word in ("penetration_max", "penetration_rest"):
        rows = [np.percentile(getattr(c, word), (50, 90, 99, 100)) for c in (was, now)]
        print(f"    {word} 50, 90, 99, 100 %: {_line(rows[0])} -> {_line(rows[1])}")
    for i in np.flatnonzero(differ)[:20].tolist():
        words = [f"{OUTCOMES[int(v.outcome[i])]} {v.grasp_id[i]}" for v in verdicts]
        print(
            f"    trial {i}: {words[0]} after {was.steps[i]} steps, {words[1]} after "
            f"{now.steps[i]}; ends {was.end[i].tolist()} and {now.end[i].tolist()}"
        )
    sys.stdout.flush()
    return int(differ.sum())


def _line(values: np.ndarray) -> str:
    return " ".join(f"{value:.2e}" for value in values)
