r"""How long a plan with disc fingers takes against one with point fingers on the same outline.

    python -m benchmarks.discs --json benchmarks/discs.json

Random stars with n vertices and a random grasp for each kind of finger, radius 3 % of the diameter.
Every plan is timed five times, warm, all kinds in turn: minimum, median and maximum, [ms] of
processor time. ``ratio`` is that of the medians over all outlines of one n. ``grown`` is a plan
with point fingers on the polygon that stands for the outline grown by the radius (chords of an
eighth of a quadrant, ``vertices`` of them): the same question, answered to 1e-4.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from pathlib import Path

import numpy as np

from icage.discs.curve import TrueCurve
from icage.discs.on_curve import SEGMENTS
from icage.errors import IcageError
from icage.kernels.compiled import machine_code_at_once
from icage.outline import Outline
from icage.planner import plan
from tests.oracles.geometry import Floats, Ring
from tests.oracles.targets import grasp_on

SIZES = (10, 20, 30, 40, 50, 60)
REPEATS = 5
RADIUS = 0.03
"""[diameter]"""
_TRIES = 50


def star(n: int, rng: np.random.Generator) -> Floats:
    """A star-shaped polygon with n vertices."""
    angle = np.sort(rng.uniform(0.0, 2.0 * np.pi, n))
    radius = rng.uniform(0.35, 1.0, n)
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])


def grown(outline: Outline, contacts: Floats, radius: float) -> tuple[Outline, Floats]:
    """Chords of the outline grown by the radius, and the grasp of disc fingers on them."""
    at = plan(outline, contacts, radius).contacts
    curve = TrueCurve.of(outline, radius)
    return curve.inner(SEGMENTS[0], curve.on_arcs(at)), at


def pair(n: int, rng: np.random.Generator) -> tuple[Outline, Floats, Floats, float] | None:
    """An outline, the contacts of points and of discs on it, and the discs' radius."""
    for _ in range(_TRIES):
        ring = Ring.of(star(n, rng))
        radius = RADIUS * ring.diameter
        points, discs = grasp_on(ring, rng), grasp_on(ring, rng, radius)
        if points is None or discs is None:
            continue
        outline = Outline(ring.vertices)
        try:
            plan(outline, points)
            plan(outline, discs, radius)
        except IcageError:
            continue  # a contact in a pocket that the fingers cannot enter
        return outline, points, discs, radius
    return None


def timed(outline: Outline, contacts: Floats, radius: float) -> float:
    """Processor milliseconds of one plan."""
    began = time.process_time()
    plan(outline, contacts, radius)
    return 1e3 * (time.process_time() - began)


def spread(times: list[float]) -> dict[str, float]:
    """Minimum, median and maximum."""
    return {"min": min(times), "median": float(np.median(times)), "max": max(times)}


def measure(n: int, outlines: int, rng: np.random.Generator) -> dict[str, object]:
    """Both kinds of plans on some outlines with n vertices."""
    points: list[list[float]] = []
    discs: list[list[float]] = []
    polygons: list[list[float]] = []
    vertices: list[int] = []
    for _ in range(outlines):
        found = pair(n, rng)
        if found is None:
            continue
        outline, at_points, at_discs, radius = found
        polygon, at_polygon = grown(outline, at_discs, radius)
        vertices.append(len(polygon))
        points.append([])
        discs.append([])
        polygons.append([])
        for _ in range(REPEATS):
            points[-1].append(timed(outline, at_points, 0.0))
            discs[-1].append(timed(outline, at_discs, radius))
            polygons[-1].append(timed(polygon, at_polygon, 0.0))
    one = [float(np.median(t)) for t in points]
    other = [float(np.median(t)) for t in discs]
    third = [float(np.median(t)) for t in polygons]
    return {
        "n": n,
        "outlines": len(points),
        "point_ms": spread(one),
        "disc_ms": spread(other),
        "grown_ms": spread(third),
        "vertices": float(np.median(vertices)),
        "ratio": float(np.median(other)) / float(np.median(one)),
        "ratio_grown": float(np.median(other)) / float(np.median(third)),
        "runs": {"point_ms": points, "disc_ms": discs, "grown_ms": polygons},
    }


def main() -> int:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--outlines", type=int, default=11, help="outlines of each size")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", type=Path, help="write the figures")
    options = parser.parse_args()
    machine_code_at_once()
    rng = np.random.default_rng(options.seed)
    rows: list[dict[str, object]] = []
    for n in SIZES:
        row = measure(n, options.outlines, rng)
        rows.append(row)
        print({key: value for key, value in row.items() if key != "runs"}, flush=True)
    if options.json is not None:
        options.json.write_text(json.dumps({"radius": RADIUS, "rows": rows}, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
