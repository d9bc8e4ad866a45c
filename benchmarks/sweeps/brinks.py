"""Hands made to stand on a brink, and whether the plan of what they close to tells of it.

    python -m benchmarks.sweeps.brinks --count 50

On random polygons: the normals of three edges meet in one point, of two of them in their midst and
of the third at its end. An exact closing without friction from beside that hand, to the side that
leads down, ends in the target. Where sigma_first is above the hand, the brink has to be no higher.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from typing import Final

import numpy as np
from numpy.random import Generator

import icage
from benchmarks.sweeps.wedges import is_target
from icage import Outline
from icage.arrays import FloatArray
from icage.kernels.compiled import machine_code_at_once
from tests.oracles.geometry import Ring, configuration, size_of, unit_hand
from tests.oracles.planar_closing import ClosingError, close_hand
from tests.oracles.polygons import (
    comb_polygon,
    lattice_polygon,
    random_polygon,
    star_polygon,
    tool_polygon,
)

FAMILIES: Final = (lattice_polygon, random_polygon, star_polygon, tool_polygon, comb_polygon)
MOST: Final = 20_000
"""Polygons drawn at most."""


def made(ring: Ring, radius: float, rng: Generator) -> FloatArray | None:
    """Fingers (3, 2), counterclockwise, of a hand on a brink; None if none was found."""
    n, size = len(ring.starts), ring.diameter
    for _ in range(300):
        edges = rng.choice(n, 3, replace=False)
        third, at_end = int(edges[2]), bool(rng.random() < 0.5)
        if ring.concave[(third + 1) % n if at_end else third]:
            continue
        out = ring.normals[edges]
        cross = [out[k - 1, 0] * out[k, 1] - out[k - 1, 1] * out[k, 0] for k in range(len(out))]
        if not (min(cross) > 0.1 or max(cross) < -0.1):
            continue  # they push to one side
        vertex = (ring.ends if at_end else ring.starts)[third]
        meet = vertex - out[2] * rng.uniform(-0.2, 1.0) * size
        along = ((meet - ring.starts[edges]) * ring.tangents[edges]).sum(axis=1)[:2]
        edge = 0.02 * size
        if not ((edge < along) & (along < ring.lengths[edges][:2] - edge)).all():
            continue
        feet = ring.starts[edges[:2]] + along[:, None] * ring.tangents[edges[:2]]
        hand = np.vstack([feet, vertex]) + radius * out
        if max(ring.depth(finger, radius) for finger in hand) <= 1e-9 * size:
            x, y = (hand - hand.mean(axis=0)).T
            return hand[np.argsort(np.arctan2(y, x))]
    return None


def led_to(ring: Ring, hand: FloatArray, radius: float, rng: Generator) -> FloatArray | None:
    """What a hand beside the brink closes to if it does not stop there: fingers (3, 2)."""
    q = configuration(hand)
    for _ in range(12):
        start = q + rng.normal(size=4) * 1e-3 * ring.diameter
        start[2:] *= 1.004
        try:
            end = close_hand(ring, unit_hand(hand), start, radius)
        except ClosingError:
            continue
        if not end.escaped and end.sigma < size_of(q) * (1.0 - 1e-3):
            return end.contacts
    return None


def main() -> int:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=50, help="of points and of discs")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    machine_code_at_once()
    wrong = 0
    for kind in ("points", "discs"):
        rng = np.random.default_rng([options.seed, int(kind == "discs")])
        total: Counter[str] = Counter()
        for _ in range(MOST):
            if total["made"] >= options.count:
                break
            outline = Outline(FAMILIES[rng.integers(len(FAMILIES))](rng))
            ring = Ring.of(outline.vertices)
            radius = rng.uniform(0.01, 0.05) * ring.diameter if kind == "discs" else 0.0
            hand = made(ring, radius, rng)
            target = None if hand is None else led_to(ring, hand, radius, rng)
            if hand is None or target is None:
                continue
            try:
                cage = icage.plan(outline, target, radius)
            except icage.IcageError:
                continue
            sigma = size_of(configuration(hand))
            first = np.inf if cage.sigma_first is None else cage.sigma_first
            if (
                cage.status == "not_a_cage"
                or first <= sigma * (1.0 + 1e-6)
                or is_target(cage, hand)
            ):
                continue
            total["made"] += 1
            told = cage.brink is not None and cage.brink.sigma <= sigma * (1.0 + 1e-7)
            total["told"] += told
            if not told:
                print(f"  {kind}: {cage}, {cage.brink}, made at {sigma}")
        wrong += total["made"] - total["told"]
        print(f"{kind}: {dict(total)}", flush=True)
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
