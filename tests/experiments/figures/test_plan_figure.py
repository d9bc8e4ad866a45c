"""The figure of a plan: complete, legible, the same every time."""

from __future__ import annotations

from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
import shapely
from matplotlib.text import Text
from matplotlib.transforms import Affine2D
from PIL import Image

from experiments.figures.drawing.canvas import Canvas
from experiments.figures.drawing.caption import LIGHT, caption_lines
from experiments.figures.drawing.labels import Clutter, place_labels
from experiments.figures.drawing.numbers import significant
from experiments.figures.drawing.palette import FINGERS, OBJECT_FILL, tint
from experiments.figures.drawing.shapes import as_path, tidied
from experiments.figures.drawing.sheet import Sheet
from experiments.figures.plan import draw_plan, figure_regions, plan_sheet
from icage.errors import InputError
from models import CASES
from tests.experiments.small import cage_of

SHOWN = (
    "T", "hammer_best", "pliers_best", "disc_Y", "never_escapes_b", "rectangle_notcage",
    "cross_multi",
)  # fmt: skip
OTHERS = sorted({path.stem for path in CASES.glob("*.json")} - set(SHOWN))


def sheet_of(name: str) -> Sheet:
    cage = cage_of(name)
    return plan_sheet(cage, figure_regions(cage), name, "mm")


def text_boxes(sheet: Sheet) -> dict[str, shapely.Polygon]:
    texts = [t for t in sheet.axes.findobj(Text) if t.get_text() and t.get_visible()]
    boxes = {}
    for number, text in enumerate(texts):
        extent = text.get_window_extent()
        boxes[f"{number} {text.get_text()}"] = shapely.box(*extent.extents)
    return boxes


@pytest.mark.parametrize(
    "name", [*SHOWN, *(pytest.param(name, marks=pytest.mark.slow) for name in OTHERS)]
)
def test_no_text_overlaps_another_or_leaves_the_page(name: str):
    sheet = sheet_of(name)
    boxes = text_boxes(sheet)
    width, height = sheet.figure.canvas.get_width_height()
    page = shapely.box(0, 0, width, height)
    for text, box in boxes.items():
        assert page.contains(box), text
    for (one, a), (other, b) in combinations(boxes.items(), 2):
        assert a.intersection(b).area <= 0.1 * min(a.area, b.area), (one, other)


def test_a_long_name_is_cut_to_fit():
    cage = cage_of("disc_Y")
    sheet = plan_sheet(cage, (), "W" * 100, "mm")
    boxes = text_boxes(sheet)
    width, height = sheet.figure.canvas.get_width_height()
    assert all(shapely.box(0, 0, width, height).contains(box) for box in boxes.values())
    assert any("WWW…" in text for text in boxes)
    for (one, a), (other, b) in combinations(boxes.items(), 2):
        assert a.intersection(b).area <= 0.1 * min(a.area, b.area), (one, other)


def test_levels_that_differ_read_differently():
    lines = {line.key: line for line in caption_lines(cage_of("pliers_best"), "m")}
    assert lines["dark"].ratio != lines["light"].ratio
    assert lines["dark"].value != lines["light"].value


def test_zeros_at_the_end_of_a_level_are_written():
    values = [line.value for line in caption_lines(cage_of("ngon9_best"), "m")]
    assert values[:3] == ["1.628 m", "1.732 m", "1.940 m"]


@pytest.mark.parametrize("name", ["hammer_best", "cross_multi", "T"])
def test_every_finger_of_both_hands_is_numbered(name: str):
    numbers = [text.split(" ", 1)[1] for text in text_boxes(sheet_of(name))]
    assert sorted(n for n in numbers if n in "123") == ["1", "1", "2", "2", "3", "3"]


def test_the_caption_says_what_the_plan_says():
    cage = cage_of("hammer_best")
    lines = caption_lines(cage, "mm")
    text = " ".join(f"{line.symbol} {line.value} {line.ratio} {line.words}" for line in lines)
    for level in (cage.sigma_0, cage.sigma_first, cage.sigma_max):
        assert f"{significant(level)} mm" in text
    assert [line.key for line in lines] == ["target", "dark", "light", "escape", ""]
    assert lines[-1].words == "shaded: the regions from inside, the safe side"


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("rectangle_notcage", "not a cage:"),
        ("never_escapes_a", "never escapes"),
        ("T_best", "the same"),
    ],
)
def test_the_caption_says_what_is_special(name: str, words: str):
    lines = caption_lines(cage_of(name), "m")
    assert any(words in f"{line.value} {line.words}" for line in lines)


