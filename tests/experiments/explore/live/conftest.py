"""One server for the tests of a module."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import pytest

from experiments.explore.live.server import LiveServer
from icage.formats.load import load
from tests.experiments.explore.live.asking import served


@pytest.fixture(scope="module")
def pliers() -> Iterator[LiveServer]:
    """The live page of the pliers."""
    with served(load("pliers"), friction=(0.0, 0.2)) as server:
        yield server


@pytest.fixture
def visited(browser: Any) -> Iterator[Callable[..., Any]]:
    """Opens the live page of a server; fails if it complains or asks any other host."""
    complaints: list[str] = []
    contexts: list[Any] = []

    def visit(server: LiveServer, wide: int = 1280, tall: int = 900, **more: Any) -> Any:
        context = browser.new_context(viewport={"width": wide, "height": tall}, **more)
        contexts.append(context)
        page = context.new_page()
        page.on("console", lambda message: complaints.append(f"{message.type}: {message.text}"))
        page.on("pageerror", lambda error: complaints.append(str(error)))
        own = (
            f"http://127.0.0.1:{server.server_port}/",
            f"blob:http://127.0.0.1:{server.server_port}/",
        )
        page.on(
            "request",
            lambda request: request.url.startswith(own) or complaints.append(request.url),
        )
        page.goto(server.address)
        page.wait_for_selector(".contacts .grip[points]")
        return page

    yield visit
    for context in contexts:
        context.close()
    assert complaints == []
