"""A real browser: the distribution's Chromium, driven by Playwright where both are there.

What is asked of every page of ours alike: no complaint, no request to anybody else, contrast, and
that keys reach everything and show it.
"""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import pytest

NAMES = ("chromium", "chromium-browser", "google-chrome", "chrome")

Opened = Callable[..., Any]


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    """A browser without a window."""
    api = pytest.importorskip(
        "playwright.sync_api", reason="the page is tested in a browser: pip install icage[browser]"
    )
    program = next(filter(None, map(shutil.which, NAMES)), None)
    if program is None:
        pytest.skip(f"no browser here: none of {', '.join(NAMES)} is on the path")
    with api.sync_playwright() as playwright:
        # the sandbox of a browser needs what containers have not
        chromium = playwright.chromium.launch(executable_path=program, args=["--no-sandbox"])
        yield chromium
        chromium.close()


@contextmanager
def watched(browser: Any) -> Iterator[Opened]:
    """Opens pages; in the end it fails if one has complained or asked anybody else for anything."""
    complaints: list[str] = []
    contexts: list[Any] = []

    def open_page(
        address: str, own: Callable[[str], bool], wide: int = 1280, tall: int = 900, **more: Any
    ) -> Any:
        context = browser.new_context(viewport={"width": wide, "height": tall}, **more)
        contexts.append(context)
        page = context.new_page()
        page.on("console", lambda message: complaints.append(f"{message.type}: {message.text}"))
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on(
            "request",
            lambda request: own(request.url) or complaints.append(f"asks {request.url}"),
        )
        page.goto(address)
        return page

    yield open_page
    for context in contexts:
        context.close()
    assert complaints == []


def reached_by_tab(page: Any, wanted: int) -> None:
    """So many presses of Tab reach so many elements, and each shows that it is reached."""
    reached: list[Any] = []
    for _ in range(wanted):
        page.keyboard.press("Tab")
        reached.append(
            page.evaluate(
                """() => { const one = document.activeElement; const style = getComputedStyle(one);
                     one.dataset.reached = 1;
                     return [one.tagName, style.outlineStyle, parseFloat(style.outlineWidth)]; }"""
            )
        )
    assert page.locator("[data-reached]").count() == wanted
    for tag, style, width in reached:
        assert style != "none", tag
        assert width >= 2.0, tag


_CONTRAST = """root => {
  const parse = color => color.match(/[\\d.]+/g).map(Number);
  const part = v => { v /= 255; return v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4; };
  const light = ([r, g, b]) => 0.2126 * part(r) + 0.7152 * part(g) + 0.0722 * part(b);
  const behind = element => {
    for (let at = element; at; at = at.parentElement) {
      const color = parse(getComputedStyle(at).backgroundColor);
      if (color.length === 3 || color[3] === 1) return color;
    }
    return [255, 255, 255];
  };
  const found = [];
  const walk = document.createTreeWalker(document.querySelector(root), NodeFilter.SHOW_TEXT);
  while (walk.nextNode()) {
    const element = walk.currentNode.parentElement;
    if (!walk.currentNode.textContent.trim() || !element.getClientRects().length) continue;
    if (element.closest('script, style')) continue;
    const style = getComputedStyle(element);
    const drawn = element instanceof SVGElement;
    if (drawn && element.closest('.finger')) continue;  // on its disc, looked at below
    const [a, b] = [light(parse(drawn ? style.fill : style.color)), light(behind(element))];
    found.push([(Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05), walk.currentNode.textContent]);
  }
  for (const finger of document.querySelectorAll('.finger')) {
    const [disc, number] = finger.children;
    const [a, b] = [disc, number].map(one => light(parse(getComputedStyle(one).fill)));
    if (number.classList.contains('in')) {
      found.push([(Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05), 'finger']);
    }
  }
  return found;
}"""


def legible(page: Any, root: str, more_than: int = 0) -> None:
    """All texts below ``root``, so many at least, have the contrast of small text (WCAG, AA)."""
    found = page.evaluate(_CONTRAST, root)
    assert len(found) > more_than
    for ratio, text in found:
        assert ratio >= 4.5, (ratio, text)
