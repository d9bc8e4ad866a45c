"""The planner beside what one would use otherwise: same questions, one run, in turns.

    python -m benchmarks.peers --json FILE          five ways on five shipped cases, half an hour
    python -m benchmarks.peers --quick              once each, three minutes
    python -m benchmarks.peers --check              are the peers right? closed forms, one minute

Processor seconds, warm. The planner's are of a whole plan, with every grasp and puncture; a peer's
of sigma_max alone. Errors are relative to the planner's sigma_max. Each repeat of the alpha shapes
has a seed of its own. The peers are ours, written from descriptions; compiled, a flood might be
some times faster, and no constant changes by a thousand.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.peers import alpha_shapes, grid_flood
from benchmarks.peers.check import failed_checks
from benchmarks.peers.question import Question
from benchmarks.timing import REPEATS, Spread, interleaved, peak_memory, spread
from icage.case import Case
from icage.formats.load import load
from icage.kernels.compiled import machine_code_at_once
from icage.planner import plan
from models import CASES, OBJECTS

SHIPPED = {
    "L": CASES / "L_best.json",
    "T": CASES / "T_best.json",
    "pliers, points": CASES / "pliers_best.json",
    "pliers, discs": OBJECTS / "pliers" / "cases" / "1_best.json",
    "saw, discs": OBJECTS / "saw" / "cases" / "1_best.json",
}
LARGEST = "saw, discs"
"""The case on which memory is measured."""
SAMPLES = (20_000, 60_000)
STEPS = (30, 60)
"""[1 / diameter] Steps of the grid."""
PLANS = 20
"""A plan takes milliseconds: so many are timed at once."""


def main() -> int:
    """Check or measure."""
    parser = argparse.ArgumentParser(description=__doc__, allow_abbrev=False)
    parser.add_argument("--quick", action="store_true", help="once each, without the most samples")
    parser.add_argument("--repeats", type=int, default=REPEATS)
    parser.add_argument("--json", type=Path, help="write the figures")
    parser.add_argument("--check", action="store_true", help="try the peers themselves")
    options = parser.parse_args()
    if options.check:
        return _check()
    machine_code_at_once()
    samples = SAMPLES[:1] if options.quick else SAMPLES
    rows = measure(1 if options.quick else options.repeats, samples)
    memory = measure_memory(samples)
    if options.json is not None:
        document = {"format": "icage-peers/1", "rows": rows, "memory_MB": memory}
        options.json.write_text(json.dumps(document, indent=1) + "\n")
    return 0


def measure(repeats: int, samples: tuple[int, ...]) -> list[dict[str, Any]]:
    """A row for every case and method; prints them as they come."""
    rows: list[dict[str, Any]] = []
    print(f"{'case':<16} {'method':<28} {'seconds':>9} {'/ planner':>10} {'sigma_max':>10}  error")
    for name, path in SHIPPED.items():
        for row in _rows(name, load(path), repeats, samples):
            print(
                f"{row['case']:<16} {row['method']:<28} {row['seconds']['median']:9.4g}"
                f" {row['over_planner']['median']:10.0f} {row['sigma_max']['median']:10.5g}"
                f"  {100 * row['error']['min']:+.2f} to {100 * row['error']['max']:+.2f} %",
                flush=True,
            )
            rows.append(row)
    return rows


def measure_memory(samples: tuple[int, ...]) -> dict[str, float]:
    """[MB] Most memory of a process that does nothing else, by method."""
    case = load(SHIPPED[LARGEST])
    memory: dict[str, float] = {}
    for method in _ways(case, Question.of(case), samples):
        code = f"from benchmarks.peers.__main__ import once; once({samples!r}, {method!r})"
        memory[method] = peak_memory(code)
        print(f"{LARGEST}, {method}: {memory[method]:.0f} MB", flush=True)
    return memory


def once(samples: tuple[int, ...], method: str) -> None:
    """Ask the largest case by one method, for ``measure_memory``."""
    case = load(SHIPPED[LARGEST])
    _ways(case, Question.of(case), samples)[method](0)


def _ways(
    case: Case, question: Question, samples: tuple[int, ...]
) -> dict[str, Callable[[int], Any]]:
    ways: dict[str, Callable[[int], Any]] = {"planner": lambda _: _planned(case)}
    for step in STEPS:
        ways[f"grid flood, 1/{step}"] = partial(_flooded, question, 1.0 / step)
    for count in samples:
        ways[f"alpha shapes, {count} samples"] = partial(_bisected, question, count)
    return ways


def _rows(name: str, case: Case, repeats: int, samples: tuple[int, ...]) -> list[dict[str, Any]]:
    truth = plan(case).sigma_max  # compiles, too
    assert truth is not None
    question = Question.of(case)
    tasks = _ways(case, question, samples)
    found = interleaved(tasks, repeats)
    quick = np.array([seconds for seconds, _ in found["planner"]]) / PLANS
    rows: list[dict[str, Any]] = []
    for method, runs in found.items():
        seconds = [one / PLANS if method == "planner" else one for one, _ in runs]
        answers = [answer for _, answer in runs]
        levels = [one[0] if isinstance(one, tuple) else one for one in answers]
        row: dict[str, Any] = {
            "case": name,
            "n": len(case.outline.vertices),
            "finger_radius": case.finger_radius,
            "method": method,
            "repeats": repeats,
            "seconds": spread(seconds),
            "over_planner": spread((np.array(seconds) / quick).tolist()),
            "sigma_max": spread(levels),
            "error": _errors(levels, truth),
        }
        if isinstance(answers[0], tuple):
            row["seconds_per_answer"] = spread(
                one / answer[1] for one, answer in zip(seconds, answers, strict=True)
            )
        rows.append(row)
    return rows


def _errors(levels: list[float], truth: float) -> Spread:
    return spread(level / truth - 1.0 for level in levels)


def _planned(case: Case) -> float | None:
    for _ in range(PLANS - 1):
        plan(case)
    return plan(case).sigma_max


def _flooded(question: Question, step: float, _: int) -> float:
    found = grid_flood.flood(question, step)
    return question.largest if found is None else found.sigma_max


def _bisected(question: Question, samples: int, seed: int) -> tuple[float, int]:
    found = alpha_shapes.sigma_max(question, samples, seed)
    return found.proven, found.calls


def _check() -> int:
    failures = failed_checks()
    print("\n".join(failures) or "the peers are right where the answer is known")
    return int(bool(failures))


if __name__ == "__main__":
    sys.exit(main())
