"""The pictures of a study: complete, legible, honest, the same every time. No physics here."""

from __future__ import annotations

import functools
import json
from collections import Counter
from dataclasses import replace
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
import shapely
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection
from matplotlib.text import Text

from experiments.figures.drawing.sheet import Bounds
from experiments.figures.drawing.written import settings
from experiments.figures.plan import figure_regions
from experiments.io.intervals import wilson
from experiments.study.inputs.config import StudyConfig
from experiments.study.inputs.design import Design
from experiments.study.inputs.distributions import Distribution
from experiments.study.inputs.variables import VARIABLES, label
from experiments.study.report import indices_figure
from experiments.study.report import map as study_map
from experiments.study.report import rate_figures as figures
from experiments.study.report.hexagons import bin_hexagons
from experiments.study.report.map import CROSSES, Closings, map_page
from experiments.study.report.map_layout import placed
from experiments.study.report.names import merged, percent
from experiments.study.report.pictures import WIDE, Page
from experiments.study.report.rate_figures import draw_indices, draw_map, draw_rates
from experiments.study.report.summary import summary
from icage.cells.regions import FingerRegion
from icage.errors import InputError
from icage.hand import Placement
from tests.experiments.small import cage_of, t_case

VARY = {
    "place_x": Distribution("normal", (0.0, 1.0)),
    "place_theta": Distribution("truncated", (0.0, 0.1, -0.3, 0.3)),
    "friction": Distribution("uniform", (0.0, 0.8)),
    "mass": Distribution("grid", (0.5, 1.0, 2.0)),
    "tilt": Distribution("uniform", (0.0, 0.2)),
}


def study(
    count: int = 900, spread: float = 0.3, failures: float = 0.2, collisions: int = 50,
    vary: dict[str, Distribution] = VARY, sampling: str = "random",
) -> tuple[dict[str, Any], pa.Table]:  # fmt: skip
    """A document and its table: starts about the target, invented outcomes."""
    rng = np.random.default_rng(5)
    case, cage = t_case(), cage_of("T")
    config = StudyConfig("T", trials=count, starts="nominal", sampling=sampling, vary=vary)
    design = Design.of(config)
    count = design.total
    target = Placement.from_contacts(cage.contacts).as_array()
    size = cage.outline.diameter
    scale = spread * np.array([size, size, 1.0, 0.2 * size])
    starts = target + [0.0, 0.0, 0.0, 0.1 * size] + scale * rng.uniform(-0.5, 0.5, (count, 4))
    values = design.values(np.arange(count))
    outcome = np.where(rng.random(count) < failures * 2.0 * values["friction"], "jammed", "target")
    outcome = outcome.astype("<U9")
    outcome[count - collisions :] = "collision"
    reached = outcome == "target"
    table = pa.table(
        {
            "trial": np.arange(count),
            **{f"start_{n}": starts[:, k] for k, n in enumerate(("x", "y", "theta", "sigma"))},
            **{name: values[name] for name in design.names},
            "verdict": pa.array(["target"] * count),
            "in_cage": np.ones(count, dtype=np.bool_),
            "outcome": pa.array(outcome.tolist()),
            "grasp_id": np.where(reached, 0, -1),
            **{
                name: rng.random(count)
                for name in (
                    "position_error", "angle_error", "peak_force", "penetration_max",
                    "penetration_rest", "steps",
                )
            },
        }
    )  # fmt: skip
    document = {
        "name": "T",
        "unit": "mm",
        "diameter": size,
        "case": {
            "outline": {"vertices": case.outline.vertices.tolist()},
            "finger_radius": case.finger_radius,
            "contacts": case.contacts.tolist(),
        },
        "config": config.document(),
        "nominal": dict(zip(("x", "y", "theta", "sigma"), target.tolist(), strict=True)),
        "versions": {"icage": "1"},
        "finished": True,
        "stopped": {"early": False, "at": count, "why": "all trials that were asked for"},
        "found": summary(config, design, table, 4.0),
    }
    return json.loads(json.dumps(document)), table


def rates_page(document: dict[str, Any]) -> Page:
    shown = {name: one["bins"] for name, one in document["found"]["variables"].items()}
    floor = figures._floor([one for bins in shown.values() for one in bins])
    with settings():
        return figures._rates_page(document, shown, floor)


@functools.cache
def regions() -> tuple[FingerRegion, ...]:
    return figure_regions(cage_of("T"))


def panels(page: Page) -> list[Axes]:
    return [axes for axes in page.figure.axes if axes.axison]


def the_map(document: dict[str, Any], table: pa.Table) -> Page:
    with settings():
        return map_page(document, table, cage_of("T"), regions())


