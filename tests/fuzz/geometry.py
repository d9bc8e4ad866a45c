"""Geometry at the ends of what is allowed: both methods agree, or it is refused."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from random import Random
from typing import Any, Final

import numpy as np

from icage.errors import InputError
from icage.geometry.near_frame import NearFrame
from icage.grasps.evaluator import GraspEvaluator
from icage.grasps.wanted import ANY_HAND, Wanted
from icage.outline import Outline
from tests.fuzz.job import Job
from tests.oracles.geometry import Floats
from tests.oracles.polygons import FAMILIES
from tests.oracles.targets import random_target
from tests.zoo.shapes import VALID

Bent = Callable[[Floats, Random], Floats]

TRIED: Final = 40
"""Triples of features that are looked at for grasps."""

KEPT: Final = 2
"""Grasps of an object that both methods plan."""


def _power(random: Random, low: float, high: float) -> float:
    return 10.0 ** random.uniform(low, high)


def _needle(ring: Floats, random: Random) -> Floats:
    """So much flatter than long."""
    return ring * np.array([1.0, _power(random, -8.5, -2)])[:: random.choice((1, -1))]


def _sized(ring: Floats, random: Random) -> Floats:
    return ring * _power(random, -12, 12)


def _far(ring: Floats, random: Random) -> Floats:
    return ring + np.array([random.uniform(-1, 1), random.uniform(-1, 1)]) * _power(random, 0, 12)


def _twin_vertices(ring: Floats, random: Random) -> Floats:
    """Vertices beside vertices."""
    rows: list[Floats] = []
    for point in ring:
        rows.append(point)
        if random.random() < 0.4:
            offset = np.array([random.uniform(-1, 1), random.uniform(-1, 1)])
            rows.append(point + offset * _power(random, -17, -5))
    return np.array(rows)


def _nearly_straight(ring: Floats, random: Random) -> Floats:
    """Vertices on edges, or beside them."""
    rows: list[Floats] = []
    for p, q in zip(ring, np.roll(ring, -1, axis=0), strict=True):
        rows.append(p)
        if random.random() < 0.6:
            across = np.array([p[1] - q[1], q[0] - p[0]])
            rows.append(p + random.uniform(0.01, 0.99) * (q - p) + across * _bump(random))
    return np.array(rows)


def _bump(random: Random) -> float:
    return random.choice((0.0, 1.0, -1.0)) * _power(random, -17, -4)


def _nearly_touching(ring: Floats, random: Random) -> Floats:
    """A vertex moved to an edge that is not its own, up to a hair."""
    out = ring.copy()
    k = random.randrange(len(ring))
    j = (k + random.randrange(2, max(3, len(ring) - 1))) % len(ring)
    p, q = ring[j], ring[(j + 1) % len(ring)]
    foot = p + random.uniform(0.1, 0.9) * (q - p)
    out[k] = foot + (ring[k] - foot) * _power(random, -16, -3)
    return out


def _rounded(ring: Floats, random: Random) -> Floats:
    """Few digits: parallel edges and equal lengths by accident."""
    step = random.choice((0.5, 0.25, 0.125, 0.1, 0.01))
    return np.round(ring / step) * step


def _as_it_is(ring: Floats, random: Random) -> Floats:
    return ring


_BENT: Final[tuple[Bent, ...]] = (
    _needle, _sized, _far, _twin_vertices, _nearly_straight, _nearly_touching, _rounded, _as_it_is
)  # fmt: skip


def hostile_case(random: Random) -> Job:
    """A polygon bent once or twice, with a grasp of its own where it is still one of it."""
    rng = np.random.default_rng(random.getrandbits(64))
    radius = random.choice((0.0, 0.0, 0.03)) * random.random()
    ring, contacts = np.array(random.choice(VALID).vertices), None
    if random.random() < 0.8:
        target = random_target(rng, random.choice(sorted(FAMILIES)), radius)
        ring, contacts, radius = target.vertices, target.contacts, target.radius
    for _ in range(random.choice((1, 1, 2))):
        bend = random.choice(_BENT)
        ring = bend(ring, random)
        if bend not in (_twin_vertices, _nearly_straight, _as_it_is):
            contacts = None
    document: dict[str, Any] = {
        "format": "icage-case/1", "name": "bent", "unit": "mm", "finger_radius": radius,
        "outline": {"vertices": ring.tolist()},
    }  # fmt: skip
    if contacts is not None:
        document["grasp"] = {"contacts": contacts.tolist()}
    return Job({"a.json": json.dumps(document).encode(), "b.json": b"{}"}, ("a.json",), "geometry")


def agree_or_refuse(arguments: tuple[str, ...]) -> int:
    """Plan the case, or grasps found for its object, by both methods; the first code not 0."""
    from tests.fuzz.calls import command, refused

    path = Path(arguments[0])
    document = json.loads(path.read_text())
    if "grasp" in document:
        return command(("plan", str(path), "--method", "both"))
    try:
        outline = Outline(document["outline"]["vertices"])
        radius = document["finger_radius"] * outline.diameter
        found = grasps_on(outline, radius)
    except InputError as error:
        return refused(error)
    for contacts in found:
        document |= {"grasp": {"contacts": contacts.tolist()}, "finger_radius": radius}
        path.with_name("b.json").write_text(json.dumps(document))
        code = command(("plan", "b.json", "--method", "both"))
        if code:
            return code
    return 0


def grasps_on(outline: Outline, radius: float) -> list[Floats]:
    """Contacts of a few grasps that the search takes for cages; radius in [unit]."""
    frame = NearFrame.of(outline)  # the evaluator, like all within the search, knows no other
    bench = GraspEvaluator(frame.outline_into(outline), radius, Wanted(limits=ANY_HAND))
    triples, points = bench.triples()
    few = np.linspace(0, len(triples) - 1, min(TRIED, len(triples)), dtype=int)
    found = [bench.at(triples[k], points[k]) for k in few]
    return [frame.back(one.contacts) for one in found if one is not None][:KEPT]
