"""What cannot change a cage: motion, scale, distance, names, where a ring begins, a mirror."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from random import Random
from typing import Final

import numpy as np

from icage.agreement import disagreements
from icage.cage import Cage
from icage.planner import plan
from tests.fuzz.job import Job
from tests.oracles.geometry import Floats
from tests.oracles.polygons import FAMILIES, rotated
from tests.oracles.targets import random_target

EXACT: Final = 1e-9
"""[1] Levels, relative to sigma_0, of point fingers."""

OF_DISCS: Final = 1e-4
"""[1] ... of disc fingers, whose levels lie in brackets of this width."""

Told = tuple[Floats, Floats, float]
"""The same object and grasp, told otherwise, and the length that has become of 1."""


def _moved(ring: Floats, contacts: Floats, random: Random) -> Told:
    angle = random.uniform(-3.2, 3.2)
    shift = (random.uniform(-9, 9), random.uniform(-9, 9))
    return rotated(ring, angle, shift), rotated(contacts, angle, shift), 1.0


def _scaled(ring: Floats, contacts: Floats, random: Random) -> Told:
    scale = 10.0 ** random.uniform(-11, 11)
    return ring * scale, contacts * scale, scale


def _far(ring: Floats, contacts: Floats, random: Random) -> Told:
    """By a power of two, on coordinates of few enough digits: nothing is rounded."""
    far = np.array([random.choice((-1, 1)), random.choice((-1, 1))]) * 2.0 ** random.randint(0, 20)
    return ring + far, contacts + far, 1.0


def _relabelled(ring: Floats, contacts: Floats, random: Random) -> Told:
    first = random.choice((1, 2))
    new = np.roll(contacts, -first, axis=0)
    sides = [float(np.hypot(*(c[1] - c[0]))) for c in (contacts, new)]
    return ring, new, sides[1] / sides[0]


def _begun_elsewhere(ring: Floats, contacts: Floats, random: Random) -> Told:
    turned = np.roll(ring, random.randrange(len(ring)), axis=0)
    return turned[:: random.choice((1, -1))], contacts, 1.0


def _edges_cut(ring: Floats, contacts: Floats, random: Random) -> Told:
    """Vertices on the edges, and some vertices twice."""
    rows: list[Floats] = []
    for p, q in zip(ring, np.roll(ring, -1, axis=0), strict=True):
        rows += [p] * random.choice((1, 1, 2))
        if random.random() < 0.5:
            rows.append(0.5 * (p + q))
    return np.array(rows), contacts, 1.0


def _mirrored(ring: Floats, contacts: Floats, random: Random) -> Told:
    mirror = np.array([-1.0, 1.0])
    return ring * mirror, contacts[[1, 0, 2]] * mirror, 1.0


LAWS: Final[dict[str, Callable[[Floats, Floats, Random], Told]]] = {
    "moved": _moved,
    "scaled": _scaled,
    "far": _far,
    "relabelled": _relabelled,
    "begun elsewhere": _begun_elsewhere,
    "edges cut": _edges_cut,
    "mirrored": _mirrored,
}


def lawful_case(random: Random) -> Job:
    """A random object with a grasp, and a law that is to hold of it."""
    rng = np.random.default_rng(random.getrandbits(64))
    radius = random.uniform(0.01, 0.05) if random.random() < 0.2 else 0.0
    target = random_target(rng, random.choice(sorted(FAMILIES)), radius)
    document = {
        "vertices": target.vertices.tolist(),
        "contacts": target.contacts.tolist(),
        "radius": target.radius,
    }
    law = random.choice(sorted(LAWS))
    return Job({"a.json": json.dumps(document).encode()},
               ("a.json", law, str(random.getrandbits(32))), "law")  # fmt: skip


def broken(path: Path, law: str, seed: int) -> str:
    """In what a law does not hold of the object in a file; empty if it does."""
    given = json.loads(path.read_text())
    ring, contacts = np.array(given["vertices"]), np.array(given["contacts"])
    radius = given["radius"]
    if law == "far":
        ring, contacts = (np.round(points * 2.0**30) / 2.0**30 for points in (ring, contacts))
    told, held, length = LAWS[law](ring, contacts, Random(seed))
    unit = 1.0 if law == "relabelled" else length
    here, there = plan(ring, contacts, radius), plan(told, held, radius * unit)
    lines = disagreements(_scaled_by(here, length), there, OF_DISCS if radius else EXACT)
    if len(here.grasps) != len(there.grasps) and not radius:
        lines.append(f"{len(here.grasps)} grasps against {len(there.grasps)}")
    return "; ".join(lines)


def _scaled_by(cage: Cage, length: float) -> Cage:
    from dataclasses import replace

    names = ("sigma_0", "sigma_first", "sigma_max", "sigma_max_upper", "sigma_max_lower")
    levels = {name: getattr(cage, name) for name in names}
    scaled = {name: None if v is None else v * length for name, v in levels.items()}
    return replace(cage, **scaled)