def words(page: Page) -> list[str]:
    return [text.get_text() for text in drawn(page)]


def drawn(page: Page) -> list[Text]:
    """All text that can be seen; ticks beyond an axis' ends have labels, but show none."""
    hidden: set[Text] = set()
    for axes in page.figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            low, high = sorted(axis.get_view_interval())
            for tick in axis.get_major_ticks():
                if not low <= tick.get_loc() <= high or not axes.axison:
                    hidden |= {tick.label1, tick.label2}
    texts = page.figure.findobj(Text)
    return [t for t in texts if t.get_text() and t.get_visible() and t not in hidden]


def assert_legible(page: Page) -> None:
    """No text over another, none off the page."""
    page.figure.draw_without_rendering()
    frame = shapely.box(*page.figure.bbox.extents)
    boxes = [(t.get_text(), shapely.box(*t.get_window_extent().extents)) for t in drawn(page)]
    assert len(boxes) > 5
    for text, box in boxes:
        assert frame.contains(box), text
    for (one, a), (other, b) in combinations(boxes, 2):
        assert a.intersection(b).area <= 0.1 * min(a.area, b.area), (one, other)


def test_every_variable_has_words_of_its_own():
    words = [label(name) for name in (*VARIABLES, "placement")]
    assert all(words)
    assert len(set(words)) == len(words)


def test_rates_have_a_panel_per_varying_input_with_its_unit():
    document, _ = study()
    page = rates_page(document)
    assert len(panels(page)) == 5
    text = words(page)
    assert "hand turned [°]" in text
    assert "3 values, 300 trials each" in text
    assert text.count("10 bins, 90 trials each") == 4
    assert page.figure.axes[0].get_ylim()[0] == 0.0
    assert not any("not at 0" in line for line in text)
    assert_legible(page)


def with_closings(document: dict[str, Any], closed: list[int], target: list[int]) -> None:
    """Bins of friction, so many of 100 trials closed, so many of these in the target."""
    found = document["found"]
    found["variables"] = {
        "friction": {
            "bins": [
                {"low": k, "high": k, "mean": k, "trials": 100, "closed": shut, "target": hit,
                 "near_target": hit,
                 "rate_95": list(wilson(hit, shut)) if shut else None}
                for k, (shut, hit) in enumerate(zip(closed, target, strict=True))
            ]
        }
    }  # fmt: skip
    one = {"trials": 100 * len(closed), "closed": sum(closed), "target": sum(target)}
    found |= {"trials": one["trials"], "closed": one["closed"], "independent": one}
    found["outcomes"] |= {"target": one["target"], "collision": one["trials"] - one["closed"]}
    interval = wilson(one["target"], one["closed"]) if one["closed"] else None
    found["target_rate_of_closed_95"] = interval


def test_a_start_that_was_not_closed_is_no_failure_of_the_grasp():
    document, _ = study(100, vary={"friction": VARY["friction"]})
    with_closings(document, [100, 40, 0], [100, 40, 0])
    page = rates_page(document)
    (axes,) = panels(page)
    heights = sorted(patch.get_height() for patch in axes.patches)
    assert heights == [0.0, 0.4, 1.0]
    dots = [line.get_ydata()[0] for line in axes.lines if line.get_marker() == "o"]
    assert dots == [1.0, 1.0]
    text = " ".join(words(page))
    assert "140 of 140 closings ended in the target" in text
    assert "share of the trials that were closed" in text
    assert "160 of 300 trials were not closed (a finger would start inside the object)" in text
    assert_legible(page)


def test_a_study_without_closings_has_no_rate():
    document, _ = study(100, vary={"friction": VARY["friction"]})
    with_closings(document, [0, 0], [0, 0])
    page = rates_page(document)
    assert "None of 200 trials was closed: there is no rate to show." in words(page)
    assert not any(line.get_marker() == "o" for axes in page.figure.axes for line in axes.lines)


def test_one_input_uses_the_page():
    document, _ = study(100, vary={"tilt": VARY["tilt"]})
    (axes,) = panels(rates_page(document))
    assert axes.get_position().width > 0.85


def test_angles_are_drawn_in_degrees():
    document, _ = study(vary={"tilt": VARY["tilt"]})
    low, high = rates_page(document).figure.axes[0].get_xlim()
    assert low < 0.0 < 11.0 < high < 12.0


def test_an_axis_that_does_not_start_at_0_says_so():
    document, _ = study(failures=0.0, collisions=0)
    page = rates_page(document)
    floor = page.figure.axes[0].get_ylim()[0]
    assert 0.9 <= floor < 1.0
    assert f"The axes start at {floor:g}, not at 0." in words(page)
    assert f"{floor:g}" in [t.get_text() for t in page.figure.axes[0].get_yticklabels()]
    assert_legible(page)


