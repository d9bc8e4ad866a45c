"""How the page looks in a real browser: on any screen, by keys, on paper, in a notebook."""

from __future__ import annotations

from typing import Any

import pytest

from experiments.explore.document import explore_document
from experiments.explore.page_html import module_text
from experiments.explore.widget import RENDER, themed_style
from icage.case import Case
from icage.cells.query_tables import query_tables
from icage.formats.json_out import json_text
from tests.experiments.explore.looked_at import put, stands
from tests.experiments.explore.placements import cage_of
from tests.in_browser import Opened, legible, reached_by_tab


@pytest.mark.parametrize("wide", [1280, 390])
@pytest.mark.parametrize("name", ["pliers", "never_escapes_b", "rectangle_notcage"])
def test_it_fits_wide_and_narrow_screens(name: str, wide: int, opened: Opened) -> None:
    page = opened(name, wide=wide, tall=844)
    assert page.evaluate("document.documentElement.scrollWidth") == wide
    card = page.locator(".verdict").bounding_box()
    drawing = page.locator(".drawing").bounding_box()
    assert drawing["y"] + drawing["height"] < 844
    assert card["y"] + 100 < 844  # the word and what it means, without scrolling
    sizes = page.evaluate(
        """() => [...document.querySelectorAll('.icage svg text')].map(text => {
             const scale = text.ownerSVGElement.getBoundingClientRect().width
               / text.ownerSVGElement.viewBox.baseVal.width;
             return scale * parseFloat(getComputedStyle(text).fontSize); })"""
    )
    assert min(sizes) >= 12.0
    targets = page.evaluate(
        """() => [...document.querySelectorAll('.icage button, .icage input')]
             .filter(one => one.offsetParent)
             .map(one => Math.min(one.offsetWidth, one.offsetHeight))"""
    )
    assert min(targets) >= 24


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_text_has_the_contrast_that_is_asked_for(scheme: str, opened: Opened) -> None:
    page = opened("pliers", color_scheme=scheme)
    outside = [5.0, 5.0, 0.0, 400.0]
    for row in (stands(page), outside, cage_of("pliers").grasps[1].placement.as_array()):
        put(page, row)
        legible(page, ".icage")


def test_everything_is_reached_by_tab_and_seen(opened: Opened) -> None:
    page = opened("pliers_best", 0.0, 0.1, 0.3)
    wanted = page.evaluate(
        """() => [...document.querySelectorAll('.icage button, .icage input, .icage [tabindex]')]
             .filter(one => one.getClientRects().length).length"""
    )
    reached_by_tab(page, wanted)


def test_a_hostile_name_is_shown_as_text(opened: Opened) -> None:
    name = "</script><script>document.title = 'hit'</script><img src=x onerror=alert(1)>\u05d0\"'"
    cage = cage_of("cross_multi")
    page = opened(Case(name, "mm", cage.outline, 0.0, cage.contacts))
    assert page.locator("h1").inner_text() == name
    assert page.title().startswith("</script><script>")
    assert page.locator("h1 *").count() == 1  # the isolated name
    assert page.locator("img").count() == 0


def test_it_prints(opened: Opened) -> None:
    page = opened("pliers", color_scheme="dark")
    page.emulate_media(media="print")
    assert page.locator(".verdict").is_visible()
    assert not page.locator(".hints").is_visible()
    pdf = page.pdf()
    assert pdf.startswith(b"%PDF")
    assert pdf.count(b"/Type /Page\n") <= 2


def test_without_scripts_the_answer_is_there(opened: Opened, browser: Any, page_file: Any) -> None:
    context = browser.new_context(java_script_enabled=False)
    page = context.new_page()
    page.goto(page_file("pliers").as_uri())
    assert "sigma_max 96.865" in page.locator("noscript").inner_text()
    context.close()


THEMES = """theme => { document.body.dataset.jpThemeLight = theme;
  const shown = () => getComputedStyle(document.querySelector('.icage')).backgroundColor;
  return new Promise(done => setTimeout(() => done(shown()), 50)); }"""


def test_the_widget_follows_the_theme_of_the_notebook(browser: Any) -> None:
    """As a notebook does it: its theme may be another than the system's, and may change."""
    cage = cage_of("cross_multi")
    document = explore_document(cage, query_tables(cage), "cross", "m")
    page = browser.new_page(color_scheme="dark")
    page.set_content(f"<style>{themed_style()}</style><body><div></div></body>")
    script = module_text() + RENDER.replace("export default", "window.widget =")
    page.add_script_tag(content=f"{script}\nwindow.given = {json_text(document)};", type="module")
    page.evaluate(
        """() => { const kept = { document: given }, heard = {};
             const model = { get: key => kept[key], set: (key, value) => { kept[key] = value; },
               save_changes() {}, on: (event, listener) => { heard[event] = listener; } };
             window.kept = kept;
             window.undo = widget.render({ model, el: document.querySelector('div') }); }"""
    )
    page.wait_for_selector(".hand .grip[points]")
    assert page.evaluate("kept.placement.length") == 4
    dark, light = "rgb(20, 24, 28)", "rgb(255, 255, 255)"
    assert (
        page.evaluate("getComputedStyle(document.querySelector('.icage')).backgroundColor") == dark
    )
    assert page.evaluate(THEMES, "true") == light
    assert page.evaluate(THEMES, "false") == dark
    page.emulate_media(color_scheme="light")
    assert page.evaluate(THEMES, "false") == dark
    page.evaluate("undo()")
    page.close()
