"""A real browser: the distribution's Chromium, driven by Playwright where both are there."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from experiments.explore.run import write_page
from icage.case import Case
from icage.formats.load import load
from tests.experiments.explore.placements import source_of

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


@pytest.fixture(scope="module")
def page_file(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Path]:
    """The page of a case as a file, written once."""
    folder = tmp_path_factory.mktemp("pages")
    written: dict[object, Path] = {}

    def file_of(case: str | Case, *mus: float) -> Path:
        key = case if isinstance(case, str) else case.name, mus
        if key not in written:
            path = folder / f"{len(written)}.html"
            write_page(load(source_of(case)) if isinstance(case, str) else case, path, mus)
            written[key] = path
        return written[key]

    return file_of


@pytest.fixture
def opened(browser: Any, page_file: Callable[..., Path]) -> Iterator[Opened]:
    """Opens the page of a case; fails if it complains or asks any host for anything."""
    complaints: list[str] = []
    contexts: list[Any] = []

    def open_page(case: str | Case, *mus: float, wide: int = 1280, tall: int = 900, **more: Any):
        context = browser.new_context(viewport={"width": wide, "height": tall}, **more)
        contexts.append(context)
        page = context.new_page()
        page.on("console", lambda message: complaints.append(f"{message.type}: {message.text}"))
        page.on("pageerror", lambda error: complaints.append(str(error)))
        address = page_file(case, *mus).as_uri()
        page.on(
            "request",
            lambda request: request.url == address or complaints.append(f"asks {request.url}"),
        )
        page.goto(address)
        page.wait_for_selector(".hand polygon[points]")
        return page

    yield open_page
    for context in contexts:
        context.close()
    assert complaints == []