def test_all_inputs_at_once_are_legible():
    vary = {n: Distribution("uniform", (max(v.low, 0.1), 0.2)) for n, v in VARIABLES.items()
            if v.low <= 0.1 and v.high >= 0.2}  # fmt: skip
    document, _ = study(100, vary=vary)
    page = rates_page(document)
    assert len(panels(page)) == len(vary) > 20
    assert_legible(page)


def test_the_map_shows_every_closing_and_says_what_it_leaves_out():
    document, table = study()
    page = the_map(document, table)
    text = words(page)
    assert {f"finger {k}" for k in (1, 2, 3)} <= set(text)
    assert "where the close-ups lie" not in text
    caption = " ".join(text)
    assert "850 closings" in caption
    assert "50 (a finger would start inside the object)" in caption
    panels = [axes for axes in page.figure.axes if _hexagons(axes)]
    assert len(panels) == 3
    assert_legible(page)


def _hexagons(axes: Axes) -> list[Any]:
    return [c for c in axes.collections if type(c) is PathCollection]


def test_a_small_cloud_gets_close_ups():
    document, table = study(spread=0.01, vary={"friction": VARY["friction"]})
    page = the_map(document, table)
    assert "where the close-ups lie" in words(page)
    assert_legible(page)


def test_few_failures_are_marked_one_by_one():
    document, table = study(failures=0.02, collisions=0)
    failed = document["found"]["failed"]
    assert 0 < failed <= CROSSES
    page = the_map(document, table)
    marks = [len(line.get_xdata()) for line in page.figure.findobj(match=_is_cross)]
    assert Counter(marks)[failed] == 3


def test_many_failures_are_told_by_colour_alone():
    document, table = study(failures=0.8)
    assert document["found"]["failed"] > CROSSES
    assert not the_map(document, table).figure.findobj(match=_is_cross)


def _is_cross(artist: Any) -> bool:
    return getattr(artist, "get_marker", lambda: None)() == "x"


def test_a_map_without_closings_or_regions_is_drawn():
    document, table = study()
    with settings():
        page = map_page(document, table.slice(0, 0), cage_of("T"), ())
    assert "no caging regions: not a cage" in words(page)


def test_a_map_without_closings_has_no_scale_of_colours():
    document, table = study()
    with_closings(document, [0, 0], [0, 0])
    page = the_map(document, table.slice(0, 0))
    text = words(page)
    why = "a finger would start inside the object"
    assert f"None of 200 trials was closed: 200 ({why})." in text
    assert "share of closings in the target" not in text
    assert not any("hexagon" in line for line in text)


def test_no_hexagon_reaches_into_the_clearance_unless_a_start_does():
    cage = cage_of("T")
    _, table = study(spread=0.1, collisions=0)
    closings = Closings.of(table, cage)
    body, core = (cage.outline.polygon.buffer(k * cage.finger_radius) for k in (1.0, 0.98))
    for finger in range(3):
        points = closings.fingers[:, finger]
        under = shapely.contains_xy(body, *points.T)
        for some in (closings, Closings(closings.fingers[~under], closings.reached[~under])):
            mine = some.fingers[:, finger]
            bins = bin_hexagons(mine, some.reached, 0.05)
            drawn = study_map._cells(some, finger, bins, cage, regions()).shapes
            inside = shapely.area(shapely.intersection(list(drawn), core)) > 1e-9
            may = bins.holding(shapely.contains_xy(body, *mine.T))
            assert not (inside & ~may).any()
            assert not shapely.is_empty(list(drawn)).any()


def test_lines_that_cannot_be_told_apart_are_one_entry():
    document, table = study()
    cage = replace(cage_of("T"), sigma_max=1.0001 * cage_of("T").sigma_first)
    first = [r for r in regions() if r.level_name == "sigma_first" or r.bound == "inner"][:3]
    first = [replace(r, level_name="sigma_first", level=cage.sigma_first) for r in first]
    near = [
        replace(r, level_name="sigma_max", level=cage.sigma_max, geometry=r.geometry.buffer(1e-4))
        for r in first
    ]
    with settings():
        text = words(map_page(document, table, cage, [*first, *near]))
    assert any("looks the same here" in line for line in text)
    far = [replace(r, geometry=r.geometry.buffer(0.1 * cage.outline.diameter)) for r in near]
    with settings():
        text = words(map_page(document, table, cage, [*first, *far]))
    assert not any("looks the same here" in line for line in text)


