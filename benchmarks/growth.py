"""How one plan grows with the number of vertices: ``python -m benchmarks.growth [--json FILE]``.

Stars with 20 to 600 vertices, targets of every kind, both methods in turns, warm, processor
seconds. A repeat gives the median over the targets; the spread is that of the repeats. The exponent
is that of a power of n fitted to the medians of a repeat.
"""

from __future__ import annotations

import argparse
import json
import statistics
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.random_objects import star, targets
from benchmarks.timing import REPEATS, seconds_of, spread, yardstick
from icage.kernels.compiled import machine_code_at_once
from icage.planner import METHODS, plan

SIZES = (20, 40, 80, 150, 300, 600)


def main() -> None:
    """Measure, print, write."""
    parser = argparse.ArgumentParser(description=__doc__, allow_abbrev=False)
    parser.add_argument("--json", type=Path, help="write the figures")
    parser.add_argument("--targets", type=int, default=5, help="on each star")
    parser.add_argument("--largest", type=int, default=SIZES[-1], help="number of vertices")
    parser.add_argument("--repeats", type=int, default=REPEATS)
    options = parser.parse_args()
    machine_code_at_once()
    sizes = tuple(n for n in SIZES if n <= options.largest)
    figures = growth(sizes, options.targets, options.repeats)
    print(f"{'method':<14} {'n':>4} {'least':>10} {'median':>10} {'largest':>10}  seconds")
    for row in figures["rows"]:
        least, middle, most = (row["seconds"][key] for key in ("min", "median", "max"))
        print(f"{row['method']:<14} {row['n']:>4} {least:10.3g} {middle:10.3g} {most:10.3g}")
    for method, exponent in figures["exponent"].items():
        print(f"{method}: n to the power of {exponent['median']:.3g}")
    if options.json is not None:
        options.json.write_text(json.dumps(figures, indent=1) + "\n")


def growth(sizes: tuple[int, ...], count: int, repeats: int) -> dict[str, Any]:
    """Seconds of a plan by method and n, and the exponents, each with the spread of repeats."""
    rng = np.random.default_rng(3)
    asked = {}
    for n in sizes:
        outline = star(n, rng)
        asked[n] = (outline, targets(outline, count, rng))
    medians: dict[str, list[list[float]]] = {method: [] for method in METHODS}
    for repeat in range(repeats + 1):  # the first one loads machine code and is not counted
        for method in METHODS:
            of_sizes = [
                statistics.median(
                    seconds_of(partial(plan, method=method), outline, grasp) for grasp in grasps
                )
                for outline, grasps in asked.values()
            ]
            if repeat > 0:
                medians[method].append(of_sizes)
    return {
        "yardstick": yardstick(),
        "rows": [
            {"method": method, "n": n, "seconds": spread(times)}
            for method, all_repeats in medians.items()
            for n, times in zip(sizes, zip(*all_repeats, strict=True), strict=True)
        ],
        "exponent": {
            method: spread(
                float(np.polyfit(np.log(sizes), np.log(of_sizes), 1)[0]) for of_sizes in all_repeats
            )
            for method, all_repeats in medians.items()
        },
    }


if __name__ == "__main__":
    main()
