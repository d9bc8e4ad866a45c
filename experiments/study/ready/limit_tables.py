"""Tables of where the guarantee ends: friction, speed, time step, inertia, compliance.

    python3 -m experiments.study.ready.limit_tables CASE [TRIALS] [guaranteed|rest]

prints the tables of docs/physics.md for starts drawn from that set of the cage with seed 0; point
fingers become discs.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import replace
from typing import Final

import numpy as np

from experiments.cases.with_discs import physical_case
from icage.formats.load import load
from icage.geometry.contact_types import supports
from icage.sampling import StartSet, draw_starts
from sim.closing.quasi_static import CHANGES, compare
from sim.grip.friction import friction_table
from sim.world.config import SimConfig
from sim.world.scene import Scene

FRICTION_TIME: Final = 1.0
"""[s] Jammed objects creep, faster than a frictionless closing that counts as still: the ends are
looked at after this and after twice this. (A study has a rule of its own for such objects.)"""


def tables(name: str, trials: int, which: StartSet, seed: int = 0) -> Iterator[str]:
    """Lines of both tables; the friction table only for three-edge targets."""
    physical = physical_case(load(name))
    case, cage = physical.case, physical.cage
    rng = np.random.default_rng(seed)
    starts = draw_starts(cage, which, trials, rng).placements
    scene = Scene(case.outline, cage.hand, case.finger_radius, SimConfig())
    yield f"{case.name}, {trials} starts of the {which} set, seed {seed}"
    if supports(case.outline, cage.contacts, case.finger_radius).three_edges:
        brief = replace(scene.config, max_time=FRICTION_TIME)
        rough = Scene(case.outline, cage.hand, case.finger_radius, brief)
        yield "mu     on edges  worst |theta|  atan(mu)  drift"
        for row in friction_table(rough, cage.contacts, starts):
            yield (
                f"{row.mu:<5g}  {row.on_edges:>8d}  {row.worst:13.5f}  {row.bound:8.5f}  "
                f"{row.drift:.1e}{'' if row.holds else '  OVER'}"
            )
    yield "speed  step  inertia  yielding  changed  timed out  position  angle    deepest"
    for one in compare(scene, cage.grasps, starts, CHANGES):
        what = one.change
        yield (
            f"{what.speed:<5g}  {what.step:<4g}  {what.inertia:<7g}  {what.yielding:<8g}  "
            f"{one.changed:>7d}  {one.timed_out:>9d}  "
            f"{one.position:.1e}   {one.angle:.1e}  {one.penetration:.1e}"
        )


def main(case: str, trials: str = "40", which: str = "guaranteed") -> None:
    """Print the tables."""
    for line in tables(case, int(trials), "rest" if which == "rest" else "guaranteed"):
        print(line, flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
