"""A zoo of named outlines: plain ones, awkward ones, and those that must be refused.

Valid shapes carry nothing but their vertices; every one of them has an immobilizing grasp. Refused
ones carry the error that an Outline raises.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from icage.errors import OutlineError
from icage.outline import MAX_VERTICES
from tests.oracles.geometry import Floats
from tests.oracles.polygons import rotated


@dataclass(frozen=True, slots=True, eq=False)
class Shape:
    """An outline (n, 2) in the zoo, and the error class it is refused with (None: it is valid)."""

    name: str
    vertices: Any
    refused: type[Exception] | None = None
    contacts: Floats | None = None
    """A grasp by hand, where the search looks at no hand as flat as the object asks for."""


def ngon(n: int) -> Floats:
    """Regular polygon of circumradius 1."""
    turn = 2.0 * np.pi * np.arange(n) / n
    return np.column_stack([np.cos(turn), np.sin(turn)])


def star(points: int, inner: float) -> Floats:
    """Star with ``points`` tips of radius 1."""
    ring = ngon(2 * points)
    ring[1::2] *= inner
    return ring


def comb(teeth: int) -> Floats:
    """A bar with straight teeth, all parallel and equally long."""
    ring = [(0.0, 0.0), (2.0 * teeth - 1.0, 0.0)]
    for k in reversed(range(teeth)):
        ring += [(2.0 * k + x, y) for x, y in ((1, 1), (1, 3), (0, 3), (0, 1))]
    return np.array([p for p in ring if p not in ((2.0 * teeth - 1.0, 1), (0.0, 1))])


def spiral() -> Floats:
    """A square arm wound one and a half times."""
    return np.array([
        (0, 0), (7, 0), (7, 7), (1, 7), (1, 2), (5, 2), (5, 5), (3, 5), (3, 4), (4, 4), (4, 3),
        (2, 3), (2, 6), (6, 6), (6, 1), (0, 1),
    ], dtype=np.float64)  # fmt: skip


TRIANGLE = np.array([[0.0, 0.0], [1.0, 0.0], [0.4, 0.8]])
SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
L = np.array([[0, 0], [2, 0], [2, 0.7], [0.7, 0.7], [0.7, 2], [0, 2]], dtype=np.float64)
T = np.array([[-1.5, 2], [-1.5, 1], [-0.4, 1], [-0.4, 0], [0.4, 0], [0.4, 1], [1.5, 1], [1.5, 2]])
HOUR_GLASS = np.array([[0, 0], [2, 0], [1.4, 1], [2, 2], [1, 2.4], [0, 2], [0.6, 1]])
NOTCHED = np.array([[0, 0], [4, 0], [4, 2], [2, 1], [0, 2]], dtype=np.float64)


def middles_added(ring: Floats) -> Floats:
    """Every edge cut in two: collinear vertices."""
    return np.stack([ring, 0.5 * (ring + np.roll(ring, -1, axis=0))], axis=1).reshape(-1, 2)


def touched_by_incircle(triangle: Floats) -> Floats:
    """Where the inscribed circle of a triangle touches its sides: these three points hold it."""
    a, b, c = triangle
    side = [float(np.hypot(*(p - q))) for p, q in ((b, c), (c, a), (a, b))]
    half = 0.5 * sum(side)
    return np.array([
        a + (half - side[0]) * (b - a) / side[2],
        b + (half - side[1]) * (c - b) / side[0],
        c + (half - side[2]) * (a - c) / side[1],
    ])  # fmt: skip


NEEDLE = np.array([[0.0, 0.0], [1.0, 0.004], [0.3, 0.01]])
GRASPS: dict[str, Floats] = {
    "sliver": np.array([[4.9, 0.0], [5.15, 0.0], [5.0, 0.15]]),
    "needle": touched_by_incircle(NEEDLE),
}

VALID: tuple[Shape, ...] = tuple(
    Shape(name, np.array(vertices, dtype=np.float64), contacts=GRASPS.get(name))
    for name, vertices in {
        "triangle": TRIANGLE,
        "equilateral triangle": ngon(3),
        "L": L,
        "T": T,
        "Z": [[0, 0], [2, 0], [2, 2], [3, 2], [3, 3], [1, 3], [1, 1], [0, 1]],
        "cross": [[1, 0], [2, 0], [2, 1], [3, 1], [3, 2], [2, 2], [2, 3], [1, 3], [1, 2], [0, 2],
                  [0, 1], [1, 1]],
        "comb": comb(3),
        "spiral": spiral(),
        "star of five": star(5, 0.4),
        "star of six": star(6, 0.5),
        "regular pentagon": ngon(5),
        "regular hexagon": ngon(6),
        "regular nonagon": ngon(9),
        "regular 24-gon": ngon(24),
        "notched": NOTCHED,
        "hour glass": HOUR_GLASS,
        "slot": [[0, 0], [5, 0], [5, 4], [3, 4], [3, 1.5], [2, 1.5], [2, 4], [0, 4]],
        "pocket": [[0, 0], [6, 0], [6, 5], [3.5, 5], [3.5, 4], [5, 4], [5, 1], [1, 1], [1, 4],
                   [2.5, 4], [2.5, 5], [0, 5]],
        "big concavity": [[0, 0], [4, 0], [4, 4], [3.6, 4], [3.2, 0.6], [0.6, 0.4], [0.5, 4],
                          [0, 4]],
        "sliver": [[0, 0], [10, 0], [10, 0.3], [5, 0.15], [0, 0.3]],
        "needle": NEEDLE,
        "nearly parallel edges": [[0, 0], [2, 0], [2.3, 1], [1.1, 1 + 1e-7], [0.2, 1 - 1e-7]],
        "repeated vertices": np.repeat(NOTCHED, 3, axis=0),
        "collinear vertices": middles_added(NOTCHED),
        "nearly collinear vertices": middles_added(NOTCHED) + 1e-11 * np.sin(np.arange(20.0)
                                     ).reshape(10, 2),
        "clockwise": T[::-1],
        "closed ring": np.vstack([T, T[:1]]),
        "turned": rotated(T, 1.0, (0.3, -0.2)),
        "far from the origin": HOUR_GLASS + [3e5, -4e5],
        "tiny unit": 1e-9 * HOUR_GLASS,
        "huge unit": 1e9 * HOUR_GLASS,
        "one short edge": [[0, 0], [3, 0], [3, 2], [1.5, 2.5], [1.5 - 1e-6, 2.5], [0, 2]],
    }.items()
)  # fmt: skip

WITHOUT_GRASP: tuple[Shape, ...] = (
    Shape("square", SQUARE),
    Shape("rectangle", np.array([[0, 0], [3, 0], [3, 1], [0, 1]], dtype=np.float64)),
)
"""Valid, and no three points hold them: opposing parallel edges let go along themselves."""

REFUSED: tuple[Shape, ...] = tuple(
    Shape(name, vertices, OutlineError)
    for name, vertices in {
        "nothing": [],
        "a point": [[1.0, 2.0]],
        "two points": [[0.0, 0.0], [1.0, 0.0]],
        "a line there and back": [[0.0, 0.0], [1.0, 0.0], [0.0, 0.0]],
        "zero area": [[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]],
        "a hair": [[0.0, 0.0], [1.0, 0.0], [0.5, 1e-13]],
        "bow tie": [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]],
        "spike": [[0.0, 0.0], [2.0, 0.0], [1.0, 0.0], [1.0, 1.0]],
        "touches itself": [[0.0, 0.0], [1.0, 0.0], [0.5, 0.5], [1.0, 1.0], [0.0, 1.0], [0.5, 0.5]],
        "hole on a bridge": [[0, 0], [4, 0], [4, 4], [0, 4], [0, 0], [1, 1], [1, 2], [2, 2], [2, 1],
                             [1, 1]],
        "slit of no width": [[0, 0], [3, 0], [3, 2], [1.5 + 1e-12, 2], [1.5, 0.5], [1.5 - 1e-12, 2],
                             [0, 2]],
        "neck of no width": [[2, 0], [2, 1], [1, 1], [0.88, 9e-16], [0, 2], [0, 0]],
        "slot closed by rounding": [[0, 0], [10, 0], [10, 3], [-1e-11, 0.08], [0, 0.3],
                                    [-1e-10, 0.005]],
        "run twice": [*SQUARE.tolist(), *SQUARE.tolist()],
        "not a number": [[0.0, 0.0], [1.0, 0.0], [math.nan, 1.0]],
        "infinite": [[0.0, 0.0], [1.0, 0.0], [0.0, math.inf]],
        "too far": [[0.0, 0.0], [1.0, 0.0], [0.0, 1e13]],
        "too many": ngon(MAX_VERTICES + 1).tolist(),
        "in space": [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        "a flat list": [0.0, 0.0, 1.0, 0.0, 0.0, 1.0],
        "words": [["a", "b"], ["c", "d"], ["e", "f"]],
        "None": None,
        "-1": -1,
    }.items()
)  # fmt: skip
