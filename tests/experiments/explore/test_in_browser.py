"""The page in a real browser: it answers as ``icage query``, and the hand can be taken."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import icage
from icage.case import Case
from icage.cells.membership import query
from icage.formats.query_json import query_document
from icage.hand import Placement
from icage.outline import Outline
from tests.experiments.explore.looked_at import expected, put, stands, until, verdict_shown
from tests.experiments.explore.placements import SIX, all_over, cage_of
from tests.in_browser import Opened

ASK = """rows => rows.map(([x, y, theta, sigma]) => window.icage.query({ x, y, theta, sigma }))"""


def middle_of_hand(page: Any) -> tuple[float, float]:
    box = page.locator(".hand .grip").bounding_box()
    corners = page.locator(".hand .grip").get_attribute("points").split()
    points = np.array([[float(v) for v in corner.split(",")] for corner in corners])
    x, y = points.mean(axis=0) - points.min(axis=0)
    edge = 1.1  # half the width of the line, which the box holds too
    return box["x"] + edge + x, box["y"] + edge + y


@pytest.mark.slow
@pytest.mark.parametrize("name", SIX)
def test_it_answers_as_the_query(name: str, opened: Opened) -> None:
    cage = cage_of(name)
    rows = all_over(cage, np.random.default_rng(7))
    assert len(rows) == 2000
    wanted = query_document(query(cage, rows))["results"]
    found = opened(name).evaluate(ASK, rows.tolist())
    close = {"abs": 1e-9 * cage.outline.diameter, "rel": 1e-9}
    counts: dict[str, int] = {}
    for row, here, there in zip(rows.tolist(), found, wanted, strict=True):
        counts[there["verdict"]] = counts.get(there["verdict"], 0) + 1
        for key in ("verdict", "sigma", "in_cage"):
            assert here[key] == there[key], (row, here, there)
        assert here["grasps"] == list(there["grasps"]), (row, here, there)
        for key in ("margin", "target_margin"):
            assert (here[key] is None) == (there[key] is None), (row, here, there)
            assert here[key] is None or here[key] == pytest.approx(there[key], **close)
        assert (here["inside"] != []) == (here["verdict"] == "collision")
    assert min(counts[word] for word in ("other", "escapes", "collision")) >= 200, counts
    assert counts["target"] >= 20, counts
    assert counts.get("caged", 0) >= 50 or cage.sigma_first == cage.sigma_max, counts


def test_a_far_object_is_answered_as_well(opened: Opened) -> None:
    near = cage_of("hook_deep_multi")
    shift = np.array([1e7, -3e7])
    case = Case("far", "mm", Outline(near.outline.vertices + shift), 0.0, near.contacts + shift)
    page = opened(case)
    rows = all_over(near, np.random.default_rng(9), 400) + np.append(shift, [0.0, 0.0])
    wanted = query_document(query(icage.plan(case), rows))["results"]
    found = page.evaluate(ASK, rows.tolist())
    assert [a["verdict"] for a in found] == [b["verdict"] for b in wanted]


def test_dragged_off_the_object_the_verdict_changes_where_it_should(opened: Opened) -> None:
    cage, page = cage_of("T_best"), opened("T_best")
    x, y = middle_of_hand(page)
    page.mouse.move(x, y)
    page.mouse.down()
    seen: list[str] = []
    before = stands(page)
    for step in range(1, 61):
        page.mouse.move(x + 5.0 * step, y - 2.0 * step)
        at = stands(page)
        assert verdict_shown(page) == expected(cage, at)
        seen.append(verdict_shown(page))
        assert at[2:] == before[2:]
    page.mouse.up()
    page.mouse.move(x, y)
    assert stands(page) == at
    assert "collision" in seen
    assert seen[-1] == "escapes"


@pytest.mark.parametrize("name", ["pliers", "cross_multi", "disc_Y"])
def test_opened_beyond_sigma_max_the_verdict_changes_there(name: str, opened: Opened) -> None:
    """Hands of the cage that stand clear, opened to just below and just above the level."""
    cage, page = cage_of(name), opened(name)
    assert cage.sigma_max is not None
    rows = all_over(cage, np.random.default_rng(4), 1000)
    rows = rows[query(cage, rows).in_cage]
    changed = 0
    for row in rows[np.argsort(-rows[:, 3])][:30]:
        shown = []
        for factor in (1.0 - 1e-7, 1.0 + 1e-7):
            at = [*row[:3].tolist(), factor * cage.sigma_max]
            put(page, at)
            shown.append(verdict_shown(page))
            assert shown[-1] == expected(cage, at)
        changed += shown[0] in ("target", "caged") and shown[1] == "escapes"
    assert changed > 0


def test_the_scale_opens_and_closes_the_hand(opened: Opened) -> None:
    cage, page = cage_of("T_best"), opened("T_best")
    levels = page.locator(".levels")
    box = levels.bounding_box()
    page.mouse.move(box["x"] + 34, box["y"] + 0.9 * box["height"])
    page.mouse.down()
    sizes, seen = [], []
    for share in np.linspace(0.95, 0.05, 25):
        page.mouse.move(box["x"] + 34, box["y"] + share * box["height"])
        at = stands(page)
        assert verdict_shown(page) == expected(cage, at)
        sizes.append(at[3])
        seen.append(verdict_shown(page))
    page.mouse.up()
    assert (np.diff(sizes) >= 0.0).all()
    assert sizes[0] < cage.sigma_0 < cage.sigma_max < sizes[-1]
    levels.focus()
    page.keyboard.press("Home")
    low = stands(page)[3]
    page.keyboard.press("ArrowUp")
    page.keyboard.press("PageUp")
    assert stands(page)[3] > low
    assert float(levels.get_attribute("aria-valuenow")) == stands(page)[3]


def test_keys_move_turn_and_open(opened: Opened) -> None:
    cage, page = cage_of("cross_multi"), opened("cross_multi")
    target = cage.target_placement.as_array()
    size = cage.outline.diameter
    page.locator(".drawing").focus()

    def change(key: str) -> np.ndarray:
        before = np.array(stands(page))
        page.keyboard.press(key)
        return np.array(stands(page)) - before

    assert change("ArrowRight") == pytest.approx([0.01 * size, 0, 0, 0], abs=1e-12)
    assert change("Shift+ArrowUp") == pytest.approx([0, 0.001 * size, 0, 0], abs=1e-12)
    assert change("[")[2] == pytest.approx(math.radians(2.0))
    assert change("]")[2] == pytest.approx(-math.radians(2.0))
    assert change("+")[3] == pytest.approx(0.005 * cage.sigma_0)
    assert change("-")[3] == pytest.approx(-0.005 * cage.sigma_0)
    assert verdict_shown(page) == expected(cage, stands(page))
    page.keyboard.press("Home")
    assert stands(page) == pytest.approx(target.tolist(), abs=1e-12)
    until(page, "document.querySelector('[role=status]').textContent.startsWith('target.')")


def test_turning_and_opening_keep_the_middle(opened: Opened) -> None:
    cage, page = cage_of("cross_multi"), opened("cross_multi")
    page.locator(".drawing").focus()
    middle = cage.hand.fingers(np.array(stands(page))).mean(axis=0)
    for key in ["[", "+", "[", "-", "{", "+"] * 5:
        page.keyboard.press(key)
    now = np.array(stands(page))
    assert cage.hand.fingers(now).mean(axis=0) == pytest.approx(middle, abs=1e-12)


def test_the_knob_and_the_wheel_turn_the_hand(opened: Opened) -> None:
    page = opened("cross_multi")
    x, y = middle_of_hand(page)
    box = page.locator(".knob circle").nth(1).bounding_box()
    kx, ky = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    before = stands(page)
    page.mouse.move(kx, ky)
    page.mouse.down()
    page.mouse.move(x - (ky - y), y + (kx - x), steps=8)  # a quarter turn clockwise as seen
    page.mouse.up()
    turned = (stands(page)[2] - before[2] + math.pi) % (2.0 * math.pi) - math.pi
    assert turned == pytest.approx(-math.pi / 2.0, abs=0.02)
    turned_to = stands(page)[2]
    page.mouse.move(x, y)
    page.mouse.wheel(0, 100)
    until(page, f"Math.abs(icage.placement().theta - ({turned_to!r})) > 0.1")
    assert stands(page)[3] == pytest.approx(before[3])


def test_two_fingers_turn_and_open(opened: Opened) -> None:
    page = opened("cross_multi", wide=390, tall=844, has_touch=True)
    x, y = middle_of_hand(page)
    before = stands(page)
    session = page.context.new_cdp_session(page)

    def touch(kind: str, *points: tuple[float, float]) -> None:
        session.send(
            "Input.dispatchTouchEvent",
            {
                "type": kind,
                "touchPoints": [{"x": px, "y": py, "id": k} for k, (px, py) in enumerate(points)],
            },
        )

    touch("touchStart", (x, y))
    touch("touchStart", (x, y), (x + 50, y))
    for part in np.linspace(0.0, 1.0, 6)[1:]:
        angle, far = 0.5 * part, 50.0 * (1.0 + 0.5 * part)
        touch("touchMove", (x, y), (x + far * math.cos(angle), y - far * math.sin(angle)))
    touch("touchEnd")
    now = stands(page)
    assert now[3] == pytest.approx(1.5 * before[3], rel=1e-3)
    turned = (now[2] - before[2] + math.pi) % (2.0 * math.pi) - math.pi
    assert turned == pytest.approx(0.5, abs=1e-3)


def test_numbers_typed_are_where_the_hand_stands(opened: Opened) -> None:
    cage, page = cage_of("cross_multi"), opened("cross_multi")
    for name, value in (("x [m]", "0.25"), ("y [m]", "-1.5"), ("θ [°]", "270"), ("σ [m]", "0.75")):
        field = page.get_by_label(name)
        field.fill(value)
        field.press("Tab")
    at = stands(page)
    assert at == pytest.approx([0.25, -1.5, -math.pi / 2.0, 0.75], abs=1e-12)
    assert verdict_shown(page) == expected(cage, at)
    row = page.locator(".numbers code").last.inner_text()
    assert [float(value) for value in row.split(",")] == at
    field = page.get_by_label("σ [m]")
    for wrong in ("-1", ""):
        field.fill(wrong)
        field.press("Tab")
        assert stands(page) == at
        assert float(field.input_value()) == 0.75


def test_every_grasp_and_puncture_can_be_gone_to(opened: Opened) -> None:
    cage, page = cage_of("hook_deep_multi"), opened("hook_deep_multi")
    places = [*cage.grasps, *cage.punctures]
    buttons = page.locator(".places button")
    assert buttons.count() == len(places)
    for k, place in enumerate(places):
        buttons.nth(k).click()
        wanted = Placement.from_contacts(place.contacts).as_array()
        assert stands(page) == pytest.approx(wanted.tolist(), abs=1e-12)
        assert buttons.nth(k).get_attribute("aria-pressed") == "true"


def test_the_way_out_ends_free_and_never_opens_above_sigma_max(opened: Opened) -> None:
    cage, page = cage_of("pliers"), opened("pliers")
    slider = page.get_by_label("Place on the escape path")
    seen, sizes = [], []
    for value in range(0, 1001, 20):
        slider.fill(str(value))
        at = stands(page)
        assert verdict_shown(page) == expected(cage, at)
        seen.append(verdict_shown(page))
        sizes.append(at[3])
    assert seen[0] == "target"
    assert seen[-1] == "escapes"
    assert "collision" not in seen
    assert max(sizes) <= cage.sigma_max_upper * (1.0 + 1e-12)
    assert page.locator(".way").count() == 3


def test_play_goes_on_by_itself_and_stops_when_the_hand_is_taken(opened: Opened) -> None:
    page = opened("cross_multi")
    before = stands(page)
    page.get_by_role("button", name="Play").click()
    until(page, f"icage.placement().sigma > {before[3]!r} * 1.01")
    page.get_by_role("button", name="Target grasp").click()
    page.get_by_role("button", name="Play").wait_for()
    assert stands(page) == pytest.approx(before, abs=1e-12)


def test_with_less_motion_nothing_moves_by_itself(opened: Opened) -> None:
    cage, page = cage_of("pliers"), opened("pliers", reduced_motion="reduce")
    button = page.get_by_role("button", name="Next corner")
    corners = cage.hand.fingers(cage.escape_path)
    before = 0
    for _ in range(4):
        button.click()
        at = stands(page)
        off = np.abs(corners - cage.hand.fingers(np.array(at))).max(axis=(1, 2))
        assert off.min() < 1e-6
        assert int(off.argmin()) > before
        before = int(off.argmin())
        page.wait_for_timeout(150)
        assert stands(page) == at


def test_the_slice_shows_what_the_query_says(opened: Opened) -> None:
    cage, page = cage_of("cross_multi"), opened("cross_multi")
    rows = all_over(cage, np.random.default_rng(3))
    rows = rows[query(cage, rows).verdict == 0]
    middling = 0.5 * (cage.sigma_0 + cage.sigma_first)
    put(page, rows[np.argmin(np.abs(rows[:, 3] - middling))])
    assert verdict_shown(page) == "target"
    page.get_by_role("button", name="Where else it may stand").click()
    # done when the finest grid is drawn, of squares 4 pixels high
    until(page, "/v4H/.test(document.querySelector('path.slice[data-verdict=target]').outerHTML)")
    inside = """() => {
      const [x, y] = document.querySelector('.cross').getAttribute('transform').match(/[\\d.]+/g);
      const near = [[0, 0], [4, 0], [-4, 0], [0, 4], [0, -4]];
      const target = document.querySelector('path.slice[data-verdict=target]');
      return near.some(([a, b]) => target.isPointInFill(new DOMPoint(+x + a, +y + b))); }"""
    assert page.evaluate(inside)
    page.get_by_role("button", name="Where else it may stand").click()
    assert page.locator("path.slice[d]").count() == 0


def test_friction_has_a_slider_where_it_was_computed(opened: Opened) -> None:
    page = opened("pliers_best", 0.0, 0.1, 0.3)
    slider = page.get_by_label("Coefficient μ")
    texts = []
    for value in ("0", "1", "2"):
        slider.fill(value)
        texts.append(page.locator(".friction .note").inner_text())
    assert len(set(texts)) > 1
    jam = page.get_by_role("button", name="Show the jam")
    assert jam.is_visible()
    jam.click()
    level = icage.friction_levels(cage_of("pliers_best"), [0.3])[0]
    assert level.jam is not None
    assert stands(page) == pytest.approx(level.jam.placement.as_array().tolist(), abs=1e-12)
    assert opened("pliers").locator(".friction").count() == 0


def test_friction_of_discs_says_where_closings_stop(opened: Opened) -> None:
    cage, page = cage_of("pliers"), opened("pliers", 0.0, 0.2)
    slider = page.get_by_label("Coefficient μ")
    slider.fill("1")
    level = icage.friction_levels(cage, [0.2])[0]
    assert level.sigma_first is not None
    text = page.locator(".friction .note").inner_text()
    assert f"Below σ = {level.sigma_first:.3f} mm" in text
    off = f"{level.ends.position_max * cage.outline.diameter:.3f}"
    assert f"It stops at most {off} mm and " in text
    assert float(text.split(" mm and ")[1].split("°")[0]) == pytest.approx(
        math.degrees(level.ends.angle_max), rel=1e-2
    )
    slider.fill("0")
    assert "stops at most" not in page.locator(".friction .note").inner_text()
