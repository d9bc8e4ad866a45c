"""The live page in a real browser: contacts are dragged, grasps proposed, the hand closed."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import icage
from experiments.explore.live.server import LiveServer
from icage.case import Case
from icage.formats.load import load
from icage.outline import Outline
from icage.sampling import draw_starts
from tests.experiments.explore.live.asking import served
from tests.experiments.explore.looked_at import until
from tests.experiments.explore.placements import cage_of
from tests.in_browser import legible

Visited = Callable[..., Any]

CASE = load("pliers")
SIZE = CASE.outline.diameter
HOSTILE = "</script><script>document.title = 'hit'</script><img src=x onerror=alert(1)>\u05d0\"'"
T = [[0, 0], [3, 0], [3, 1], [2, 1], [2, 3], [1, 3], [1, 1], [0, 1]]


@pytest.fixture(scope="module")
def hostile() -> Iterator[LiveServer]:
    """An object without a grasp and with a name that is none."""
    with served(Case(HOSTILE, "mm", Outline(T), 0.05), seconds=2.0) as server:
        yield server


def contacts_of(page: Any) -> np.ndarray:
    return np.array(page.evaluate("icage.state().contacts"))


def standing(page: Any) -> str:
    word = page.locator(".standing .word").inner_text()
    assert page.locator(".contacts.drawing").get_attribute("data-verdict") == page.locator(
        ".standing"
    ).get_attribute("data-verdict")
    return word


def settled(page: Any) -> None:
    """Wait until the contacts that are shown have been answered."""
    until(page, "icage.state().standing && icage.state().levels && icage.state().fresh")


def off_track(contacts: np.ndarray) -> float:
    import shapely

    far = shapely.distance(CASE.outline.polygon.exterior, shapely.points(contacts))
    return float(np.abs(far - CASE.finger_radius).max())


def test_the_contacts_of_the_case_hold(visited: Visited, pliers: LiveServer) -> None:
    page, cage = visited(pliers), cage_of("pliers")
    settled(page)
    assert standing(page) == "immobilizing"
    text = page.locator(".levellist").inner_text()
    for level in (cage.sigma_0, cage.sigma_first, cage.sigma_max):
        assert f"{level:.3f} mm" in text
    assert page.locator(".contacts .region").count() >= 3


def test_a_contact_is_dragged_along_the_outline(visited: Visited, pliers: LiveServer) -> None:
    page = visited(pliers)
    settled(page)
    before = contacts_of(page)
    box = page.locator("[data-contact='0'] .disc").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    words, moved = [], []
    for step in range(1, 31):
        page.mouse.move(x - 3.0 * step, y + 40.0)  # off the outline: it stays there all the same
        moved.append(contacts_of(page))
        assert off_track(moved[-1]) < 1e-3 * SIZE
        assert np.array_equal(moved[-1][1:], before[1:])
        page.wait_for_timeout(20)
        words.append(standing(page))
    page.mouse.up()
    assert len({tuple(one[0]) for one in moved}) > 20
    assert "not immobilizing" in words
    assert page.evaluate("icage.counts().standings") >= 10
    until(page, "icage.state().standing.contacts.join() === icage.state().contacts.join()")
    page.mouse.move(x, y)
    assert off_track(contacts_of(page)) < 1e-9 * SIZE
    if standing(page) == "not immobilizing":
        why = page.locator(".standing .meaning").inner_text()
        assert why.lower().startswith(page.evaluate("icage.state().standing.why").lower())


def test_the_nearest_grasp_can_be_taken(visited: Visited, pliers: LiveServer) -> None:
    page = visited(pliers)
    settled(page)
    contact = page.locator("[data-contact='1']")
    contact.focus()
    for key in ("ArrowRight", "ArrowRight", "ArrowUp", "Shift+ArrowRight"):
        page.keyboard.press(key)
    until(page, "icage.state().standing && !icage.state().standing.holds")
    settled(page)
    assert standing(page) == "not immobilizing"
    assert "nearest grasp" in page.locator(".standing .near").inner_text()
    assert page.locator(".contacts .ghost").count() == 4
    page.get_by_role("button", name="Move the contacts there").click()
    until(page, "icage.state().standing.holds && icage.state().levels")
    assert standing(page) == "immobilizing"
    cage = icage.plan(CASE, contacts_of(page))
    assert cage.status == "cage"
    assert page.evaluate("icage.state().levels.sigma_max") == pytest.approx(cage.sigma_max)


def test_keys_move_a_contact_there_and_back(visited: Visited, pliers: LiveServer) -> None:
    page = visited(pliers)
    settled(page)
    contact = page.locator("[data-contact='2']")
    contact.focus()
    length = float(contact.get_attribute("aria-valuemax"))

    def along(key: str) -> float:
        before = float(contact.get_attribute("aria-valuenow"))
        page.keyboard.press(key)
        step = float(contact.get_attribute("aria-valuenow")) - before
        return (step + length / 2) % length - length / 2

    for key, share in (
        ("ArrowRight", 2e-3), ("ArrowDown", -2e-3), ("Shift+ArrowUp", 2e-4), ("PageUp", 2e-2),
        ("PageDown", -2e-2), ("Shift+ArrowLeft", -2e-4),
    ):  # fmt: skip
        assert along(key) == pytest.approx(share * length, rel=0.05), key
    forwards = along("End")
    assert forwards > 0.0
    at_corner = float(contact.get_attribute("aria-valuenow"))
    assert along("End") > 0.0
    assert along("Home") < 0.0
    assert float(contact.get_attribute("aria-valuenow")) == pytest.approx(at_corner)
    assert page.evaluate("document.activeElement.dataset.contact") == "2"


def test_a_touch_drags_too(visited: Visited, pliers: LiveServer) -> None:
    page = visited(pliers, wide=390, tall=844, has_touch=True)
    settled(page)
    before = contacts_of(page)
    box = page.locator("[data-contact='0'] .disc").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    session = page.context.new_cdp_session(page)
    for kind, points in (
        ("touchStart", [(x + 12, y + 6)]), ("touchMove", [(x - 3, y + 10)]),
        ("touchMove", [(x - 18, y + 14)]), ("touchEnd", []),
    ):  # fmt: skip
        touches = [{"x": px, "y": py, "id": 0} for px, py in points]
        session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": touches})
    now = contacts_of(page)
    assert 0.05 * SIZE < np.hypot(*(now - before)[0]) < 0.3 * SIZE
    assert np.abs((now - before)[1:]).max() < 1e-6


def test_close_is_pressed_and_the_end_is_the_target(visited: Visited, pliers: LiveServer) -> None:
    cage = cage_of("pliers")
    starts = draw_starts(cage, "guaranteed", 8, np.random.default_rng(2)).placements
    start = dict(zip("xyts", starts[np.argmax(starts[:, 3])].tolist(), strict=True))
    for wide in (1280, 390):
        page = visited(pliers, wide=wide)
        settled(page)
        page.get_by_role("tab", name="2. Hand").click()
        page.wait_for_selector(".hand .grip[points]")
        page.evaluate("({x, y, t, s}) => icage.place({ x, y, theta: t, sigma: s })", start)
        assert page.locator(".handpanel .verdict .word").inner_text() == "target"
        page.get_by_role("button", name="Close the hand", exact=True).click()
        until(page, "document.querySelector('.closing').dataset.outcome === 'target'")
        seen = []
        for _ in range(200):
            seen.append(page.evaluate("icage.placement().sigma"))
            if page.get_by_label("Time of the closing").input_value() == "1000":
                break
            page.wait_for_timeout(50)
        assert len(set(seen)) > 5  # it was seen to close
        at = page.evaluate("icage.placement()")
        target = cage.target_placement
        assert (at["x"], at["y"]) == pytest.approx((target.x, target.y), abs=1e-3)
        assert at["theta"] == pytest.approx(target.theta, abs=1e-4)
        assert at["sigma"] == pytest.approx(target.sigma, abs=1e-3)
        # pressed on the object by a hair, which is no collision to who watches
        assert page.locator(".handpanel .verdict .word").inner_text() == "target"
        text = page.locator(".closing").inner_text()
        for words in ("into the target grasp", "off the target by", "deepest penetration", "MuJoCo",
                      "friction μ = 0", "time step 1 ms"):  # fmt: skip
            assert words in text
        page.get_by_label("Time of the closing").fill("0")
        assert page.evaluate("icage.placement().sigma") == pytest.approx(start["s"], rel=1e-6)
        assert page.evaluate("document.documentElement.scrollWidth") == wide


def test_with_less_motion_the_end_is_there_at_once(visited: Visited, pliers: LiveServer) -> None:
    page = visited(pliers, reduced_motion="reduce")
    settled(page)
    page.get_by_role("tab", name="2. Hand").click()
    page.wait_for_selector(".hand .grip[points]")
    page.evaluate("icage.place({ x: 500, y: 500, theta: 0, sigma: 60 })")
    page.get_by_role("button", name="Close the hand", exact=True).click()
    until(page, "document.querySelector('.closing').dataset.outcome === 'escaped'")
    assert page.evaluate("icage.placement().sigma") < 0.1
    assert "The object escaped" in page.locator(".closing").inner_text()


def test_what_cannot_be_closed_is_said_in_the_page(visited: Visited, pliers: LiveServer) -> None:
    page = visited(pliers)
    settled(page)
    page.get_by_role("tab", name="2. Hand").click()
    page.wait_for_selector(".hand .grip[points]")
    page.evaluate("icage.place({ x: 90, y: 60, theta: 0, sigma: 50 })")
    page.get_by_role("button", name="Close the hand", exact=True).click()
    page.get_by_text("a finger stands inside the object").wait_for()
    page.get_by_role("tab", name="1. Contacts").click()
    page.get_by_label("Radius [mm]").fill("1e9")
    page.get_by_label("Radius [mm]").press("Tab")
    page.get_by_text("is allowed").wait_for()
    assert page.get_by_label("Radius [mm]").input_value() == "6"


def test_grasps_are_proposed_for_an_object_without_one(
    visited: Visited, hostile: LiveServer
) -> None:
    page = visited(hostile)
    assert page.locator("h1").inner_text() == HOSTILE
    assert page.title().startswith("</script><script>")
    assert page.locator("img").count() == 0
    until(page, "document.querySelectorAll('.proposal').length > 1")
    pressed = page.locator(".proposal[aria-pressed='true']")
    until(page, "icage.state().standing?.holds && icage.state().levels")
    assert pressed.count() == 1  # the best came by itself
    first = contacts_of(page)
    second = page.locator(".proposal").nth(1)
    second.focus()
    page.keyboard.press("Enter")
    until(page, "document.querySelectorAll('.proposal')[1].getAttribute('aria-pressed') === 'true'")
    assert not np.allclose(contacts_of(page), first, atol=1e-6)
    until(page, "icage.state().standing.holds && icage.state().levels?.verdict === 'cage'")
    scores = [float(text) for text in page.locator(".proposal b").all_inner_texts()]
    assert scores == sorted(scores, reverse=True)
    page.get_by_label("Radius [mm]").fill("0")
    page.get_by_label("Radius [mm]").press("Tab")
    page.get_by_text("propose again").wait_for()  # those were grasps of other fingers
    assert page.locator(".proposal").count() == 0
    until(page, "icage.state().radius === 0 && icage.state().standing?.holds")
    until(page, "icage.state().levels?.verdict === 'cage'")


def test_the_case_is_downloaded(visited: Visited, pliers: LiveServer, tmp_path: Path) -> None:
    page = visited(pliers, accept_downloads=True)
    settled(page)
    with page.expect_download() as waiting:
        page.get_by_role("button", name="Save case").click()
    path = tmp_path / "kept.json"
    waiting.value.save_as(path)
    assert waiting.value.suggested_filename == "pliers-1_best.json"
    assert json.loads(path.read_text())["format"] == "icage-case/1"
    assert np.allclose(load(path).contacts, CASE.contacts, atol=1e-9 * SIZE)


@pytest.mark.parametrize(("wide", "scheme"), [(1280, "light"), (390, "dark")])
def test_it_is_legible_and_fits(
    wide: int, scheme: str, visited: Visited, pliers: LiveServer
) -> None:
    page = visited(pliers, wide=wide, tall=844, color_scheme=scheme)
    settled(page)
    page.locator("[data-contact='1']").focus()
    for word in ("immobilizing", "not immobilizing"):
        until(page, f"document.querySelector('.standing .word').textContent === '{word}'")
        legible(page, ".icage")
        page.keyboard.press("PageUp")
    assert page.evaluate("document.documentElement.scrollWidth") == wide
    card, drawing = (page.locator(one).bounding_box() for one in (".standing", ".contacts"))
    assert max(drawing["y"] + drawing["height"], card["y"] + 100) < 844
    sizes = page.evaluate(
        """() => [...document.querySelectorAll('.icage *')]
             .filter(one => one.getClientRects().length && [...one.childNodes]
               .some(node => node.nodeType === 3 && node.textContent.trim())
             && one.localName !== 'sub').map(one => parseFloat(getComputedStyle(one).fontSize))"""
    )
    assert min(sizes) >= 12.0
    targets = page.evaluate(
        """() => [...document.querySelectorAll('.icage button, .icage input')]
             .filter(one => one.offsetParent)
             .map(one => Math.min(one.offsetWidth, one.offsetHeight))"""
    )
    assert min(targets) >= 24


def test_everything_is_reached_by_keys_and_seen(visited: Visited, pliers: LiveServer) -> None:
    page = visited(pliers)
    settled(page)
    wanted = page.evaluate(
        """() => [...document.querySelectorAll('button, input, [tabindex="0"]')]
             .filter(one => one.getClientRects().length && one.tabIndex >= 0 && !one.disabled)
             .length"""
    )
    for _ in range(wanted):
        page.keyboard.press("Tab")
        seen = page.evaluate(
            """() => { const one = document.activeElement; one.dataset.reached = 1;
                 const style = getComputedStyle(one.querySelector('.disc') ?? one);
                 return [style.outlineStyle, parseFloat(style.outlineWidth),
                   parseFloat(style.strokeWidth)]; }"""
        )
        assert (seen[0] != "none" and seen[1] >= 2.0) or seen[2] >= 4.0, seen
    assert page.locator("[data-reached]").count() == wanted
    page.get_by_role("tab", name="1. Contacts").focus()
    page.keyboard.press("ArrowRight")
    page.wait_for_selector(".hand .grip[points]")
    assert page.get_by_role("tab", name="2. Hand").get_attribute("aria-selected") == "true"


def test_the_server_ends_when_the_page_says_so(visited: Visited) -> None:
    with served(load("pliers")) as server:
        page = visited(server)
        page.get_by_role("button", name="End the server").click()
        page.get_by_text("The server has ended").wait_for()


def test_a_server_that_is_gone_is_said(visited: Visited) -> None:
    with served(load("pliers")) as server:
        page = visited(server)
        settled(page)
        page.route("**/api/**", lambda route: route.fulfill(status=200, body="no JSON"))
        page.locator("[data-contact='0']").focus()
        page.keyboard.press("ArrowRight")
        page.get_by_text("does not answer any more").first.wait_for()
        assert standing(page) == "no answer"
        page.unroute("**/api/**")
        page.keyboard.press("ArrowLeft")
        until(page, "icage.state().standing?.holds")