@pytest.mark.parametrize("whole", [(0.0, 0.0, 4.0, 1.0), (0.0, 0.0, 1.0, 1.2)])
@pytest.mark.parametrize("sides", [(0.1, 0.1), (0.1, 0.5), (0.5, 0.1), (0.02, 0.02)])
def test_frames_of_close_ups_are_never_cut_off(whole: Bounds, sides: tuple[float, float]):
    wide, tall = sides
    sizes = [(wide, tall), (tall, wide), (tall, 0.5 * wide)]
    at = [(0.0, 0.0), (whole[2], 0.5), (0.5, whole[3])]
    windows = [
        (x - 0.5 * w, y - 0.5 * h, x + 0.5 * w, y + 0.5 * h)
        for (w, h), (x, y) in zip(sizes, at, strict=True)
    ]
    first, *others = placed(whole, windows)
    frame = shapely.box(*first.window)
    assert len({round(place.zoom, 9) for place in others}) == 1
    page = [shapely.box(p.x, p.below - p.height, p.x + p.width, p.below) for p in (first, *others)]
    for place, window in zip(others, windows, strict=True):
        assert frame.buffer(1e-9).contains(shapely.box(*place.window))
        assert shapely.box(*place.window).buffer(1e-9).contains(shapely.box(*window))
        assert place.x + place.width <= WIDE - 13.9
    for one, other in combinations(page, 2):
        assert not one.intersects(other)


def test_the_same_study_gives_the_same_bytes(tmp_path: Path):
    document, table = study(100, vary={"friction": VARY["friction"]})
    for name in ("a", "b"):
        draw_rates(document, tmp_path / f"rates_{name}.png")
        draw_map(document, table, cage_of("T"), regions(), tmp_path / f"map_{name}.svg")
    for what in ("rates_{}.png", "map_{}.svg"):
        one, other = ((tmp_path / what.format(name)).read_bytes() for name in ("a", "b"))
        assert one == other
        assert len(one) > 1000


def test_other_formats_are_refused_before_anything_is_drawn(tmp_path: Path):
    document, table = study(100)
    for draw in (
        lambda path: draw_rates(document, path),
        lambda path: draw_indices(document, path),
        lambda path: draw_map(document, table, cage_of("T"), (), path),
    ):
        with pytest.raises(InputError, match=r"\.svg or \.png"):
            draw(tmp_path / "picture.pdf")


def test_indices_are_drawn_largest_total_on_top(tmp_path: Path):
    document, _ = study(1000, collisions=0, sampling="saltelli",
                        vary={n: VARY[n] for n in ("friction", "tilt", "place_x")})  # fmt: skip
    found = document["found"]["indices"]
    totals = {label(g["name"]): g["total"] for g in found["groups"]}
    with settings():
        page = indices_figure._indices_page(document, found)
    names = [t.get_text() for t in page.figure.axes[0].get_yticklabels()]
    assert names == sorted(totals, key=totals.__getitem__)
    assert len(page.figure.axes[0].patches) == 2 * len(totals)
    assert_legible(page)
    draw_indices(document, tmp_path / "indices.svg")
    document["found"]["indices"] = {"base": 4, "groups": None, "why": "4 base points"}
    with pytest.raises(InputError, match="4 base points"):
        draw_indices(document, tmp_path / "none.svg")


def test_a_point_is_in_the_hexagon_with_the_nearest_centre():
    rng = np.random.default_rng(0)
    points, hits = rng.normal(0.0, 3.0, (400, 2)), rng.random(400) < 0.5
    found = bin_hexagons(points, hits, 0.8)
    near = np.hypot(*(points[:, None] - found.centres).transpose(2, 0, 1)).argmin(axis=1)
    assert found.trials.tolist() == np.bincount(near).tolist()
    assert found.hits.tolist() == np.bincount(near, weights=hits).tolist()
    gaps = shapely.distance(*np.meshgrid(*[shapely.points(found.centres)] * 2))
    assert gaps[gaps > 0.0].min() == pytest.approx(0.8)


def test_merged_bins_lose_no_trial():
    document, _ = study()
    bins = document["found"]["variables"]["friction"]["bins"]
    few = merged(bins, 3)
    assert len(few) == 3
    for key in ("trials", "target"):
        assert sum(one[key] for one in few) == sum(one[key] for one in bins)
    assert (few[0]["low"], few[-1]["high"]) == (bins[0]["low"], bins[-1]["high"])


def test_a_rate_that_is_not_0_or_1_is_never_shown_as_such():
    for rate in (1e-7, 4e-5, 0.0049, 0.5, 0.99999, 1.0 - 3e-8):
        shown = float(percent(rate).removesuffix(" %"))
        assert 0.0 < shown < 100.0
        assert shown == pytest.approx(100.0 * rate, rel=0.06)
