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
import pyarrow as pa
import shapely

from experiments.drawing.sheet import Bounds
from experiments.study.hexagons import Hexagons, bin_hexagons
from experiments.study.map_layout import SCALE, placed
from experiments.study.map_panel import Panel, draw_panel, draw_scale_bar
from experiments.study.map_strip import draw_strip, strip_height, strip_keys, strip_words
from experiments.study.pictures import WIDE, Page, check_suffix, settings, write
from experiments.study.shard import STUDY_OUTCOMES, target_trials
from icage.arrays import BoolArray, FloatArray
from icage.cage import Cage
from icage.regions import FingerRegion

FEWEST: Final = 3
"""[closings] A hexagon with fewer is not drawn."""

CROSSES: Final = 60
"""Failed closings are marked one by one if there are no more."""

_WIDTHS: Final = (4.5, 6.0, 8.0, 10.0, 12.0)
"""[pt] Hexagons are as wide as the first of these at which half the closings ..."""

_FULL: Final = 25
"""[closings] ... lie in one with at least so many."""

_DETAIL: Final = 2.5
"""[1] Close-ups if they enlarge by more than this."""


@dataclass(frozen=True, slots=True, eq=False)
class Closings:
    """Closings (n): finger centres at the start (n, 3, 2) and whether they reached the target."""

    fingers: FloatArray
    reached: BoolArray

    @classmethod
    def of(cls, table: pa.Table, cage: Cage) -> Closings:
        """Those of a study's table; starts are those of the planned hand."""
        closed = ~np.isin(np.array(table["outcome"].to_pylist()), STUDY_OUTCOMES[-3:])
        names = ("start_x", "start_y", "start_theta", "start_sigma")
        rows = np.column_stack([table[name].to_numpy() for name in names])
        return cls(cage.hand.fingers(rows[closed]), target_trials(table)[closed])


def draw_map(
    document: Mapping[str, Any],
    table: pa.Table,
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
    document: Mapping[str, Any], table: pa.Table, cage: Cage, regions: Sequence[FingerRegion]
) -> Page:
    """The figure itself, before it is written."""
    closings = Closings.of(table, cage)
    inner = [region for region in regions if region.bound == "inner"]
    whole, close_ups = _windows(closings, cage, inner)
    places = placed(whole, close_ups)
    bins = _hexagons(closings, places[-1].zoom)
    failed = closings.fingers[~closings.reached]
    crosses = failed if len(failed) <= CROSSES else failed[:0]
    words = strip_words(document, bins[0].width, FEWEST)
    keys = strip_keys(cage, inner, document, crosses=bool(len(crosses)))
    strip = strip_height(words, keys)
    page = Page(WIDE, strip + places[-1].below)
    meant = _meant(document, cage)
    for k, place in enumerate(places):
        finger = k + 3 - len(places)
        panel = Panel(finger, place.window, place.zoom)
        y = page.height - place.below + SCALE
        axes = page.axes(place.x, y, place.width, place.height)
        if finger < 0:
            draw_panel(axes, panel, cage, inner, None, crosses[:0, 0], meant[:0])
            panel.frames(axes, [other.window for other in places[1:]])
        else:
            mine = [region for region in inner if region.finger == finger + 1]
            near = meant[finger : finger + 1]
            draw_panel(axes, panel, cage, mine, bins[finger], crosses[:, finger], near)
        top = y + place.height + 4.5
        page.text(place.x, top, panel.title, 9.0, color=panel.ink, fontweight="bold")
        if finger <= 0:
            draw_scale_bar(page, place.x, y - 9.0, panel.zoom, document["unit"])
    draw_strip(page, strip, str(document["name"]), words, keys)
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
    sides = np.array([[c.bounds[2] - c.bounds[0], c.bounds[3] - c.bounds[1]] for c in clouds])
    side = 1.4 * sides.max(axis=0, initial=0.0)
    side = np.maximum(side, [max(0.02 * size, 0.6 * side.max())] * 2)
    wide, tall = seen.bounds[2] - seen.bounds[0], seen.bounds[3] - seen.bounds[1]
    close = bool(clouds) and max(wide, tall) > _DETAIL * side.max()
    close_ups = [_around(cloud.centroid, side) for cloud in clouds] if close else []
    seen = shapely.union_all([seen, *(shapely.box(*window) for window in close_ups)])
    return seen.buffer(0.02 * size, join_style="mitre").bounds, close_ups


def _cloud(points: FloatArray) -> shapely.Polygon:
    """The box of points (n, 2) but for the outermost in a hundred along each axis."""
    low, high = np.quantile(points, [0.005, 0.995], axis=0)
    pad = 1e-6 + 1e-6 * np.abs(high)
    return shapely.box(*(low - pad), *(high + pad))


def _around(centre: shapely.Point, side: FloatArray) -> Bounds:
    x, y = 0.5 * float(side[0]), 0.5 * float(side[1])
    return centre.x - x, centre.y - y, centre.x + x, centre.y + y


def _hexagons(closings: Closings, zoom: float) -> list[Hexagons]:
    """The bins of the three fingers, all of one width."""
    bins: list[Hexagons] = []
    for width in _WIDTHS:
        bins = [
            bin_hexagons(closings.fingers[:, k], closings.reached, width / zoom) for k in range(3)
        ]
        sizes = np.concatenate([one.trials for one in bins])
        if sizes[sizes >= _FULL].sum() >= 0.5 * sizes.sum():
            break
    return [one.with_at_least(FEWEST) for one in bins]


def _meant(document: Mapping[str, Any], cage: Cage) -> FloatArray:
    """Finger centres (3, 2) of the one placement that is meant, (0, 2) if there are many."""
    one = document.get("nominal")
    if one is None:
        return np.empty((0, 2))
    return cage.hand.fingers(np.array([one[key] for key in ("x", "y", "theta", "sigma")]))
