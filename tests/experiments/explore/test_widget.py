"""The page as a widget, where anywidget is installed; and what is said where it is not."""

from __future__ import annotations

import sys

import pytest

from experiments.explore.page_html import style_text
from experiments.explore.widget import explore_widget, themed_style
from icage.errors import InputError
from tests.experiments.explore.placements import cage_of


def test_without_anywidget_the_error_says_what_to_install(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(sys.modules, "anywidget", None)
    with pytest.raises(InputError, match=r"pip install 'icage\[notebook\]'"):
        explore_widget(cage_of("cross_multi"))


def test_the_widget_starts_at_the_target_and_carries_the_page():
    pytest.importorskip("anywidget", reason="the widget is optional: pip install icage[notebook]")
    cage = cage_of("cross_multi")
    widget = explore_widget(cage, [0.3, 0.1])
    assert cage.query(widget.placement).verdict == "target"
    assert widget.document["plan"]["sigma_max"] == cage.sigma_max
    assert [level["mu"] for level in widget.document["plan"]["friction"]] == [0.1, 0.3]
    assert set(widget.trait_names(sync=True)) >= {"document", "placement"}


def test_the_widget_has_dark_colours_for_a_dark_notebook_and_a_dark_system():
    style, plain = themed_style(), style_text()
    (dark,) = [line for line in plain.splitlines() if line.strip().startswith("--paper: #14181c")]
    assert (plain.count(dark.strip()), style.count(dark.strip())) == (1, 2)
    assert ".icage.icage-dark { color-scheme: dark;" in style
    assert ".icage:not(.icage-light) {" in style
