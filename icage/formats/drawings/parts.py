"""Which area of a drawing is the object: background, parts that touch, the part that is picked."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import shapely

from icage.errors import FormatError
from icage.formats.drawings.area import area_of, check_points, drawn_area, enclosed
from icage.formats.drawings.crossings import MAX_OVERLAPS, check_crossings
from icage.formats.drawings.drawing import Drawing, Line, Shape
from icage.formats.drawings.ends import where_loose
from icage.formats.drawings.reading import BY_ID, LARGEST, Reading
from icage.near_touch import near_touch
from icage.outline import LARGEST_COORDINATE

FLATTEN: Final = 0.02
"""[tolerance] Share of flattening: small, since it also moves the crossings of shapes."""

_RECTANGLE: Final = 1.0 - 1e-9
"""Share of its bounding box that a rectangle covers."""

MAX_PARTS: Final = 3_000
"""Separate areas, before those that are near to each other are joined."""

_NECKS: Final = 100
"""Necks of a part that are widened at most; an outline with more is refused."""

_SHOWN: Final = 6
"""Names or areas told at most."""


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """The object's area in the file's lengths, and what is to be said about it."""

    area: shapely.Polygon
    notes: tuple[str, ...]


def shapes_meant(drawing: Drawing, reading: Reading) -> Drawing:
    """The drawing with only those shapes and lines whose name is picked.

    Raises
    ------
    FormatError:
        Nothing has the name.
    """
    if not isinstance(reading.pick, str) or not reading.pick.startswith(BY_ID):
        return drawing
    name = reading.pick[len(BY_ID) :]
    shapes = tuple(shape for shape in drawing.shapes if name in shape.names)
    lines = tuple(line for line in drawing.lines if name in line.names)
    if not shapes and not lines:
        names = dict.fromkeys(n for one in (*drawing.shapes, *drawing.lines) for n in one.names)
        has = ", ".join(repr(n) for n in list(names)[:_SHOWN])
        more = ", ..." if len(names) > _SHOWN else ""
        raise FormatError(
            f"nothing that is drawn has the id {name!r}; "
            + (f"the drawing has {has}{more}" if names else "the drawing has no ids")
        )
    return replace(drawing, shapes=shapes, lines=lines)


def object_part(drawing: Drawing, reading: Reading, tolerance: float, gap: float) -> Part:
    """The one area that is the object, without holes. ``tolerance`` and ``gap`` as in the file.

    Parts nearer to each other than the tolerance are one; parts smaller than it are dust.

    Raises
    ------
    FormatError:
        Nothing has an area, or there are several parts and none is picked.
    """
    if tolerance <= 0.0:
        raise FormatError("the drawing has no area")
    notes: list[str] = []
    within = FLATTEN * tolerance
    areas: list[shapely.Geometry] = []
    points = 0
    for shape in drawing.shapes:
        areas.append(area_of(shape, within))
        points += int(shapely.get_num_coordinates(areas[-1]))
        check_points(points)
    more, said = _of_lines(drawing, reading, within, gap)
    notes += said
    areas, said = _without_background(areas + more, drawing, reading)
    notes += said
    areas = list({shapely.to_wkb(area): area for area in areas}.values())  # drawn twice is once
    _check_work(areas)
    whole = _polygons(shapely.union_all(areas))
    parts = [part for part in _joined(whole, tolerance) if size(part) > tolerance]
    if not parts:
        raise FormatError("the filled shapes have no area")
    parts.sort(key=lambda part: (-part.area, part.bounds))
    picked, said = _picked(parts, reading)
    notes += said
    return Part(shapely.Polygon(picked.exterior), (*notes, *_holes(picked, tolerance)))


def _check_work(areas: list[shapely.Geometry]) -> None:
    """Refuse areas whose union would take too long."""
    parts = np.concatenate([np.asarray(shapely.get_parts(area)) for area in areas] or [[]])
    rings = np.asarray(shapely.get_rings(parts))
    check_crossings([shapely.get_coordinates(ring) for ring in rings], MAX_OVERLAPS)


def size(area: shapely.Geometry) -> float:
    """Longer side of the bounding box."""
    x_low, y_low, x_high, y_high = shapely.bounds(area)
    return float(max(x_high - x_low, y_high - y_low))


def lines_count(drawing: Drawing, reading: Reading) -> bool:
    """Whether lines are part of the object."""
    strokes = reading.strokes or ("outline" if drawing.edges else "ignore")
    return bool(drawing.lines) and strokes != "ignore"


def check_painted(drawing: Drawing, reading: Reading) -> None:
    """Refuse a drawing in which nothing is filled, with the option that helps.

    Raises
    ------
    FormatError:
        Nothing counts.
    """
    if drawing.shapes or lines_count(drawing, reading):
        return
    if drawing.lines:
        raise FormatError("the drawing has strokes only: try --strokes outline")
    raise FormatError("nothing in the drawing is filled; a filled shape is needed")


def _of_lines(
    drawing: Drawing, reading: Reading, within: float, gap: float
) -> tuple[list[shapely.Geometry], list[str]]:
    """The areas that lines enclose and, if asked for, that their drawn width covers."""
    if not lines_count(drawing, reading):
        return [], []
    inside = enclosed(drawing.lines, within, gap)
    if reading.strokes == "drawn":
        return [inside.area, *(drawn_area(line, within) for line in drawing.lines)], []
    helps = f"--gap G joins ends nearer than G (now {gap:.3g}, in units of the file)"
    if shapely.is_empty(inside.area) and not drawing.shapes:
        raise FormatError(
            f"the drawing's lines ({len(drawing.lines)}) enclose no area: they have "
            f"{where_loose(inside.loose)}; {helps}"
        )
    notes: list[str] = []
    if len(inside.loose) and drawing.edges:
        notes.append(f"lines with {where_loose(inside.loose)}, bound nothing; {helps}")
    area, nested, frames = inside.area, inside.nested(), 0
    while not shapely.is_empty(nested) and _fills_frame(area, drawing.frame):
        frames += 1
        if reading.background is not False:
            break
        area, nested = nested, inside.nested(nested)
    if frames and reading.background is False:
        notes.append("a frame around all other contours was left out")
    count = sum(size(one) > within / FLATTEN for one in _polygons(nested))
    if count:
        what = "a closed contour" if count == 1 else f"{count} closed contours"
        notes.append(f"{what} inside the outline left out: the outer ring counts")
    if frames and reading.background is not False:
        notes.append(
            "the outline is a rectangle around all other contours; if that is a frame, "
            "--no-background leaves it out"
        )
    return [area], notes


def _without_background(
    areas: list[shapely.Geometry], drawing: Drawing, reading: Reading
) -> tuple[list[shapely.Geometry], list[str]]:
    """Leave out or tell about a rectangle (or whatever fills the page) that covers all others."""
    kept = list(areas)
    notes: list[str] = []
    while len(kept) > 1:
        largest = max(range(len(kept)), key=lambda k: float(shapely.area(kept[k])))
        others = [
            area for k, area in enumerate(kept) if k != largest and not shapely.is_empty(area)
        ]
        back = kept[largest]
        if not others or not _fills_frame(back, drawing.frame):
            break
        if not shapely.covers(back, shapely.union_all(others)):
            break
        if all(shapely.equals(other, back) for other in others):
            break
        if reading.background is not False:
            notes.append(
                "one shape covers all others and is the outline; if it is the background, "
                "--no-background leaves it out"
            )
            break
        del kept[largest]
        notes.append("a background that covers all other shapes was left out")
    if len(kept) == 1 and drawing.lines and not lines_count(drawing, reading):
        lines = corners_of(drawing.lines)
        if _fills_frame(kept[0], drawing.frame) and shapely.covers(kept[0], lines):
            notes.append(
                "the shape around all lines is the outline, and the lines are left out; if it is "
                "the background: --strokes outline --no-background"
            )
    return kept, notes


def _fills_frame(area: shapely.Geometry, frame: tuple[float, float, float, float] | None) -> bool:
    """Whether an area is a rectangle, or its bounding box is that of the page (or holds it)."""
    if shapely.is_empty(area):
        return False
    x_low, y_low, x_high, y_high = shapely.bounds(area)
    if shapely.area(area) >= _RECTANGLE * (x_high - x_low) * (y_high - y_low):
        return True
    if frame is None:
        return False
    slack = 0.01 * max(frame[2] - frame[0], frame[3] - frame[1])
    return (
        x_low <= frame[0] + slack
        and y_low <= frame[1] + slack
        and x_high >= frame[2] - slack
        and y_high >= frame[3] - slack
    )


def _joined(parts: list[shapely.Polygon], tolerance: float) -> list[shapely.Polygon]:
    """Parts nearer to each other than the tolerance are one: closed by half of it, then opened."""
    if len(parts) < 2:
        return parts
    if len(parts) > MAX_PARTS:
        raise FormatError(f"the drawing has more than {MAX_PARTS} separate filled parts")
    half = tolerance / 2.0
    grown = _polygons(shapely.union_all(shapely.buffer(parts, half, join_style="mitre")))
    tree = shapely.STRtree(parts)
    joined: list[shapely.Polygon] = []
    for one in grown:
        members = [parts[k] for k in tree.query(one, predicate="intersects")]
        if len(members) > 1:
            # Mitres keep corners, and give slivers tips; rounds fill corners, and have no tips.
            rounds = shapely.union_all(shapely.buffer(members, half, quad_segs=4))
            closed = shapely.intersection(
                shapely.buffer(one, -half, join_style="mitre"),
                shapely.buffer(rounds, -half, quad_segs=4),
            )
            members = _linked(_of_members([closed, *members], members), tolerance)
            members = [_with_wide_necks(member, tolerance) for member in members]
        joined += members
    return joined


def _of_members(
    areas: Sequence[shapely.Geometry], members: Sequence[shapely.Polygon]
) -> list[shapely.Polygon]:
    """The parts of a union that hold a member: closing may leave crumbs that only touch one."""
    inside = [member.representative_point() for member in members]
    parts = _polygons(shapely.union_all(areas))
    holds = np.unique(shapely.STRtree(parts).query(inside, predicate="intersects")[1])
    return [parts[k] for k in holds.tolist()]


def _linked(parts: list[shapely.Polygon], tolerance: float) -> list[shapely.Polygon]:
    """Parts that still are several, since they are near at a corner alone, get a link there."""
    if len(parts) < 2:
        return parts
    first, second = shapely.STRtree(parts).query(parts, predicate="dwithin", distance=tolerance)
    links = [
        shapely.buffer(shapely.shortest_line(parts[i], parts[j]), tolerance / 4.0, quad_segs=2)
        for i, j in zip(first.tolist(), second.tolist(), strict=True)
        if i < j
    ]
    return _polygons(shapely.union_all([*parts, *links]))


def _with_wide_necks(part: shapely.Polygon, tolerance: float) -> shapely.Polygon:
    """Where parts are joined by a neck of rounding's width, a link makes it one that holds."""
    for _ in range(_NECKS):
        ring = shapely.get_coordinates(part.exterior)[:-1]
        found = near_touch(ring, size(part))
        if found is None:
            break
        link = shapely.buffer(shapely.Point(ring[found.vertex]), tolerance / 4.0, quad_segs=2)
        part = max(_polygons(shapely.union(part, link)), key=lambda one: one.area)
    return part


