"""Small files that other readers get wrong, each with the right answer."""

from __future__ import annotations

from pathlib import Path

import pytest

from icage.errors import FormatError
from icage.formats.drawings.read import trace_file
from icage.formats.drawings.reading import Reading
from icage.formats.drawings.trace import Traced

INPUTS = Path(__file__).parent / "inputs"
L = (0.857, 0.524)


def trace(name: str, **reading: object) -> Traced:
    return trace_file(INPUTS / f"{name}.svg", Reading(**reading))  # type: ignore[arg-type]


def proportions(traced: Traced) -> tuple[float, float]:
    """Aspect and fill of the outline's bounding box."""
    x_low, y_low, x_high, y_high = traced.outline.polygon.bounds
    wide, high = x_high - x_low, y_high - y_low
    return wide / high, traced.outline.area / (wide * high)


@pytest.mark.parametrize(
    ("name", "right"),
    [
        ("css_after", L),
        ("css_child", L),
        ("css_descend", L),
        ("css_group_desc_id", L),
        ("css_important", L),
        ("fill_hex0", L),
        ("fill_inherit", L),
        ("switch", L),
        ("clip_css", (1.0, 0.889)),
        ("clip_frame", (1.0, 0.51)),
        ("nested_rect_double_shift", (2.0, 0.556)),
        ("nest_novb_path", (2.455, 0.484)),
        ("tr_origin", (1.0, 0.344)),
        ("T_after_C", (1.143, 0.743)),
        ("circle_r_pct", (1.765, 0.458)),
        ("pct_noviewbox", (2.667, 0.219)),
        ("hairline_gap", (2.0, 0.7)),
        ("em_units", (2.667, 0.977)),
    ],
)
def test_proportions(name: str, right: tuple[float, float]):
    assert proportions(trace(name, width=100.0, unit="mm")) == pytest.approx(right, abs=2e-3)


@pytest.mark.parametrize(
    ("name", "wide"),
    [("width_only", 40), ("height_only_pct", 20), ("size_space", 40), ("size_uppercase", 40)],
)
def test_sizes(name: str, wide: float):
    traced = trace(name)
    assert (traced.unit, traced.size_from) == ("mm", "from the file's mm")
    assert traced.outline.polygon.bounds == pytest.approx((0, 0, wide, wide))


@pytest.mark.parametrize("name", ["bg_white", "bg_black_icon"])
def test_backgrounds_are_told_and_can_be_left_out(name: str):
    assert any("covers all others" in note for note in trace(name, width=1.0, unit="m").notes)
    without = trace(name, width=1.0, unit="m", background=False)
    assert proportions(without)[1] < 0.6


def test_the_spanner():
    traced = trace("spanner")
    assert traced.outline.polygon.bounds[2] == pytest.approx(158.6, abs=0.05)
    assert any("hole" in note for note in traced.notes)


@pytest.mark.parametrize("name", ["arc_nan", "curve_inf", "inf_scale"])
@pytest.mark.filterwarnings("error")
def test_faults_are_refused_without_a_warning(name: str):
    with pytest.raises(FormatError, match="finite"):
        trace(name)
