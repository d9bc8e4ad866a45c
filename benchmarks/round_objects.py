"""Plans of round objects, where hands tie: ``python -m benchmarks.round_objects [--json FILE]``.

One plan by either method, each in a process of its own with its peak memory. Processor seconds, as
ratios to a yardstick measured in the same run. The levels of both methods must agree.
"""

from __future__ import annotations

import argparse
import json
import math
import subprocess
import sys
import time
from collections.abc import Iterable
from functools import partial
from itertools import product
from pathlib import Path

import numpy as np

from benchmarks.timing import peak_of_this_program, seconds_of, yardstick
from icage.arrays import FloatArray
from icage.kernels.compiled import machine_code_at_once
from icage.planner import METHODS, MethodName, plan

ROUND = {
    "regular_99": 99,
    "regular_199": 199,
    "regular_500": 500,
    "regular_1000": 1000,
    "ellipse_200": 200,
    "notched_circle_200": 200,
    "gear_240": 240,
    "rounded_square_200": 200,
}
"""Round objects, and their vertices."""

ONE_METHOD = ("regular_1000", "gear_240")
"""Round objects on which the contact space is not asked: minutes."""


def round_object(name: str) -> tuple[FloatArray, FloatArray]:
    """Vertices (n, 2) of a round object, and contacts (3, 2) whose normals meet, far apart."""
    n = ROUND[name]
    angle = 2.0 * np.pi * np.arange(n) / n
    circle = np.column_stack([np.cos(angle), np.sin(angle)])
    shapes = {
        "ellipse": circle * [1.0, 0.7],
        "notched_circle": np.vstack([circle[4:-4], [[0.4, -0.12], [0.4, 0.12]]]),
        "gear": circle * np.where(np.arange(n) % 20 < 10, 1.0, 0.85)[:, None],
        "rounded_square": np.sign(circle) * np.abs(circle) ** 0.5,
    }
    vertices = shapes.get(name.rsplit("_", 1)[0], circle)
    third = len(vertices) // 3
    best: tuple[float, FloatArray] | None = None
    for first, second, last in product(range(0, third, third // 4), range(-9, 10), range(-9, 10)):
        found = concurrent(vertices, first, first + third + second, first + 2 * third + last)
        if found is not None and (best is None or found[0] < best[0]):
            best = found
    assert best is not None, f"{name}: no three edges whose normals meet"
    return vertices, best[1]


def concurrent(
    vertices: FloatArray, first: int, second: int, last: int
) -> tuple[float, FloatArray] | None:
    """Contacts in the middles of two edges and where a third one's normal meets theirs.

    With how far their forces are from equal ones; None if the normals do not meet so.
    """
    at = np.array([first, second, last]) % len(vertices)
    start = vertices[at]
    side = vertices[(at + 1) % len(vertices)] - start
    length = np.hypot(*side.T)
    along = side / length[:, None]
    middle = start[:2] + 0.5 * side[:2]
    if np.abs(np.linalg.det(along[:2])) < 0.5:
        return None
    meeting = np.linalg.solve(along[:2], (along[:2] * middle).sum(axis=1))
    foot = float((meeting - start[2]) @ along[2])
    forces = -np.linalg.solve(along[:2].T, along[2])
    if not 0.2 * length[2] < foot < 0.8 * length[2] or (forces < 0.3).any():
        return None
    return float(np.abs(forces - 1.0).max()), np.vstack([middle, start[2] + foot * along[2]])


def one_round(name: str, method: MethodName) -> dict[str, float]:
    """Seconds of one plan (least of up to three within a minute), peak memory, what was found."""
    vertices, contacts = round_object(name)
    started = time.process_time()
    times: list[float] = []
    cage = plan(vertices, contacts, method=method)  # compiled or loaded now, and its memory taken
    while len(times) < 3 and time.process_time() - started < 60.0:
        times.append(seconds_of(partial(plan, method=method), vertices, contacts))
    return {
        "seconds": min(times, default=time.process_time() - started),
        "peak_MB": peak_of_this_program(),
        "sigma_0": cage.sigma_0,
        "sigma_max": cage.sigma_max or math.inf,
        "grasps": len(cage.grasps),
    }


def rounds(names: Iterable[str]) -> dict[str, float]:
    """``round_<object>_<method>_<seconds or MB>``; the levels of both methods must agree."""
    figures: dict[str, float] = {}
    for name in names:
        levels: list[float] = []
        for method in METHODS[:1] if name in ONE_METHOD else METHODS:
            asked = [sys.executable, "-m", "benchmarks.round_objects", "--one", name, method]
            answer = subprocess.run(asked, check=True, capture_output=True, text=True)
            row = json.loads(answer.stdout)
            figures[f"round_{name}_{method}_seconds"] = row["seconds"]
            figures[f"round_{name}_{method}_MB"] = row["peak_MB"]
            levels.append(row["sigma_max"] / row["sigma_0"])
            print(f"{name}, {method}: {row}", flush=True)
        if len(levels) == 2 and not math.isclose(levels[0], levels[1], rel_tol=1e-7):
            raise AssertionError(f"{name}: the methods disagree, {levels}")
    return figures


def main() -> None:
    """Measure all, or one of them; print, write."""
    parser = argparse.ArgumentParser(description=__doc__, allow_abbrev=False)
    parser.add_argument("--json", type=Path, help="write the figures, name: value")
    parser.add_argument("--one", nargs=2, metavar=("OBJECT", "METHOD"), help="in this process")
    parser.add_argument("--only", action="append", choices=tuple(ROUND), help="again for more")
    options = parser.parse_args()
    machine_code_at_once()
    if options.one:
        print(json.dumps(one_round(options.one[0], options.one[1])))
        return
    figures = {"yardstick": yardstick()} | rounds(options.only or tuple(ROUND))
    if options.json is not None:
        options.json.write_text(json.dumps(figures, indent=1) + "\n")


if __name__ == "__main__":
    main()