def _picked(
    parts: Sequence[shapely.Polygon], reading: Reading
) -> tuple[shapely.Polygon, list[str]]:
    if len(parts) == 1:
        if isinstance(reading.pick, int) and reading.pick > 1:
            raise FormatError(f"pick is {reading.pick}; the drawing has one part")
        return parts[0], []
    areas = [part.area for part in parts]
    shares = ", ".join(f"{100 * area / sum(areas):.3g} %" for area in areas[:_SHOWN])
    more = ", ..." if len(areas) > _SHOWN else ""
    told = f"{len(parts)} separate filled parts (areas {shares}{more})"
    if reading.pick == LARGEST:
        return parts[0], [f"of {told} the largest was taken"]
    if isinstance(reading.pick, int):
        if reading.pick > len(parts):
            raise FormatError(f"pick is {reading.pick}; the drawing has {told}")
        return parts[reading.pick - 1], [f"of {told} number {reading.pick} was taken"]
    if reading.pick is not None:
        raise FormatError(
            f"what --pick {reading.pick} names has {told}; one connected silhouette is needed: "
            "the name of one of them"
        )
    raise FormatError(
        f"the drawing has {told}; one connected silhouette is needed: "
        "--pick largest, --pick 1 to take them by area, or --pick id=NAME"
    )


