"""The placement map: where each finger may start, and how often the closing then succeeds.

Three panels, one per finger, of the same closings. Where the starts are a small cloud beside the
object each finger gets a close-up, and a panel before them shows where on the object these lie.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
import shapely

from experiments.figures.drawing.shapes import tidied
from experiments.figures.drawing.sheet import Bounds
from experiments.figures.drawing.written import check_suffix, settings, write
from experiments.io.arrow_table import Table
from experiments.io.outcome_words import NOT_CLOSED
from experiments.study.report.hexagons import Hexagons, bin_hexagons
from experiments.study.report.map_layout import SCALE, Place, placed
from experiments.study.report.map_panel import Cells, Panel, draw_panel, draw_scale_bar
from experiments.study.report.map_strip import draw_strip, strip_height, strip_keys, strip_words
from experiments.study.report.pictures import WIDE, Page
from experiments.study.run.rows import target_trials
from icage.arrays import BoolArray, FloatArray
from icage.cage import Cage
from icage.cells.regions import FingerRegion

FEWEST: Final = 3
"""[closings] A hexagon with fewer is drawn pale."""

CROSSES: Final = 60
"""Failed closings are marked one by one if there are no more."""

_WIDTHS: Final = (4.5, 6.0, 8.0, 10.0, 12.0)
"""[pt] Hexagons are as wide as the first of these at which half the closings ..."""

_FULL: Final = 25
"""[closings] ... lie in one with at least so many."""

_DETAIL: Final = 2.5
"""[1] Close-ups if they enlarge by more than this."""

_NARROW: Final = 0.4
"""[1] The shorter side of a close-up over the longer, at least."""

_ALIKE: Final = 2.0
"""[1] Sides of close-ups that differ by no more than this factor are made the same."""


@dataclass(frozen=True, slots=True, eq=False)
class Closings:
    """Closings (n): finger centres at the start (n, 3, 2) and whether they reached the target."""

    fingers: FloatArray
    reached: BoolArray

    @classmethod
    def of(cls, table: Table, cage: Cage) -> Closings:
        """Those of a study's table; starts are those of the planned hand."""
        closed = ~np.isin(np.array(table["outcome"].to_pylist()), list(NOT_CLOSED))
        names = ("start_x", "start_y", "start_theta", "start_sigma")
        rows = np.column_stack([table[name].to_numpy() for name in names])
        return cls(cage.hand.fingers(rows[closed]), target_trials(table)[closed])


def draw_map(
    document: Mapping[str, Any],
    table: Table,
    cage: Cage,
    regions: Sequence[FingerRegion],
    path: Path,
) -> None:
    """Draw where the fingers start and the rate of the target there into an SVG or PNG file.

    Trials without a closing (a finger would start inside the object, skipped, no such shape) are
    left out and counted in the caption.

    Raises
    ------
    InputError:
        The suffix is neither .svg nor .png.
    """
    check_suffix(path)
    with settings():
        write(map_page(document, table, cage, regions).figure, path)


def map_page(
    document: Mapping[str, Any], table: Table, cage: Cage, regions: Sequence[FingerRegion]
) -> Page:
    """The figure itself, before it is written."""
    closings = Closings.of(table, cage)
    inner = [region for region in regions if region.bound == "inner"]
    whole, close_ups = _windows(closings, cage, inner)
    places = placed(whole, close_ups)
    bins, width = _hexagons(closings, places[-1].zoom)
    cells = [_cells(closings, k, bins[k], cage, regions) for k in range(3)]
    failed = closings.fingers[~closings.reached]
    crosses = failed if len(failed) <= CROSSES else failed[:0]
    seen = _seen(inner, places)
    words = strip_words(document, width, FEWEST)
    keys = strip_keys(cage, seen, document, crosses=bool(len(crosses)))
    strip = strip_height(words, keys)
    page = Page(WIDE, strip + max(place.below for place in places))
    meant = _meant(document, cage)
    for k, place in enumerate(places):
        finger = k + 3 - len(places)
        panel = Panel(finger, place.window, place.zoom)
        y = page.height - place.below + SCALE
        axes = page.axes(place.x, y, place.width, place.height)
        if finger < 0:
            draw_panel(axes, panel, cage, seen, None, crosses[:0, 0], meant[:0])
            panel.frames(axes, [other.window for other in places[1:]])
        else:
            mine = [region for region in seen if region.finger == finger + 1]
            near = meant[finger : finger + 1]
            draw_panel(axes, panel, cage, mine, cells[finger], crosses[:, finger], near)
        top = y + place.height + 4.5
        page.text(place.x, top, panel.title, 9.0, color=panel.ink, fontweight="bold")
        if finger <= 0:
            draw_scale_bar(page, place.x, y - 9.0, panel.zoom, document["unit"])
    bar = bool(len(closings.reached))
    draw_strip(page, strip, str(document["name"]), words, keys, bar=bar)
    return page


