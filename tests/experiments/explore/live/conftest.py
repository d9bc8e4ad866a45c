"""One server for the tests of a module."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import pytest

from experiments.explore.live.server import LiveServer
from icage.formats.load import load
from tests.experiments.explore.live.asking import served
from tests.in_browser import watched


@pytest.fixture(scope="module")
def pliers() -> Iterator[LiveServer]:
    """The live page of the pliers."""
    with served(load("pliers"), friction=(0.0, 0.2)) as server:
        yield server


@pytest.fixture
def visited(browser: Any) -> Iterator[Callable[..., Any]]:
    """Opens the live page of a server; fails if it complains or asks any other host."""
    with watched(browser) as open_page:

        def visit(server: LiveServer, wide: int = 1280, tall: int = 900, **more: Any) -> Any:
            own = f"http://127.0.0.1:{server.server_port}/"
            page = open_page(
                server.address, lambda url: url.startswith((own, f"blob:{own}")), wide, tall, **more
            )
            page.wait_for_selector(".contacts .grip[points]")
            return page

        yield visit
