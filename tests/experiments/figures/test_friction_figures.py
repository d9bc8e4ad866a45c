"""The figures of friction and of placements: what they show, where letters and bars stand."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

import icage
from experiments.figures.drawing.level_curve import Mark, draw_level_curve
from experiments.figures.friction import draw_friction
from experiments.figures.placement import placement_figure
from models import CASES


def axes_of_a_page() -> tuple[Figure, object]:
    figure = Figure(figsize=(7, 2))
    FigureCanvasAgg(figure)
    return figure, figure.add_axes((0.1, 0.2, 0.85, 0.75))


def letters_of(largest: float, marks: list[Mark]) -> list[tuple[str, float, float]]:
    """Letters drawn and where, in points."""
    figure, axes = axes_of_a_page()
    draw_level_curve(axes, np.array([0.0, largest]), np.array([1.5, 1.5]), marks)
    FigureCanvasAgg(figure).draw()
    boxes = [(t.get_text(), t.get_window_extent()) for t in axes.texts if len(t.get_text()) == 1]
    scale = 72.0 / figure.dpi
    return [(word, box.x0 * scale, box.y0 * scale) for word, box in boxes]


def test_letters_of_neighbours_do_not_lie_on_each_other() -> None:
    marks = [Mark(0.1 + 0.001 * k, 1.5, letter) for k, letter in enumerate("abc")]
    found = letters_of(1.0, marks)
    assert [word for word, _, _ in found] == ["a", "b", "c"]
    assert np.diff([y for _, _, y in found]).min() > 9.0


def test_one_letter_for_neighbours_with_the_same() -> None:
    marks = [Mark(mu, 1.5, "a") for mu in (0.1, 0.105, 0.9)]
    assert [word for word, _, _ in letters_of(1.0, marks)] == ["a", "a"]


def test_a_huge_coefficient_leaves_room_for_small_ones() -> None:
    found = letters_of(100.0, [Mark(0.1, 1.5, "a"), Mark(0.3, 1.5, "b"), Mark(100.0, 1.5, "c")])
    x = [at for _, at, _ in found]
    assert min(np.diff(x)) > 40.0


def test_jams_without_a_panel_are_counted(tmp_path: Path) -> None:
    cage = icage.plan(icage.load("pliers"))
    (level,) = icage.friction_levels(cage, [0.2])
    assert level.jam is not None
    curve = icage.friction_curve(cage, 0.3)
    levels = [
        replace(
            level, mu=0.01 * k, jam=replace(level.jam, sigma=level.jam.sigma * (1.0 + 0.001 * k))
        )
        for k in range(1, 9)
    ]
    draw_friction(cage, levels, curve, "pliers", "mm", tmp_path / "a.svg")
    text = (tmp_path / "a.svg").read_text(encoding="utf-8")
    assert "2 other jams limit larger coefficients: not drawn" in text
    draw_friction(cage, levels[:6], curve, "pliers", "mm", tmp_path / "b.svg")
    assert "not drawn" not in (tmp_path / "b.svg").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", ["near_parallel_tight", "T_best", "disc_hammer"])
def test_the_scale_bar_keeps_off_the_fingers(name: str) -> None:
    cage = icage.plan(icage.load(str(CASES / f"{name}.json")))
    best = icage.place(cage)
    figure = placement_figure(cage, best, name, "mm")
    bar = figure.axes[0].lines[0]
    ends = np.column_stack(bar.get_data())
    line = ends[0] + np.linspace(0.0, 1.0, 50)[:, None] * (ends[1] - ends[0])
    off = np.hypot(*(line[:, None] - best.fingers).transpose(2, 0, 1)).min()
    assert off > cage.finger_radius + best.tolerance


def test_a_hand_that_is_hardly_open_is_not_said_to_be_shut() -> None:
    cage = icage.plan(icage.load(str(CASES / "near_parallel_tight.json")))
    best = icage.place(cage)
    words = placement_figure(cage, best, "tight", "m").texts[1].get_text()
    assert "opened by" in words
