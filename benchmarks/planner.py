"""Speed of the planner on one core, warm: ``python -m benchmarks.planner [--json FILE]``.

Processor seconds. Every figure is also given as a ratio to a yardstick measured in the same run
(sorting two million doubles), so that runs on different machines can be compared. Outlines are
seeded random stars with 100 vertices and targets of every kind; medians over many targets.
"""

from __future__ import annotations

import argparse
import json
import resource
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from icage.cells.free_space import search
from icage.cells.membership import query
from icage.cells.regions import caging_regions
from icage.cells.target import contacts_as_configuration, find_target
from icage.grasps.evaluator import GraspEvaluator
from icage.grasps.wanted import Wanted
from icage.outline import Outline
from icage.planner import plan

BASELINE = Path(__file__).with_name("planner_baseline.json")
QUERIES = 100_000
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


def main() -> int:
    """Measure twice (the first warms the caches), print, compare with the baseline."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, help="write the figures")
    parser.add_argument("--update-baseline", action="store_true")
    options = parser.parse_args()
    measure()
    figures = measure()
    base = json.loads(BASELINE.read_text()) if BASELINE.exists() else figures
    print(f"{'figure':<32} {'value':>12} {'/ yardstick':>12} {'baseline':>12}")
    for name, value in figures.items():
        unit = 1.0 if name.endswith("MB") else figures["yardstick"]
        was = base[name] / (1.0 if name.endswith("MB") else base["yardstick"])
        print(f"{name:<32} {value:12.6g} {value / unit:12.4g} {was:12.4g}")
    if options.update_baseline:
        BASELINE.write_text(json.dumps(figures, indent=1) + "\n")
    if options.json is not None:
        options.json.write_text(json.dumps(figures, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
