"""Speed of the planner on one core, warm: ``python -m benchmarks.planner [--json FILE]``.

Processor seconds. Every figure is also given as a ratio to a yardstick measured in the same run
(sorting two million doubles), so that runs on different machines can be compared.

- one search, one plan, regions and 100,000 queries on seeded random stars with 100 vertices and
  targets of every kind; medians over many targets;
- ``--growth``: one plan by either method on stars with 20 to 600 vertices: least, median and
  largest of the targets, and the exponent of a fitted power of n;
- ``--round``: one plan by either method on round objects, each in a process of its own with its
  peak memory;
- ``--sublevels``: all minima and merges of the equilateral hand on outlines of up to 300 vertices,
  each in a process of its own: seconds with one thread and, of the clock and of the processor,
  with as many as there are cores; peak memory.

``python -m benchmarks --only planner --compare`` compares with the committed baseline.
"""

from __future__ import annotations

import argparse
import json
import math
import resource
import subprocess
import sys
import time
from collections.abc import Callable
from functools import partial
from itertools import product
from pathlib import Path

import numpy as np

from icage.arrays import FloatArray
from icage.cells.free_space import search
from icage.cells.membership import query
from icage.cells.regions import caging_regions
from icage.cells.target import contacts_as_configuration, find_target
from icage.grasps.evaluator import GraspEvaluator
from icage.grasps.wanted import Wanted
from icage.hand import HandShape
from icage.hand_sublevels import sublevels
from icage.kernels.compiled import machine_code_at_once
from icage.outline import Outline
from icage.planner import MethodName, plan

QUERIES = 100_000
SIZES = (20, 40, 80, 150, 300, 600)
"""Vertices of the stars of ``growth``."""

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

METHODS: tuple[MethodName, ...] = ("cells", "contact-space")
ONE_METHOD = ("regular_1000", "gear_240")
"""Round objects on which the contact space is not asked: minutes."""

SUBLEVELS = (
    "star_80", "star_150", "star_300", "blob_300", "comb_300", "regular_300", "gear_300",
    "spiky_300", "spur_300",
)  # fmt: skip
"""Outlines of ``sublevels``: a shape and its vertices; a spur has equal spikes, the worst case."""

_SHARE = 20
"""Features that may come first in a triple of those from which targets are drawn."""


def star(n: int, rng: np.random.Generator) -> Outline:
    """A star-shaped polygon with n vertices."""
    angle = np.sort(rng.uniform(0.0, 2.0 * np.pi, n))
    radius = rng.uniform(0.35, 1.0, n)
    return Outline(np.column_stack([radius * np.cos(angle), radius * np.sin(angle)]))


def timed(work: Callable[..., object], *arguments: object) -> float:
    """Processor seconds of one call."""
    started = time.process_time()
    work(*arguments)
    return time.process_time() - started


