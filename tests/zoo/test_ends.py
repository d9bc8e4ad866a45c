"""Objects at the ends of what is allowed: both methods agree or refuse, and no library warns."""

from __future__ import annotations

import json

import numpy as np
import pytest

from icage.agreement import disagreements
from icage.case import Case
from icage.cells.regions import caging_regions
from icage.errors import InputError
from icage.formats.json_out import json_text
from icage.formats.plan_json import plan_document, plan_summary
from icage.near_touch import NEAREST
from icage.outline import LARGEST_COORDINATE, SMALLEST_DIAMETER, Outline
from icage.planner import plan
from tests.oracles.geometry import Floats, Ring
from tests.oracles.polygons import rotated
from tests.zoo.shapes import HOUR_GLASS, NOTCHED, TRIANGLE, L, T, middles_added, touched_by_incircle
from tests.zoo.specimens import held


def thin_triangle(width: float) -> Floats:
    """So wide, and 1 long; its corners are at no round numbers."""
    return np.array([[0.0, 0.0], [1.0, 0.4 * width], [0.3, width]])


def thin_bar(width: float) -> Floats:
    """With a notch in the middle of one side."""
    return np.array([[0.0, 0.0], [1.0, 0.0], [1.0, width], [0.5, 0.5 * width], [0.0, width]])


WIDTHS = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 3.0 * NEAREST)
NEEDLES = {f"triangle {width:g} wide": thin_triangle(width) for width in WIDTHS}
BARS = {f"bar {width:g} wide": thin_bar(width) for width in WIDTHS}

SIZES = {
    f"{name} of diameter {size:g}": ring * (size / Outline(ring).diameter)
    for name, ring in (("triangle", TRIANGLE), ("L", L), ("hour glass", HOUR_GLASS), ("T", T))
    for size in (1.0001 * SMALLEST_DIAMETER, 1e-9, 1e9, LARGEST_COORDINATE)
}

FAR = {
    f"{name} at {far:g}": ring + np.array([far, -far])
    for name, ring in (("L", L), ("hour glass", HOUR_GLASS), ("notched", NOTCHED))
    for far in (1e3, 1e6, 1e9, LARGEST_COORDINATE - 10.0)
}

BUMPS = {
    f"bumps of {bump:g}": middles_added(NOTCHED) + bump * np.sin(np.arange(20.0)).reshape(10, 2)
    for bump in (1e-16, 1e-13, 1e-11, 1e-10, 3e-10, 1e-9, 1e-8, 1e-7, 1e-5)
}

AROUND = HOUR_GLASS - 0.5
WAY = rotated(np.roll(AROUND, -1, axis=0) - AROUND, -0.3)
TWINS = {
    f"vertices {gap:g} apart": np.stack([AROUND, AROUND + gap * WAY], 1).reshape(-1, 2)
    for gap in (1e-16, 1e-13, 1e-11, 1e-10, 3e-10, 1e-9, 1e-7, 1e-5)
}

ENDS = {**NEEDLES, **BARS, **SIZES, **FAR, **BUMPS, **TWINS}


def grasp_of(name: str) -> Floats:
    """Contacts that hold: of a bar in its notch, of a triangle those of its incircle, else what a
    short search finds.
    """
    ring = ENDS[name]
    if name in BARS:
        width = ring[2, 1]
        return np.array([[0.5 - 0.3 * width, 0.0], [0.5 + 0.5 * width, 0.0], [0.5, 0.5 * width]])
    if len(ring) == 3:
        return touched_by_incircle(ring)
    found = held(Outline(ring), Ring.of(ring), 0.0)
    assert found is not None
    return found.contacts


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("name", ENDS)
def test_both_methods_agree_or_refuse(name: str) -> None:
    ring = ENDS[name]
    try:
        case = Case("end", "mm", Outline(ring), 0.0, grasp_of(name))
    except InputError:
        return
    one, other = plan(case), plan(case, method="contact-space")
    far = 1e-16 * float(np.abs(ring).max()) / one.outline.diameter
    assert disagreements(one, other, 1e-7 + 100.0 * far) == []
    document = plan_document(one, caging_regions(one), "end", "mm")
    assert json.loads(json_text(document))["verdict"] == one.status
    assert plan_summary(one, "end", "mm")


def test_what_is_refused_is_too_flat_or_too_small_and_nothing_else() -> None:
    """So that the test above does not pass by refusing."""
    refused: dict[str, str] = {}
    for name, ring in ENDS.items():
        try:
            Case("end", "mm", Outline(ring), 0.0, grasp_of(name))
        except InputError as error:
            refused[name] = str(error)
    flat = {f"triangle {width:g} wide" for width in (1e-7, 3.0 * NEAREST)}
    small = {f"bar {width:g} wide" for width in (1e-7, 3.0 * NEAREST)}
    assert set(refused) == flat | small
    assert all("height over longest side" in refused[name] for name in flat)
    assert all("of the object's diameter) is needed" in refused[name] for name in small)
