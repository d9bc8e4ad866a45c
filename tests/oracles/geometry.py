"""Plain polygon geometry for the oracles: no triangulation, no convex pieces, nothing of icage.

A polygon is an (n, 2) array, counterclockwise, open ring. Edge q runs from vertex q to q + 1.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from models import CASES

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Ring:
    """A polygon with everything the oracles ask about its edges.

    ``normals`` point into the free plane; ``concave[q]`` says that the object has an interior
    angle above pi at vertex q, so that a point finger there touches two edges at once.
    """

    vertices: Floats
    starts: Floats
    ends: Floats
    tangents: Floats
    normals: Floats
    lengths: Floats
    concave: NDArray[np.bool_]
    diameter: float
    polygon: shapely.Polygon

    @classmethod
    def of(cls, vertices: Any) -> Ring:
        """Ring of an (n, 2) polygon in either orientation; collinear vertices are dropped."""
        points = np.asarray(vertices, dtype=np.float64)
        polygon = shapely.Polygon(points)
        if not polygon.exterior.is_ccw:
            points = points[::-1].copy()
        gaps = points[:, None] - points[None]
        diameter = float(np.sqrt((gaps**2).sum(-1).max()))
        points = _without_collinear(points, diameter)
        ends = np.roll(points, -1, axis=0)
        lengths = np.linalg.norm(ends - points, axis=1)
        tangents = (ends - points) / lengths[:, None]
        normals = np.column_stack([tangents[:, 1], -tangents[:, 0]])
        before = np.roll(tangents, 1, axis=0)
        turn = before[:, 0] * tangents[:, 1] - before[:, 1] * tangents[:, 0]
        return cls(
            points, points, ends, tangents, normals, lengths, turn < 0.0, diameter,
            shapely.Polygon(points),
        )  # fmt: skip

    def __len__(self) -> int:
        return len(self.vertices)

    def nearest_on_edges(self, point: Floats) -> tuple[Floats, Floats]:
        """Nearest point of every edge, (n, 2), and its distance, (n,)."""
        along = ((point - self.starts) * self.tangents).sum(1)
        foot = self.starts + np.clip(along, 0.0, self.lengths)[:, None] * self.tangents
        return foot, np.linalg.norm(point - foot, axis=1)

    def depth(self, point: Floats, radius: float = 0.0) -> float:
        """How deep a finger is inside the object, [unit]; negative: its clearance."""
        distance = float(self.nearest_on_edges(point)[1].min())
        inside = shapely.contains_xy(self.polygon, point[0], point[1])
        return radius + distance if inside else radius - distance


def _without_collinear(points: Floats, diameter: float) -> Floats:
    """Drop repeated vertices and vertices on the chord of their neighbours."""
    kept = list(range(len(points)))
    changed = True
    while changed and len(kept) > 3:
        changed = False
        for i in range(len(kept)):
            a, b, c = (points[kept[(i + s) % len(kept)]] for s in (-1, 0, 1))
            chord = c - a
            length = float(np.hypot(*chord))
            off = abs(chord[0] * (b - a)[1] - chord[1] * (b - a)[0])
            if float(np.hypot(*(b - a))) <= 1e-13 * diameter or (
                off <= 1e-13 * diameter * length and float((b - a) @ (c - b)) >= 0.0
            ):
                del kept[i]
                changed = True
                break
    return points[kept]


def unit_hand(contacts: Floats) -> NDArray[np.complex128]:
    """(0, 1, z_3): the fingers of the hand of size 1. [Bunis2018, Eq. (1)], in complex numbers."""
    f = contacts[:, 0] + 1j * contacts[:, 1]
    return (f - f[0]) / (f[1] - f[0])


def fingers_of(q: Floats, hand: NDArray[np.complex128]) -> Floats:
    """Fingers (k, 2) of a configuration q = (Re d, Im d, Re w, Im w): f = d + w z."""
    f = complex(q[0], q[1]) + complex(q[2], q[3]) * hand
    return np.column_stack([f.real, f.imag])


def configuration(contacts: Floats) -> Floats:
    """(4,): d and w of three fingers."""
    return np.concatenate([contacts[0], contacts[1] - contacts[0]])


def size_of(q: Floats) -> float:
    """sigma = |w|, [unit]."""
    return float(np.hypot(q[2], q[3]))


def row(normal: Floats, z: complex) -> Floats:
    """Gradient over (d, w) of ``normal . finger`` for the finger at z of the unit hand."""
    x, y = float(normal[0]), float(normal[1])
    return np.array([x, y, x * z.real + y * z.imag, -x * z.imag + y * z.real])


def load_case(name: str, folder: Path = CASES) -> dict[str, Any]:
    """A solved problem as plain JSON."""
    return json.loads((folder / f"{name}.json").read_text())
