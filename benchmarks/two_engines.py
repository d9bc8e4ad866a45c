r"""Both engines side by side, n = 20 to 320, warm, on one core.

    python -m benchmarks.two_engines --figure docs/figures/two_engines.svg \
        --update-baseline

Processor seconds of a search from the target (the pieces of the plane are cut beforehand, the
tunnel edges are not) on seeded random stars, medians over targets of every kind, and their ratio to
a yardstick measured in the same run (sorting two million doubles).
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from benchmarks.random_objects import star, targets
from benchmarks.timing import seconds_of, yardstick
from experiments.figures.drawing.palette import FINGERS
from icage.cells.free_space import FreeSpace, search
from icage.cells.target import contacts_as_configuration, find_target
from icage.contact_space.exploration import Plane, explore_from
from icage.contact_space.target import find_contact_target
from icage.hand import HandShape
from icage.kernels.compiled import machine_code_at_once
from icage.tolerance import TARGET_SHIFT, TARGET_TURN

BASELINE = Path(__file__).with_name("two_engines_baseline.json")
SIZES = (20, 40, 80, 100, 160, 320)
COLOURS = {"cells": FINGERS[0], "contact_space": FINGERS[1]}


def measure(sizes: tuple[int, ...], count: int) -> dict[str, Any]:
    """Medians and maxima [s] by engine and size, and the counters of the contact space."""
    rng = np.random.default_rng(5)
    rows: dict[str, Any] = {"yardstick": yardstick()}
    for n in sizes:
        cells: list[float] = []
        contact: list[float] = []
        counters: list[tuple[int, ...]] = []
        for outline in (star(n, rng) for _ in range(3)):
            for contacts in targets(outline, count, rng):
                hand = HandShape.from_contacts(contacts)
                free_space = FreeSpace.around(outline, hand)
                at = find_target(free_space, contacts_as_configuration(free_space, contacts))
                plane = Plane.around(outline, hand)
                begin = find_contact_target(plane, contacts, reach=TARGET_SHIFT, turn=TARGET_TURN)
                if at is None or begin is None:
                    continue
                cells.append(seconds_of(search, free_space, at.cell, at.sigma_0))
                contact.append(seconds_of(explore_from, plane, begin.region))
                found = explore_from(plane, begin.region)
                log = found.log()
                counters.append((len(found.regions), log.rectangles_explored, log.nodes))
        regions, rectangles, nodes = np.median(counters, axis=0).tolist()
        rows[str(n)] = {
            "targets": len(cells),
            "cells_median": float(np.median(cells)),
            "cells_max": float(np.max(cells)),
            "contact_space_median": float(np.median(contact)),
            "contact_space_max": float(np.max(contact)),
            "regions_median": regions,
            "rectangles_median": rectangles,
            "rectangles_total": 3 * n * n,
            "nodes_median": nodes,
        }
    return rows


def draw(rows: dict[str, Any], path: Path) -> None:
    """Both medians against n, both axes logarithmic, with the slopes of a fitted line."""
    sizes = [int(n) for n in rows if n != "yardstick"]
    figure = Figure(figsize=(4.6, 3.2), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    for engine, colour in COLOURS.items():
        times = [1e3 * rows[str(n)][f"{engine}_median"] for n in sizes]
        worst = [1e3 * rows[str(n)][f"{engine}_max"] for n in sizes]
        slope = np.polyfit(np.log(sizes), np.log(times), 1)[0]
        name = engine.replace("_", " ")
        axes.plot(sizes, times, "o-", color=colour, label=f"{name}: median, $n^{{{slope:.1f}}}$")
        axes.plot(sizes, worst, ":", color=colour, lw=1.0, label=f"{name}: slowest")
    axes.set(xscale="log", yscale="log", xlabel="vertices n", ylabel="one search [ms]")
    axes.set_xticks(sizes, [str(n) for n in sizes])
    axes.minorticks_off()
    axes.legend(frameon=False, fontsize=8)
    axes.spines[["top", "right"]].set_visible(False)
    with matplotlib.rc_context({"svg.hashsalt": "icage"}):
        figure.savefig(path, metadata={"Date": None} if path.suffix == ".svg" else None, dpi=160)


def main() -> int:
    """Warm up, measure, print, compare with the baseline."""
    parser = argparse.ArgumentParser(description=__doc__, allow_abbrev=False)
    parser.add_argument("--count", type=int, default=12, help="targets an outline, three a size")
    parser.add_argument("--json", type=Path, help="write the figures")
    parser.add_argument("--figure", type=Path)
    parser.add_argument("--update-baseline", action="store_true")
    options = parser.parse_args()
    machine_code_at_once()
    measure((20,), 2)
    rows = measure(SIZES, options.count)
    base = json.loads(BASELINE.read_text()) if BASELINE.exists() else rows
    print("      n  targets   cells [ms]  contact space [ms]  /yardstick (baseline)  regions")
    for n in (n for n in rows if n != "yardstick"):
        row, was = rows[n], base.get(n, rows[n])
        ratio = row["contact_space_median"] / rows["yardstick"]
        before = was["contact_space_median"] / base["yardstick"]
        print(
            f"{n:>7}  {row['targets']:7d}  {1e3 * row['cells_median']:11.3f}"
            f"  {1e3 * row['contact_space_median']:18.3f}  {ratio:10.4f} ({before:8.4f})"
            f"  {row['regions_median']:7.0f}"
        )
    for path in [BASELINE] * options.update_baseline + [options.json] * bool(options.json):
        path.write_text(json.dumps(rows, indent=1) + "\n")
    if options.figure is not None:
        draw(rows, options.figure)
    return 0


if __name__ == "__main__":
    sys.exit(main())
