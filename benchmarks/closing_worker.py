"""Closes for ``benchmarks.closing_against``, with the code of whatever checkout is on its path.

One JSON line in, one out: {"grasp": NAME, "starts": FILE.npy, "friction": MU, "out": FILE.npz} ->
{"seconds": processor seconds of closing, "steps": mean}. It calls only what both checkouts have.
"""

from __future__ import annotations

import dataclasses
import json
import sys
import time

import numpy as np

import models
from icage.outline import Outline
from sim.closing.batch import close_many
from sim.world.config import SimConfig
from sim.world.scene import Scene
from tests.sim.grasps import KnownGrasp, l_shape, shipped, t_shape, triangle


def of_file(name: str) -> KnownGrasp:
    """The grasp of a shipped case of a tool."""
    case = json.loads((models.CASES.parent / "objects" / name).read_text())
    contacts = np.array(case["grasp"]["contacts"])
    return KnownGrasp(Outline(case["outline"]["vertices"]), case["finger_radius"], contacts)


GRASPS = {
    "T": t_shape,
    "L": l_shape,
    "pliers": lambda: shipped("pliers"),
    "saw": lambda: shipped("saw"),
    "triangle": triangle,
}
"""Of ``tests.sim.grasps.GRASPS``, which an older checkout does not have."""

WITH_REST = {
    "pliers_4": lambda: of_file("pliers/cases/4_with_rest.json"),
    "saw_2": lambda: of_file("saw/cases/2_with_rest.json"),
    "wrench_1": lambda: of_file("wrench/cases/1_best.json"),
}
"""Grasps whose cages have more than the guaranteed set."""

ALL = GRASPS | WITH_REST


def main() -> None:
    """Answer requests until the input ends."""
    scenes: dict[tuple[str, float], Scene] = {}
    for line in sys.stdin:
        asked = json.loads(line)
        key = asked["grasp"], asked["friction"]
        if key not in scenes:
            max_time = 2.0 if asked["friction"] else 20.0
            config = SimConfig(friction=asked["friction"], max_time=max_time)
            scenes[key] = ALL[asked["grasp"]]().scene(config)
        starts = np.load(asked["starts"])
        begin = time.process_time()
        closings = close_many(scenes[key], starts, 1)
        seconds = time.process_time() - begin
        found = {f.name: getattr(closings, f.name) for f in dataclasses.fields(closings)}
        np.savez(asked["out"], **found)
        answer = {"seconds": seconds, "steps": float(closings.steps.mean())}
        print(json.dumps(answer), flush=True)


if __name__ == "__main__":
    main()
