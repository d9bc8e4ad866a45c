"""All minima and merges of a hand: ``python -m benchmarks.whole_sublevels [--json FILE]``.

The equilateral hand on outlines of up to 300 vertices, each in a process of its own: seconds with
one thread and, of the clock and of the processor, with as many as there are cores; peak memory.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import time
from collections.abc import Iterable
from functools import partial
from pathlib import Path

import numpy as np

from benchmarks.random_objects import star
from benchmarks.timing import peak_of_this_program, seconds_of, yardstick
from icage.hand import HandShape
from icage.hand_sublevels import sublevels
from icage.kernels.compiled import machine_code_at_once
from icage.outline import Outline

SUBLEVELS = (
    "star_80", "star_150", "star_300", "blob_300", "comb_300", "regular_300", "gear_300",
    "spiky_300", "spur_300",
)  # fmt: skip
"""Outlines of ``sublevels``: a shape and its vertices; a spur has equal spikes, the worst case."""


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
        alone.append(seconds_of(partial(sublevels, workers=1), outline, hand))
        started = time.perf_counter()
        processor.append(seconds_of(sublevels, outline, hand))
        clock.append(time.perf_counter() - started)
    return figures | {
        "seconds_alone": min(alone),
        "seconds_processor": min(processor),
        "seconds_clock": min(clock),
        "peak_MB": peak_of_this_program(),
    }


def whole_sublevels(names: Iterable[str]) -> dict[str, float]:
    """``sublevels_<outline>_<figure>``, each outline in a process of its own."""
    figures: dict[str, float] = {}
    for name in names:
        asked = [sys.executable, "-m", "benchmarks.whole_sublevels", "--one", name]
        answer = subprocess.run(asked, check=True, capture_output=True, text=True)
        row = json.loads(answer.stdout)
        print(f"{name}: {row}", flush=True)
        for figure in ("seconds_alone", "seconds_processor", "seconds_clock"):
            figures[f"sublevels_{name}_{figure}"] = row[figure]
        figures[f"sublevels_{name}_MB"] = row["peak_MB"]
    return figures


def main() -> None:
    """Measure all, or one of them; print, write."""
    parser = argparse.ArgumentParser(description=__doc__, allow_abbrev=False)
    parser.add_argument("--json", type=Path, help="write the figures, name: value")
    parser.add_argument("--one", metavar="OUTLINE", choices=SUBLEVELS, help="in this process")
    parser.add_argument("--only", action="append", choices=tuple(SUBLEVELS), help="again for more")
    options = parser.parse_args()
    machine_code_at_once()
    if options.one:
        print(json.dumps(one_sublevels(options.one)))
        return
    figures = {"yardstick": yardstick()} | whole_sublevels(options.only or tuple(SUBLEVELS))
    if options.json is not None:
        options.json.write_text(json.dumps(figures, indent=1) + "\n")


if __name__ == "__main__":
    main()
