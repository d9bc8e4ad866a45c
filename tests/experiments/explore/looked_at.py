"""What a page of the hand shows, read in a browser."""

from __future__ import annotations

from typing import Any

import numpy as np

from icage.cage import Cage


def verdict_shown(page: Any) -> str:
    """The word on the card, which its colour and the hand's follow."""
    word = page.locator(".verdict .word").inner_text()
    assert page.locator(".verdict").get_attribute("data-verdict") == word
    assert page.locator(".hand").get_attribute("data-verdict") == word
    return word


def stands(page: Any) -> list[float]:
    """The placement that the page shows."""
    at = page.evaluate("() => window.icage.placement()")
    return [at["x"], at["y"], at["theta"], at["sigma"]]


def expected(cage: Cage, at: list[float]) -> str:
    return str(cage.query(np.array(at)).verdict)


def put(page: Any, row: Any) -> None:
    x, y, theta, sigma = map(float, row)
    page.evaluate("at => window.icage.place(at)", {"x": x, "y": y, "theta": theta, "sigma": sigma})


def until(page: Any, expression: str) -> None:
    """Wait for something to be true; the page's policy forbids what Playwright's own wait does."""
    for _ in range(200):
        if page.evaluate(expression):
            return
        page.wait_for_timeout(50)
    raise AssertionError(f"never true: {expression}")
