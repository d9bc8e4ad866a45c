"""Speed of the planner on one core, warm: ``python -m benchmarks.planner [--json FILE]``.

Processor seconds. Every figure is also given as a ratio to a yardstick measured in the same run
(sorting two million doubles), so that runs on different machines can be compared.

One search, one plan, regions and 100,000 queries on seeded random stars with 100 vertices and
targets of every kind; medians over many targets. How it grows with n is measured by
``python -m benchmarks.growth``.

``python -m benchmarks --only planner --compare`` compares with the committed baseline.
"""

from __future__ import annotations

import argparse
import json
import resource
import time
from pathlib import Path

import numpy as np

from benchmarks import timing
from benchmarks.random_objects import star, targets
from benchmarks.timing import seconds_of
from icage.cells.free_space import search
from icage.cells.membership import query
from icage.cells.regions import caging_regions
from icage.cells.target import contacts_as_configuration, find_target
from icage.kernels.compiled import machine_code_at_once
from icage.planner import plan

QUERIES = 100_000


def measure() -> dict[str, float]:
    """All figures, [s] unless the name says otherwise."""
    rng = np.random.default_rng(1)
    yardstick = timing.yardstick()
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
            single.append(seconds_of(search, free_space, target.cell, target.sigma_0))
            regions.append(seconds_of(caging_regions, cage))
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
        queries.append(seconds_of(query, cage, rows))
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


def main() -> None:
    """Measure (once before, to warm up) and print; ``python -m benchmarks`` compares."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--json", type=Path, help="write the figures, name: value")
    options = parser.parse_args()
    machine_code_at_once()
    measure()
    figures = measure()
    print(f"{'figure':<46} {'value':>12} {'/ yardstick':>12}")
    for name, value in figures.items():
        unit = 1.0 if name.endswith("MB") else figures["yardstick"]
        print(f"{name:<46} {value:12.6g} {value / unit:12.4g}")
    if options.json is not None:
        options.json.write_text(json.dumps(figures, indent=1) + "\n")


if __name__ == "__main__":
    main()
