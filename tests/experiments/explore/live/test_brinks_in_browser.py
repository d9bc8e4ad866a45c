"""Where closing may stop at the end of an edge, the pages promise no more; in a real browser."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from icage.case import Case
from tests.experiments.explore.live.asking import served
from tests.experiments.explore.looked_at import until
from tests.icage.test_brink import caged
from tests.in_browser import Opened


def on_brink() -> Case:
    cage = caged(1, 1)
    return Case("lattice", "mm", cage.outline, cage.finger_radius, target=cage.contacts)


def test_the_heading_promises_no_more_than_the_brink_leaves(opened: Opened) -> None:
    lead = opened(on_brink()).locator("header .lead").inner_text()
    assert "below σbrink = " in lead.replace("\n", "")


def test_the_live_page_names_the_brink(visited: Callable[..., Any]) -> None:
    with served(on_brink(), seconds=2.0) as server:
        page = visited(server)
        until(page, "icage.state().standing && icage.state().levels && icage.state().fresh")
        card = page.locator(".levellist").inner_text()
    assert "σbrink" in card.replace("\n", "")
    assert "it may stop at the end of an edge" in card
    assert "parallel edges" not in card
