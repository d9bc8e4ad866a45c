"""The search for grasps: seconds, candidates a second, and whether anything better was missed.

``python -m benchmarks.grasps [--json FILE] [--only NAME] [--discs-only] [--random N]``

Tools of ``benchmarks/outlines`` and the shipped ones, and stars and blobs drawn from a seed, with
point fingers and with discs of 2 % of the diameter, ten grasps each: the whole of ``icage grasps``
after its imports. ``--random N`` evaluates N random grasps, too (random triples of features and
points of concurrency), and says which of them beat the search: none should.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from pathlib import Path

import numpy as np

import icage
from benchmarks.timing import yardstick
from icage import Case, Outline
from icage.errors import GraspError
from icage.grasps.evaluator import GraspEvaluator
from icage.grasps.of_case import best_of_case
from icage.grasps.scores import score
from icage.grasps.wanted import Wanted
from icage.kernels.compiled import machine_code_at_once

OUTLINES = Path(__file__).with_name("outlines")
SHIPPED = ("pliers", "saw", "wrench")
RADIUS = 0.02
"""[diameter]"""

TOP = 10
WORKERS = 2


def star(n: int, seed: int) -> Outline:
    """A random star-shaped polygon."""
    rng = np.random.default_rng(seed)
    angle = np.sort(rng.random(n)) * 2.0 * np.pi
    radius = rng.uniform(0.4, 1.0, n)
    return Outline(np.column_stack([radius * np.cos(angle), radius * np.sin(angle)]) * 100.0)


def blob(n: int, seed: int) -> Outline:
    """A smooth closed curve of a few waves with n vertices."""
    rng = np.random.default_rng(seed)
    angle = np.arange(n) * 2.0 * np.pi / n
    radius = 1.0 + sum(
        rng.normal(0.0, 0.35 / k) * np.cos(k * angle + rng.uniform(0.0, 6.3)) for k in range(2, 7)
    )
    radius = np.maximum(radius, 0.25)
    return Outline(np.column_stack([radius * np.cos(angle), radius * np.sin(angle)]) * 100.0)


def outlines() -> dict[str, Outline]:
    """All that are searched, by name."""
    found = {path.stem: icage.load(path).outline for path in sorted(OUTLINES.glob("*.json"))}
    found |= {name: icage.load(name).outline for name in SHIPPED}
    found |= {f"star_{n}": star(n, n) for n in (60, 120, 200)}
    return found | {f"blob_{n}": blob(n, n) for n in (100, 200)}


def searched(outline: Outline, radius: float) -> dict[str, float]:
    """Seconds of the search and its plans, candidates compared, and the best score."""
    case = Case("object", "mm", outline, radius * outline.diameter)
    started = time.perf_counter()
    found = best_of_case(case, TOP, Wanted(), np.random.default_rng(0), WORKERS)
    seconds = time.perf_counter() - started
    return {
        "vertices": len(outline),
        "seconds": seconds,
        "candidates_per_second": found.compared / seconds,
        "grasps": len(found.cages),
        "best": score(found.cages[0], Wanted()) if found.cages else 0.0,
    }


def better_at_random(outline: Outline, radius: float, count: int, best: float) -> float:
    """The best score of so many random grasps over that of the search."""
    bench = GraspEvaluator(outline, radius * outline.diameter, Wanted())
    triples, points = bench.triples()
    rng = np.random.default_rng(1)
    rows = rng.integers(0, len(triples), count)
    spread = outline.diameter * rng.choice([0.02, 0.1, 0.3], count)
    moved = points[rows] + spread[:, None] * rng.standard_normal((count, 2))
    found = bench.grasps(triples[rows], moved)
    return float(found.score.max() / best) if len(found) and best else 0.0


def main() -> int:
    """Search them all, print, write."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--json", type=Path, help="write the figures")
    parser.add_argument("--only", help="the outlines whose name holds this")
    parser.add_argument("--discs-only", action="store_true")
    parser.add_argument("--random", type=int, default=0, metavar="N")
    options = parser.parse_args()
    machine_code_at_once()
    chosen = {k: v for k, v in outlines().items() if options.only is None or options.only in k}
    searched(next(iter(chosen.values())), RADIUS)
    rows: dict[str, dict[str, float]] = {}
    for fingers, radius in (("points", 0.0), ("discs", RADIUS)):
        if options.discs_only and not radius:
            continue
        for name, outline in chosen.items():
            try:
                row = searched(outline, radius)
            except GraspError as error:
                print(f"{name}, {fingers}: {error}", flush=True)
                continue
            if options.random:
                row["random_over_best"] = better_at_random(
                    outline, radius, options.random, row["best"]
                )
            rows[f"{name}, {fingers}"] = row
            shown = ", ".join(f"{key} {value:.5g}" for key, value in row.items())
            print(f"{name}, {fingers}: {shown}", flush=True)
    document = {
        "yardstick": yardstick(),
        "rows": rows,
        "seconds": {
            fingers: sorted(r["seconds"] for k, r in rows.items() if k.endswith(fingers))
            for fingers in ("points", "discs")
        },
    }
    if options.json is not None:
        options.json.write_text(json.dumps(document, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
