"""Disc fingers as point fingers: the object grown by the finger's radius. [Bunis2018, Sec. VII-A]

The grown object has straight edges and, round convex vertices, arcs. Only the arcs are split, the
straight edges stay exact. Chords lie inside the true curve: a smaller obstacle and a lower, safe
sigma_max. Tangents lie outside: an upper one. (The paper grows by "a disc whose diameter equals
the finger's radius", a slip: it is the finger's radius.)
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import shapely

from icage.arrays import FloatArray
from icage.discs.arc_stops import even_stops, resting_chords, unit_vectors
from icage.discs.curve import TrueCurve
from icage.errors import GeometryError, GraspError
from icage.geometry.exterior import without_straight_vertices
from icage.geometry.geos import union
from icage.geometry.near_frame import NearFrame
from icage.outline import Outline
from icage.tolerance import COLLISION, CONTACT_OFF

_APART = 1e-6
"""[rad] A contact nearer than this to the end of an arc counts as at the end."""

_GRID = 1e-15
"""[diameter] Noding grid of the union."""

_SLIVER = 1e-13
"""[diameter] A hole of the union this narrow on average is rounding and no pocket."""


class Offsets(NamedTuple):
    """The grown object between two polygons."""

    inner: Outline
    outer: Outline
    closed_pockets: int
    """Pockets that the growth has closed into holes; the outer ring alone is kept."""
    sagitta: float
    """Largest distance between the inner polygon and the true curve, [unit]."""


class Arc(NamedTuple):
    """The arc round one convex vertex: directions from ``start`` counterclockwise by ``turn``.

    ``ends`` (2, 2) are its end points, ``anchors`` (2, 2) points well inside the strips beside it.
    """

    vertex: FloatArray
    start: float
    turn: float
    ends: FloatArray
    anchors: FloatArray


class _Strips(NamedTuple):
    """The rectangles outside the edges: start and end of each edge, and the offset to its rim."""

    start: FloatArray
    end: FloatArray
    out: FloatArray


def _strips(outline: Outline, radius: float) -> _Strips:
    a = without_straight_vertices(outline.vertices, outline.diameter)
    b = np.roll(a, -1, axis=0)
    side = b - a
    length = np.hypot(side[:, 0], side[:, 1])
    return _Strips(a, b, radius * np.column_stack([side[:, 1], -side[:, 0]]) / length[:, None])


def arcs(outline: Outline, radius: float) -> list[Arc]:
    """Arcs of the grown object, one per convex vertex (also those that others cover)."""
    a, b, out = _strips(outline, radius)
    side = b - a
    heading = np.arctan2(side[:, 1], side[:, 0])
    turn = (heading - np.roll(heading, 1) + np.pi) % (2.0 * np.pi) - np.pi
    found: list[Arc] = []
    for k in np.flatnonzero(turn > 0.0).tolist():
        back = np.minimum(0.25, 0.5 * radius / np.hypot(*side[k - 1])) * side[k - 1]
        ahead = np.minimum(0.25, 0.5 * radius / np.hypot(*side[k])) * side[k]
        found.append(
            Arc(
                a[k], float(heading[k - 1]) - 0.5 * math.pi, float(turn[k]),
                np.array([b[k - 1] + out[k - 1], a[k] + out[k]]),
                np.array([a[k] + 0.5 * out[k - 1] - back, a[k] + 0.5 * out[k] + ahead]),
            )
        )  # fmt: skip
    return found


def offsets(
    outline: Outline,
    radius: float,
    segments: int,
    through: Mapping[int, tuple[float, ...]] | None = None,
) -> Offsets:
    """Inner (chords) and outer (tangents) polygon of the outline grown by ``radius``.

    Parameters
    ----------
    segments:
        Segments of an arc per quadrant.
    through:
        For arc number -> directions [rad] at which the outer polygon must touch the true curve
        and the inner one must have its normal, and lie within 1e-6 radii.

    Raises
    ------
    GeometryError:
        The union came out wrong: our fault, and never a polygon with a crack in it.
    """
    frame = NearFrame.of(outline)
    if frame.moved:
        near = offsets(frame.outline_into(outline), radius, segments, through)
        return near._replace(
            inner=Outline.computed(frame.back(near.inner.vertices)),
            outer=Outline.computed(frame.back(near.outer.vertices)),
        )
    wanted = through or {}
    strips = _strips(outline, radius)
    inner = [outline.polygon]
    inner += [shapely.Polygon([p, p + n, q + n, q]) for p, q, n in zip(*strips, strict=True)]
    outer = list(inner)
    widest = 0.0
    for number, arc in enumerate(arcs(outline, radius)):
        chords, tangents, step = _split(arc, radius, segments, wanted.get(number, ()))
        inner.append(chords)
        outer.append(tangents)
        widest = max(widest, step)
    sagitta = radius * (1.0 - math.cos(0.5 * widest))
    grown, holes = _exterior(inner, outline, radius, sagitta)
    grown_out, _ = _exterior(outer, outline, radius, sagitta)
    return Offsets(grown, grown_out, holes, sagitta)


def _split(
    arc: Arc, radius: float, segments: int, through: tuple[float, ...]
) -> tuple[shapely.Polygon, shapely.Polygon, float]:
    """The fan of chords and the fan of tangents of one arc, and its widest step [rad].

    A fan that only abutted on its strips, their common edge rounded differently on either side,
    would leave a crack of no width down to the object, and a finger would crawl into it. So the
    ends are the strips' own corners and the fan reaches into both strips.
    """
    wanted = [t for t in (_along(arc, x) for x in through) if t is not None]
    resting = [e for t, half in resting_chords(arc.turn, wanted) for e in (t - half, t + half)]
    chord_ends = arc.start + even_stops(arc.turn, segments, resting)
    on_arc = arc.vertex + radius * unit_vectors(chord_ends)
    at = arc.start + even_stops(arc.turn, segments, wanted)
    step = np.diff(at)
    reach = radius / np.cos(0.5 * step)
    corners = arc.vertex + reach[:, None] * unit_vectors(at[:-1] + 0.5 * step)
    first, last = arc.ends
    into, out_of = arc.anchors
    chords = shapely.Polygon([arc.vertex, into, first, *on_arc[1:-1], last, out_of])
    tangents = shapely.Polygon([arc.vertex, into, first, *corners, last, out_of])
    return chords, tangents, float(step.max())


def _along(arc: Arc, direction: float) -> float | None:
    """Angle of a direction from the start of the arc, or None if the arc does not contain it."""
    t = (direction - arc.start) % (2.0 * math.pi)
    return t if _APART < t < arc.turn - _APART else None


def _exterior(
    parts: list[shapely.Polygon], outline: Outline, radius: float, sagitta: float
) -> tuple[Outline, int]:
    """Outer ring of the union and the number of holes; no vertex nearer than the chords allow."""
    grid = _GRID * (outline.diameter + radius)
    grown = union(parts, grid, f"growing the outline by {radius}")
    if not isinstance(grown, shapely.Polygon):
        found = type(grown).__name__
        raise GeometryError(f"growing the outline by {radius} gives a {found}")
    ring = shapely.get_coordinates(grown.exterior)[:-1]
    gap = np.atleast_1d(shapely.distance(shapely.points(ring), outline.polygon))
    if float(gap.min()) < radius - sagitta - COLLISION * outline.diameter:
        raise GeometryError(
            f"growing the outline by {radius} left a crack: a vertex only {gap.min()} away"
        )
    thin = _SLIVER * (outline.diameter + radius)
    holes = [h for h in grown.interiors if shapely.Polygon(h).area > thin * h.length]
    return Outline.computed(ring), len(holes)


def directions_on_arcs(
    outline: Outline, radius: float, contacts: FloatArray
) -> dict[int, tuple[float, ...]]:
    """Arc number -> directions of the contacts (finger centres) that lie on it."""
    size = outline.diameter
    found: dict[int, tuple[float, ...]] = {}
    for number, arc in enumerate(arcs(outline, radius)):
        for point in contacts:
            x, y = point - arc.vertex
            if abs(math.hypot(x, y) - radius) <= CONTACT_OFF * size:
                direction = math.atan2(y, x)
                if _along(arc, direction) is not None:
                    found[number] = (*found.get(number, ()), direction)
    return found


def check_disc_contacts(
    outline: Outline, radius: float, contacts: FloatArray, curve: TrueCurve | None = None
) -> None:
    """Finger centres must lie at the radius from the outline, apart, and outside closed pockets.

    ``curve`` is the true curve, where it is known.

    Raises
    ------
    GraspError:
        Says which finger, what was found and what is allowed.
    """
    reach = CONTACT_OFF * outline.diameter
    points = shapely.points(contacts)
    gap = np.atleast_1d(shapely.distance(points, outline.polygon.exterior))
    inside = np.atleast_1d(shapely.contains_properly(outline.polygon, points))
    for k in range(3):
        found = -float(gap[k]) if inside[k] else float(gap[k])
        if abs(found - radius) > reach:
            raise GraspError(
                f"contact {k + 1} is {found:.6g} from the outline; the finger radius {radius:.6g} "
                f"within {reach:.3g} (1e-6 of the diameter) is needed"
            )
        other = (k + 1) % 3
        side = float(np.hypot(*(contacts[other] - contacts[k])))
        if side < 2.0 * radius * (1.0 - 1e-9):
            raise GraspError(
                f"fingers {k + 1} and {other + 1} overlap: their centres are {side:.6g} apart, "
                f"at least 2 x {radius:.6g} is needed"
            )
    if curve is not None:
        swallowed = curve.distance(contacts)
    else:
        grown = offsets(outline, radius, 16).inner
        swallowed = np.atleast_1d(shapely.distance(points, grown.polygon.exterior))
    for k in range(3):
        if swallowed[k] > 0.01 * radius + reach:
            raise GraspError(
                f"contact {k + 1} lies in a pocket that a finger of radius {radius:.6g} "
                "cannot leave or enter"
            )
