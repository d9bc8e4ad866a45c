"""The page of a case as a file, opened in a real browser where there is one."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from experiments.explore.run import write_page
from icage.case import Case
from icage.formats.load import load
from tests.experiments.explore.placements import source_of
from tests.in_browser import Opened, browser, watched  # noqa: F401


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
def opened(browser: Any, page_file: Callable[..., Path]) -> Iterator[Opened]:  # noqa: F811
    """Opens the page of a case; fails if it complains or asks any host for anything."""
    with watched(browser) as open_page:

        def open_case(
            case: str | Case, *mus: float, wide: int = 1280, tall: int = 900, **more: Any
        ) -> Any:
            address = page_file(case, *mus).as_uri()
            page = open_page(address, address.__eq__, wide, tall, **more)
            page.wait_for_selector(".hand polygon[points]")
            return page

        yield open_case