def _windows(
    closings: Closings, cage: Cage, regions: Sequence[FingerRegion]
) -> tuple[Bounds, list[Bounds]]:
    """What there is to see, and a window round each finger's starts if that is much smaller."""
    size = cage.outline.diameter
    clouds = [_cloud(closings.fingers[:, k]) for k in range(3) if len(closings.fingers)]
    target = shapely.MultiPoint(cage.contacts).buffer(cage.finger_radius)
    seen = shapely.union_all([cage.outline.polygon, target, *clouds])
    extent = shapely.box(*seen.bounds).buffer(0.5 * size, join_style="mitre")
    shadows = [region.geometry.envelope.intersection(extent) for region in regions]
    seen = shapely.union_all([seen, *shadows])
    sides = _sides(clouds, size)
    wide, tall = seen.bounds[2] - seen.bounds[0], seen.bounds[3] - seen.bounds[1]
    close = bool(clouds) and max(wide, tall) > _DETAIL * sides.max()
    close_ups = (
        [_around(cloud.centroid, side) for cloud, side in zip(clouds, sides, strict=True)]
        if close
        else []
    )
    seen = shapely.union_all([seen, *(shapely.box(*window) for window in close_ups)])
    return seen.buffer(0.02 * size, join_style="mitre").bounds, close_ups


def _sides(clouds: Sequence[shapely.Polygon], size: float) -> FloatArray:
    """Sides (k, 2) of windows round the clouds: all alike where that leaves none nearly empty."""
    if not clouds:
        return np.empty((0, 2))
    bounds = np.array([cloud.bounds for cloud in clouds])
    sides = 1.4 * (bounds[:, 2:] - bounds[:, :2])
    sides = np.maximum(sides, np.maximum(0.02 * size, _NARROW * sides.max(axis=1, keepdims=True)))
    for k in range(2):
        if sides[:, k].max() <= _ALIKE * sides[:, k].min():
            sides[:, k] = sides[:, k].max()
    return sides


def _seen(regions: Sequence[FingerRegion], places: Sequence[Place]) -> list[FingerRegion]:
    """The regions without those below sigma_max where their lines lie on those below sigma_first
    in every panel, to the width of a line.
    """
    first = {one.finger: one for one in regions if one.level_name == "sigma_first"}
    others = [one for one in regions if one.finger in first and one is not first[one.finger]]
    for place in places:
        if any(_apart(one, first[one.finger], place) for one in others):
            return list(regions)
    return [one for one in regions if one not in others]


def _apart(region: FingerRegion, other: FingerRegion, place: Place) -> bool:
    """Whether the line of one region is seen beside that of the other."""
    window = shapely.box(*place.window)
    one, two = (tidied(each.geometry, 0.4 / place.zoom).boundary for each in (region, other))
    beside = one.intersection(window).difference(two.buffer(1.5 / place.zoom))
    return bool(beside.length > 5.0 / place.zoom)


def _cells(
    closings: Closings, finger: int, bins: Hexagons, cage: Cage, regions: Sequence[FingerRegion]
) -> Cells:
    """Hexagons cut to the caging region of the finger, or at least to what is clear of the object;
    not where a start lies beyond, as with an object or a hand that is not the planned one.
    """
    points = closings.fingers[:, finger]
    reach = shapely.union_all([r.geometry for r in regions if r.finger == finger + 1])
    body = cage.outline.polygon.buffer(cage.finger_radius, quad_segs=32)
    out = bins.holding(~shapely.contains_xy(reach, *points.T))
    under = bins.holding(shapely.contains_xy(body, *points.T))
    whole = np.asarray(shapely.polygons(bins.corners), dtype=object)
    clear = np.asarray(shapely.difference(whole, body), dtype=object)
    within = np.asarray(shapely.intersection(whole, reach), dtype=object)
    shapes = np.where(out, np.where(under, whole, clear), within)
    return Cells(list(shapes), bins.hits / bins.trials, bins.trials < FEWEST)


def _cloud(points: FloatArray) -> shapely.Polygon:
    """The box of points (n, 2) but for the outermost in a hundred along each axis."""
    low, high = np.quantile(points, [0.005, 0.995], axis=0)
    pad = 1e-6 + 1e-6 * np.abs(high)
    return shapely.box(*(low - pad), *(high + pad))


def _around(centre: shapely.Point, side: FloatArray) -> Bounds:
    x, y = 0.5 * float(side[0]), 0.5 * float(side[1])
    return centre.x - x, centre.y - y, centre.x + x, centre.y + y


def _hexagons(closings: Closings, zoom: float) -> tuple[list[Hexagons], float]:
    """The bins of the three fingers, all of one width, and that width."""
    bins: list[Hexagons] = []
    width = _WIDTHS[0]
    for width in _WIDTHS:
        bins = [
            bin_hexagons(closings.fingers[:, k], closings.reached, width / zoom) for k in range(3)
        ]
        sizes = np.concatenate([one.trials for one in bins])
        if sizes[sizes >= _FULL].sum() >= 0.5 * sizes.sum():
            break
    return bins, width / zoom


def _meant(document: Mapping[str, Any], cage: Cage) -> FloatArray:
    """Finger centres (3, 2) of the one placement that is meant, (0, 2) if there are many."""
    one = document.get("nominal")
    if one is None:
        return np.empty((0, 2))
    return cage.hand.fingers(np.array([one[key] for key in ("x", "y", "theta", "sigma")]))
