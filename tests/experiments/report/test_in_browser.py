"""The report in a real browser: opened from the disk, sorted, filtered, by keys alone, on paper."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.experiments.report.conftest import KINDS, page_of
from tests.experiments.report.test_page import HOSTILE
from tests.in_browser import Opened, legible, reached_by_tab

COLUMN = """([table, column]) =>
  [...document.querySelectorAll('table')[table].tBodies[0].rows].filter(row => !row.hidden)
    .map(row => row.cells[column].textContent)"""

TABS = "button, input, [tabindex], a[href], video"


@pytest.mark.parametrize("wide", [1280, 390])
@pytest.mark.parametrize("kind", KINDS)
def test_it_fits_wide_and_narrow_screens(
    kind: str, wide: int, pages: dict[str, Path], opened: Opened
) -> None:
    page = opened(pages[kind], wide)
    assert page.evaluate("document.documentElement.scrollWidth") == wide
    sizes = page.evaluate(
        """() => [...document.querySelectorAll('p, td, th, dt, dd, figcaption, svg text, code')]
             .filter(one => one.getClientRects().length && one.textContent.trim())
             .map(one => parseFloat(getComputedStyle(one).fontSize))"""
    )
    assert min(sizes) >= 12.0
    targets = page.evaluate(
        """() => [...document.querySelectorAll('button, input')].map(one =>
             Math.min(one.offsetWidth, one.offsetHeight))"""
    )
    assert min(targets) >= 24


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("kind", ["failed", "study", "escape.json"])
def test_text_has_the_contrast_that_is_asked_for(
    kind: str, scheme: str, pages: dict[str, Path], opened: Opened
) -> None:
    legible(opened(pages[kind], color_scheme=scheme), "body", more_than=40)


def test_a_table_is_sorted_by_a_press(pages: dict[str, Path], opened: Opened) -> None:
    page = opened(pages["escape.json"])
    head = page.locator("table").first.locator("thead th").nth(2)
    assert head.get_attribute("aria-sort") == "none"
    given = page.evaluate(COLUMN, [0, 2])
    orders = [("ascending", sorted(given, key=float)),
              ("descending", sorted(given, key=float, reverse=True)), ("none", given)]  # fmt: skip
    assert orders[0][1] != given
    for order, wanted in orders:
        head.locator("button").click()
        assert head.get_attribute("aria-sort") == order
        assert page.evaluate(COLUMN, [0, 2]) == wanted
    page.locator("thead button").first.click()
    assert page.evaluate(COLUMN, [0, 0]) == sorted(page.evaluate(COLUMN, [0, 0]))
    assert page.locator("table").first.locator("th[aria-sort=ascending]").count() == 1


def test_what_has_no_number_stays_last(pages: dict[str, Path], opened: Opened) -> None:
    page = opened(pages["regress.json"])
    table = page.locator("table").first  # closings have no one-sided bound
    for _ in range(2):
        table.locator("thead button").nth(5).click()
        cells = page.evaluate(COLUMN, [0, 5])
        bounds = [cell for cell in cells if cell != "-"]
        assert bounds
        assert cells == [*bounds, *["-"] * (len(cells) - len(bounds))]


def test_rows_are_filtered_by_words(pages: dict[str, Path], opened: Opened) -> None:
    page = opened(pages["escape.json"])
    box = page.locator(".table").first
    assert box.locator("output").inner_text() == "6 rows"
    box.locator("input").fill("ABOVE guided")
    assert box.locator("output").inner_text() == "1 of 6 rows"
    assert page.evaluate(COLUMN, [0, 0]) == ["guided"]
    assert box.locator("[role=status]").inner_text() == "1 of 6 rows"
    box.locator("input").fill("<b>")
    assert page.evaluate(COLUMN, [0, 0]) == []
    box.locator("input").fill("")
    assert len(page.evaluate(COLUMN, [0, 0])) == 6


def test_all_of_it_by_keys(pages: dict[str, Path], opened: Opened) -> None:
    page = opened(pages["escape.json"])
    wanted = page.evaluate(f"document.querySelectorAll('{TABS}').length")
    reached_by_tab(page, wanted)
    head = page.locator("thead th").first
    head.locator("button").focus()
    page.keyboard.press("Enter")
    assert head.get_attribute("aria-sort") == "ascending"
    page.keyboard.press("Space")
    assert head.get_attribute("aria-sort") == "descending"


@pytest.mark.parametrize("kind", KINDS)
def test_on_paper_no_table_is_cut(kind: str, pages: dict[str, Path], opened: Opened) -> None:
    a4 = round((297 - 2 * 12) / 25.4 * 96)
    page = opened(pages[kind], a4)
    page.emulate_media(media="print", color_scheme="dark")
    over = page.evaluate(
        """() => [...document.querySelectorAll('table')].map(table =>
             table.getBoundingClientRect().right - document.body.getBoundingClientRect().right)"""
    )
    assert max(over) <= 0.5
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    legible(page, "body")
    assert page.pdf(prefer_css_page_size=True).startswith(b"%PDF")


def test_a_hostile_name_does_nothing(runs: Path, tmp_path: Path, opened: Opened) -> None:
    document = json.loads((runs / "escape.json").read_text())
    document["case"] = HOSTILE
    document["failures"] = [f"{HOSTILE}: escaped"]
    (tmp_path / "x.json").write_text(json.dumps(document))
    page_of(tmp_path / "x.json", tmp_path / "x.html")
    page = opened(tmp_path / "x.html")
    assert page.title() != "hit"
    assert page.locator("img").count() == 0
    assert page.locator("h1").inner_text().startswith("</title></style></script><script>")
    assert page.locator("h1 *").count() == 1  # the isolated name


def test_a_picture_is_shown_without_a_script(pages: dict[str, Path], opened: Opened) -> None:
    page = opened(pages["replay"], java_script_enabled=False)
    assert page.locator("figure img").count() == 1
    box = page.locator("figure img").bounding_box()
    assert box["width"] > 300
    assert box["height"] > 200
    assert page.locator("tbody tr").count() > 0
