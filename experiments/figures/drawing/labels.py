"""Where to put the small numbers beside the fingers, so that nothing lies over anything. Our own.

Every label tries places on rings around its point and takes the one with the least trouble:
other points, labels set before it, lines. All lengths are in points of the page (1/72 inch).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

_DIRECTIONS = 24
_RINGS = (1.0, 1.5, 2.1)
"""[1] Distances tried, as multiples of the nearest one."""

_ON_A_POINT, _ON_A_LABEL, _ON_A_LINE, _OUTSIDE, _FARTHER, _INWARD = 40.0, 60.0, 6.0, 60.0, 2.0, 0.8
"""[1] How bad each trouble is; only their order matters."""


@dataclass(frozen=True, slots=True)
class Clutter:
    """What labels keep away from: discs (k, 3) = x, y, radius, lines, and the page they stay on."""

    discs: NDArray[np.float64]
    lines: shapely.MultiLineString
    page: shapely.Polygon


def place_labels(
    anchors: NDArray[np.float64],
    radii: Sequence[float],
    size: tuple[float, float],
    clutter: Clutter,
    taken: Sequence[shapely.Polygon] = (),
) -> NDArray[np.float64]:
    """Centres (k, 2) of k labels of ``size`` = (width, height), one beside each anchor (k, 2).

    ``radii`` are those of the discs drawn at the anchors; ``taken`` are boxes already in use.
    """
    middle = anchors.mean(axis=0)
    boxes: list[shapely.Polygon] = list(taken)
    centres = np.empty_like(anchors)
    for k, (anchor, radius) in enumerate(zip(anchors, radii, strict=True)):
        outward = anchor - middle
        outward = outward / max(float(np.hypot(*outward)), 1e-9)
        costs: list[float] = []
        places = _candidates(anchor, radius, size)
        for place, ring in places:
            box = _box(place, size)
            cost = _FARTHER * ring - _INWARD * float(outward @ (place - anchor)) / (radius + 8.0)
            cost += _ON_A_LABEL * sum(box.intersects(other) for other in boxes)
            cost += _ON_A_POINT * sum(
                _hits_disc(box, disc) for disc in clutter.discs if not _is_own(disc, anchor, radius)
            )
            cost += _ON_A_LINE * float(clutter.lines.intersection(box).length) / size[1]
            cost += _OUTSIDE * (not clutter.page.contains(box))
            costs.append(cost)
        centres[k] = places[int(np.argmin(costs))][0]
        boxes.append(_box(centres[k], size))
    return centres


def _candidates(
    anchor: NDArray[np.float64], radius: float, size: tuple[float, float]
) -> list[tuple[NDArray[np.float64], float]]:
    """Places around the anchor whose box just clears the disc of the anchor, ring by ring."""
    places: list[tuple[NDArray[np.float64], float]] = []
    for ring in _RINGS:
        for angle in 2.0 * np.pi * np.arange(_DIRECTIONS) / _DIRECTIONS:
            ray = np.array([np.cos(angle), np.sin(angle)])
            support = 0.5 * (abs(ray[0]) * size[0] + abs(ray[1]) * size[1])
            places.append((anchor + ray * (radius + 1.5 + support * ring), ring))
    return places


def _box(centre: NDArray[np.float64], size: tuple[float, float]) -> shapely.Polygon:
    half_x, half_y = 0.5 * size[0], 0.5 * size[1]
    return shapely.box(
        centre[0] - half_x, centre[1] - half_y, centre[0] + half_x, centre[1] + half_y
    )


def _hits_disc(box: shapely.Polygon, disc: NDArray[np.float64]) -> bool:
    return bool(box.distance(shapely.Point(disc[0], disc[1])) < disc[2])


def _is_own(disc: NDArray[np.float64], anchor: NDArray[np.float64], radius: float) -> bool:
    return bool(np.hypot(*(disc[:2] - anchor)) < 1e-6 and abs(disc[2] - radius) < 1e-6)