def page_pixel(sheet: Sheet, picture: np.ndarray, point: np.ndarray) -> np.ndarray:
    x, y = sheet.main.point(point) * 200.0 / 72.0
    return picture[round(picture.shape[0] - y), round(x), :3] / 255.0


def test_regions_and_object_are_where_the_planner_says(tmp_path: Path):
    cage = cage_of("T")
    regions = figure_regions(cage)
    draw_plan(cage, regions, "T", "mm", tmp_path / "t.png")
    picture = np.asarray(Image.open(tmp_path / "t.png").convert("RGB"))
    sheet = plan_sheet(cage, regions, "T", "mm")
    assert picture.shape[:2] == pytest.approx(
        [sheet.height * 200 / 72, sheet.width * 200 / 72], abs=1
    )
    for region in regions:
        if region.bound == "inner":
            away = region.geometry.buffer(-0.03 * cage.outline.diameter)
            assert not away.is_empty
            inside = np.array(away.representative_point().coords[0])
            colour = page_pixel(sheet, picture, inside)
            assert colour == pytest.approx(tint(FINGERS[region.finger - 1], LIGHT), abs=0.02)
    stem = np.array([0.0, cage.outline.vertices[:, 1].min() + 0.1])
    assert page_pixel(sheet, picture, stem) == pytest.approx(OBJECT_FILL, abs=0.02)
    for contact, colour in zip(cage.contacts, FINGERS, strict=True):
        rim = contact + [0.7 * cage.finger_radius, 0.0]  # the middle carries the number
        assert page_pixel(sheet, picture, rim) == pytest.approx(colour, abs=0.02)


def test_a_hand_that_is_small_on_the_object_gets_a_detail_and_an_overview():
    sheet = sheet_of("hammer_best")
    assert sheet.overview is not None
    assert sheet.main.zoom > 2.0 * sheet.overview.zoom
    cage = cage_of("hammer_best")
    window = shapely.box(*sheet.main.window)
    for region in figure_regions(cage):
        assert window.contains(sheet.main.shape(region.geometry))
    assert sheet_of("T").overview is None


@pytest.mark.parametrize("suffix", [".svg", ".png"])
def test_the_same_cage_gives_the_same_bytes(suffix: str, tmp_path: Path):
    cage = cage_of("L_best")
    for name in ("one", "two"):
        draw_plan(cage, figure_regions(cage), "L", "m", tmp_path / f"{name}{suffix}")
    one = (tmp_path / f"one{suffix}").read_bytes()
    assert one == (tmp_path / f"two{suffix}").read_bytes()
    assert len(one) > 5000


def test_a_figure_that_cannot_be_written_leaves_nothing(tmp_path: Path):
    with pytest.raises(InputError, match=r"\.svg or \.png"):
        draw_plan(cage_of("L_best"), (), "L", "m", tmp_path / "l.pdf")
    assert not list(tmp_path.iterdir())


def test_slits_close_and_holes_stay():
    area = shapely.box(0, 0, 4, 4) - shapely.box(1, 1, 2, 2) - shapely.box(3, 0.5, 3.001, 3.5)
    drawn = tidied(area, 0.01)
    assert drawn.area == pytest.approx(15.0, rel=1e-3)
    canvas = Canvas(40, 40)
    canvas.path(as_path(drawn), Affine2D().scale(10.0), fill=(0.0, 0.0, 0.0))
    assert canvas.pixels[20, 30, 0] == 0
    assert canvas.pixels[15, 15, 0] == 255
    assert canvas.pixels[5, 5, 0] == 0


def test_labels_keep_off_discs_and_each_other():
    anchors = np.array([[50.0, 50.0], [54.0, 50.0], [50.0, 54.0]])
    discs = np.column_stack([anchors, np.full(3, 3.0)])
    page = shapely.box(0, 0, 100, 100)
    clutter = Clutter(discs, shapely.MultiLineString([[[0, 47], [100, 47]]]), page)
    places = place_labels(anchors, [3.0] * 3, (7.0, 9.0), clutter)
    boxes = [shapely.box(x - 3.5, y - 4.5, x + 3.5, y + 4.5) for x, y in places]
    for box in boxes:
        assert page.contains(box)
        assert all(box.distance(shapely.Point(disc[:2])) >= disc[2] for disc in discs)
    assert not any(a.intersects(b) for a, b in combinations(boxes, 2))
