"""Where the guarantee hangs on an exact fit, the pages say so; in a real browser."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from icage.case import Case
from icage.outline import Outline
from tests.experiments.explore.live.asking import served
from tests.experiments.explore.looked_at import until
from tests.icage.test_wedge import SLANTED, THIN, Asked, planned
from tests.in_browser import Opened


def case_of(name: str, asked: Asked) -> Case:
    outline = Outline(np.array(asked.ring, dtype=np.float64))
    return Case(name, "mm", outline, asked.radius, target=np.array(asked.contacts))


CASES = {"nothing is left": SLANTED, "some is left": THIN}


@pytest.mark.parametrize("name", CASES)
def test_the_heading_promises_no_more_than_the_wedge_leaves(name: str, opened: Opened) -> None:
    cage = planned(CASES[name])
    assert cage.wedge is not None
    lead = opened(case_of(name, CASES[name])).locator("header .lead").inner_text()
    assert "the object cannot leave the hand" in lead
    if cage.wedge.sigma <= cage.sigma_0:
        assert "by an exact fit only (a wedge)" in lead
    else:
        assert "by an exact fit" not in lead
        assert "below σwedge = " in lead.replace("\n", "")


@pytest.mark.parametrize("name", CASES)
def test_the_live_page_names_the_wedge(name: str, visited: Callable[..., Any]) -> None:
    cage = planned(CASES[name])
    assert cage.wedge is not None
    with served(case_of(name, CASES[name]), seconds=2.0) as server:
        page = visited(server)
        until(page, "icage.state().standing && icage.state().levels && icage.state().fresh")
        card = page.locator(".levellist").inner_text()
    assert "σwedge" in card.replace("\n", "")
    left = cage.wedge.sigma > cage.sigma_0
    assert ("from it on only if all fits exactly" in card) == left
    assert ("by an exact fit only" in card) != left