def targets(outline: Outline, count: int, rng: np.random.Generator) -> list[np.ndarray]:
    """Contacts of immobilizing grasps of the outline, half of them with a useful cage."""
    bench = GraspEvaluator(outline, 0.0, Wanted())
    shares = max(1, len(outline.vertices) // _SHARE)  # all triples of 300 edges take a minute
    triples, points = bench.triples(int(rng.integers(shares)), shares)
    found: list[np.ndarray] = []
    for k in rng.permutation(len(triples)):
        candidate = bench.at(triples[k], points[k])
        if candidate is None:
            continue
        if candidate.score > 1.02 or len(found) % 2 == 0:
            found.append(candidate.contacts)
        if len(found) == count:
            break
    return found


def measure() -> dict[str, float]:
    """All figures, [s] unless the name says otherwise."""
    rng = np.random.default_rng(1)
    sample = rng.random(2_000_000)
    yardstick = float(np.median([timed(np.sort, sample) for _ in range(5)]))
    single: list[float] = []
    setup: list[float] = []
    regions: list[float] = []
    queries: list[float] = []
    for _ in range(4):
        outline = star(100, rng)
        for contacts in targets(outline, 30, rng):
            started = time.process_time()
            cage = plan(outline, contacts)
            setup.append(time.process_time() - started)
            if cage.work is None:
                continue
            free_space = cage.work.search.free_space
            target = find_target(free_space, contacts_as_configuration(free_space, contacts))
            assert target is not None
            single.append(timed(search, free_space, target.cell, target.sigma_0))
            regions.append(timed(caging_regions, cage))
        low, high = outline.vertices.min(axis=0), outline.vertices.max(axis=0)
        rows = np.column_stack(
            [
                rng.uniform(low[0], high[0], QUERIES),
                rng.uniform(low[1], high[1], QUERIES),
                rng.uniform(-np.pi, np.pi, QUERIES),
                rng.uniform(0.5, 1.1, QUERIES) * (cage.sigma_max or outline.diameter),
            ]
        )
        query(cage, rows)  # warm: the escape levels of the cells are remembered
        queries.append(timed(query, cage, rows))
    large = star(300, rng)
    big = targets(large, 3, rng)
    for contacts in big:
        cage = plan(large, contacts)
        caging_regions(cage)
    return {
        "yardstick": yardstick,
        "sigma_max_query_n100_median": float(np.median(single)),
        "sigma_max_query_n100_max": float(np.max(single)),
        "plan_n100_median": float(np.median(setup)),
        "regions_n100_median": float(np.median(regions)),
        "regions_n100_max": float(np.max(regions)),
        "membership_100k_n100_median": float(np.median(queries)),
        "membership_100k_n100_max": float(np.max(queries)),
        "peak_memory_n300_MB": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0,
    }


def growth(count: int = 9, sizes: tuple[int, ...] = SIZES) -> dict[str, float]:
    """One plan, [s], as ``plan_<method>_n<n>_<least, median, largest>``, and exponents."""
    rng = np.random.default_rng(3)
    figures: dict[str, float] = {}
    medians: dict[MethodName, list[float]] = {method: [] for method in METHODS}
    for n in sizes:
        outline = star(n, rng)
        grasps = targets(outline, count, rng)
        for method in METHODS:
            plan(outline, grasps[0], method=method)
            times = [timed(partial(plan, method=method), outline, grasp) for grasp in grasps]
            name = f"plan_{method}_n{n}"
            figures[f"{name}_least"] = float(np.min(times))
            figures[f"{name}_median"] = float(np.median(times))
            figures[f"{name}_largest"] = float(np.max(times))
            medians[method].append(figures[f"{name}_median"])
    for method in METHODS:
        slope = np.polyfit(np.log(sizes), np.log(medians[method]), 1)[0]
        figures[f"plan_{method}_exponent"] = float(slope)
    return figures


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
        times.append(timed(partial(plan, method=method), vertices, contacts))
    return {
        "seconds": min(times, default=time.process_time() - started),
        "peak_MB": peak_of_this_program(),
        "sigma_0": cage.sigma_0,
        "sigma_max": cage.sigma_max or math.inf,
        "grasps": len(cage.grasps),
    }


def peak_of_this_program() -> float:
    """Peak memory, [MB]; ``ru_maxrss`` would hold what the parent had before the program began."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(float(line.split()[1]) / 1024.0 for line in lines if line.startswith("VmHWM"))


def rounds() -> dict[str, float]:
    """``round_<object>_<method>_<seconds or MB>``; the levels of both methods must agree."""
    figures: dict[str, float] = {}
    for name in ROUND:
        levels: list[float] = []
        for method in METHODS[:1] if name in ONE_METHOD else METHODS:
            asked = [sys.executable, "-m", "benchmarks.planner", "--one-round", name, method]
            answer = subprocess.run(asked, check=True, capture_output=True, text=True)
            row = json.loads(answer.stdout)
            figures[f"round_{name}_{method}_seconds"] = row["seconds"]
            figures[f"round_{name}_{method}_MB"] = row["peak_MB"]
            levels.append(row["sigma_max"] / row["sigma_0"])
            print(f"{name}, {method}: {row}", flush=True)
        if len(levels) == 2 and not math.isclose(levels[0], levels[1], rel_tol=1e-7):
            raise AssertionError(f"{name}: the methods disagree, {levels}")
    return figures


def outline_of(name: str) -> Outline:
    """An outline of ``SUBLEVELS``."""
    kind, _, count = name.partition("_")
    n = int(count)
    angle = 2.0 * np.pi * np.arange(n) / n
    rng = np.random.default_rng(5)
    if kind == "star":
        return star(n, rng)
    if kind == "comb":
        gap = np.arange(n // 4)
        left, right = gap.astype(np.float64), gap + 0.5
        rows = [
            [left, 5.0 + 0.3 * np.sin(gap)], [left, 0.1 * (gap % 3)],
            [right, 0.1 * (gap % 3)], [right, 5.0 + 0.2 * np.cos(3.0 * gap)],
        ]  # fmt: skip
        teeth = np.array([np.column_stack(row) for row in rows]).swapaxes(0, 1).reshape(-1, 2)
        return Outline(np.vstack([[[-1.0, -3.0], [n // 4, -3.0]], teeth[::-1]]))
    radius = np.ones(n)
    if kind == "blob":
        for wave in range(2, 9):
            radius += 0.25 / wave * rng.normal() * np.cos(wave * angle + rng.uniform(0.0, 6.0))
        radius = np.maximum(radius, 0.25)
    if kind == "spiky":
        radius = rng.uniform(0.05, 1.0, n)
    if kind == "spur":
        radius[1::2] = 0.3
    if kind == "gear":
        radius[np.arange(n) % 20 >= 10] = 0.85
    return Outline(np.column_stack([radius * np.cos(angle), radius * np.sin(angle)]))


def one_sublevels(name: str) -> dict[str, float]:
    """Seconds of all minima and merges (least of up to three), peak memory, what was found."""
    outline, hand = outline_of(name), HandShape.from_angles_deg(60.0, 120.0)
    found = sublevels(outline, hand)  # compiled or loaded now, and its memory taken
    figures = {"vertices": float(len(outline)), "minima": float(len(found))}
    clock, processor, alone = [], [], []
    begun = time.process_time()
    while not alone or (len(alone) < 3 and time.process_time() - begun < 30.0):
        alone.append(timed(partial(sublevels, workers=1), outline, hand))
        started = time.perf_counter()
        processor.append(timed(sublevels, outline, hand))
        clock.append(time.perf_counter() - started)
    return figures | {
        "seconds_alone": min(alone),
        "seconds_processor": min(processor),
        "seconds_clock": min(clock),
        "peak_MB": peak_of_this_program(),
    }


def whole_sublevels() -> dict[str, float]:
    """``sublevels_<outline>_<figure>``, each outline in a process of its own."""
    figures: dict[str, float] = {}
    for name in SUBLEVELS:
        asked = [sys.executable, "-m", "benchmarks.planner", "--one-sublevels", name]
        answer = subprocess.run(asked, check=True, capture_output=True, text=True)
        row = json.loads(answer.stdout)
        print(f"{name}: {row}", flush=True)
        for figure in ("seconds_alone", "seconds_processor", "seconds_clock"):
            figures[f"sublevels_{name}_{figure}"] = row[figure]
        figures[f"sublevels_{name}_MB"] = row["peak_MB"]
    return figures


def main() -> int:
    """Measure (once before, to warm up) and print; ``python -m benchmarks`` compares."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--json", type=Path, help="write the figures, name: value")
    parser.add_argument("--growth", action="store_true", help="and plans of 20 to 600 vertices")
    parser.add_argument("--round", action="store_true", help="and round objects")
    parser.add_argument("--one-round", nargs=2, metavar=("OBJECT", "METHOD"))
    parser.add_argument("--sublevels", action="store_true", help="and all minima of a hand")
    parser.add_argument("--one-sublevels", metavar="OUTLINE", choices=SUBLEVELS)
    options = parser.parse_args()
    machine_code_at_once()
    if options.one_sublevels:
        print(json.dumps(one_sublevels(options.one_sublevels)))
        return 0
    if options.one_round:
        name, method = options.one_round
        print(json.dumps(one_round(name, method)))
        return 0
    measure()
    figures = measure()
    if options.growth:
        growth(2, SIZES[:2])
        figures |= growth()
    if options.round:
        figures |= rounds()
    if options.sublevels:
        figures |= whole_sublevels()
    print(f"{'figure':<46} {'value':>12} {'/ yardstick':>12}")
    for name, value in figures.items():
        unit = 1.0 if name.endswith(("MB", "exponent")) else figures["yardstick"]
        print(f"{name:<46} {value:12.6g} {value / unit:12.4g}")
    if options.json is not None:
        options.json.write_text(json.dumps(figures, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