def _holes(part: shapely.Polygon, tolerance: float) -> list[str]:
    """Contours inside the outline do not hold the object from outside."""
    holes = [hole for hole in part.interiors if size(hole) > tolerance]
    if not holes:
        return []
    count = "a hole" if len(holes) == 1 else f"{len(holes)} holes"
    return [f"{count} inside the outline left out: the fingers stay outside, the outer ring counts"]


def _polygons(region: shapely.Geometry) -> list[shapely.Polygon]:
    parts = shapely.get_parts(region)
    return [part for part in parts if isinstance(part, shapely.Polygon) and not part.is_empty]


def corners_of(pieces: Sequence[Shape | Line]) -> shapely.MultiPoint:
    """Ends and turning points of all curves: they have the bounding box of the drawing."""
    chains = [
        chain for one in pieces for chain in (one.rings if isinstance(one, Shape) else (one.chain,))
    ]
    points = [curve.at(np.array([0.0, *curve.turns(), 1.0])) for chain in chains for curve in chain]
    corners = np.vstack(points) if points else np.zeros((0, 2))
    if not np.isfinite(corners).all() or np.abs(corners).max(initial=0.0) > LARGEST_COORDINATE:
        raise FormatError(
            f"the drawing has coordinates that are not finite or beyond {LARGEST_COORDINATE:g}"
        )
    return shapely.MultiPoint(corners)
