"""The level that friction leaves over its coefficient, filled below: there closing ends well."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patheffects import withStroke
from matplotlib.ticker import FixedLocator, NullLocator

from experiments.figures.drawing.palette import INK, PAPER, QUIET_INK, RULE, SKY, tint
from icage.arrays import FloatArray

_LOG = 0.1
"""[1] Where the least opening left is less than this share of the largest, the axis is
logarithmic."""

_BETWEEN = 11.0
"""[pt] Numbers of the axis are no nearer to each other."""

_WIDE = 1.5
"""[1] Coefficients above this are drawn by their angle."""

_COEFFICIENTS = (0.0, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.5, 2.5, 5.0, 20.0)

_LETTER = 11.0
"""[pt] Room of a letter."""

_TICKS = (1.001, 1.002, 1.005, 1.01, 1.02, 1.05, 1.1, 1.2, 1.5, 2.0, 3.0, 5.0, 10.0, 20.0, 50.0)


@dataclass(frozen=True, slots=True)
class Mark:
    """A coefficient that was asked for, its ratio, and the letter of its panel ("" for none)."""

    mu: float
    ratio: float
    letter: str


def draw_level_curve(axes: Axes, mu: FloatArray, ratio: FloatArray, marks: Sequence[Mark]) -> None:
    """sigma_first(mu) / sigma_0 as a polyline (n,), a jump being two points of one coefficient."""
    left = ratio - 1.0
    least, most = float(left.min()), float(left.max())
    logarithmic = least < _LOG * most
    low = 0.5 * least if logarithmic else 0.0
    high = most * (1.6 if logarithmic else 1.12)
    if logarithmic:
        axes.set_yscale("log")
    axes.set_ylim(low, high)
    if mu[-1] > _WIDE:
        _as_angles(axes, float(mu[-1]))
    axes.set_xlim(0.0, float(mu[-1]))
    axes.fill_between(mu, low, left, color=tint(SKY, 0.22), lw=0.0, zorder=1)
    axes.plot(mu, left, color=INK, lw=1.4, zorder=3, solid_joinstyle="miter")
    _draw_marks(axes, marks)
    _ticks(axes, low, high, logarithmic)
    axes.set_xlabel(r"coefficient of friction at the fingers, $\mu$", fontsize=9, color=INK)
    axes.set_ylabel(r"$\sigma_{\mathrm{first}}(\mu)\,/\,\sigma_0$", fontsize=9, color=INK)
    axes.tick_params(labelsize=8.5, colors=INK, width=0.7, length=3.0)
    axes.grid(axis="y", color=RULE, lw=0.5, zorder=0)
    axes.set_axisbelow(True)
    for side, spine in axes.spines.items():
        spine.set_visible(side in ("left", "bottom"))
        spine.set_color(QUIET_INK)
        spine.set_linewidth(0.8)
    axes.text(
        0.985, 0.93, "below the line closing ends near the target", transform=axes.transAxes,
        ha="right", va="top", fontsize=8.5, color=QUIET_INK,
        bbox={"fc": PAPER, "ec": "none", "pad": 2.0},
    )  # fmt: skip


def _draw_marks(axes: Axes, marks: Sequence[Mark]) -> None:
    """Dots, and above them their letters: one for neighbours that have the same."""
    figure = axes.get_figure(root=True)
    assert figure is not None
    placed: list[tuple[float, float, str]] = []
    for mark in sorted(marks, key=lambda one: one.mu):
        axes.plot(
            [mark.mu], [mark.ratio - 1.0], "o", ms=4.0, color=INK, mec=PAPER, mew=0.7, zorder=5,
            clip_on=False,
        )  # fmt: skip
        at = axes.transData.transform((mark.mu, mark.ratio - 1.0)) * 72.0 / figure.dpi
        x, y, up = float(at[0]), float(at[1]), 5.0
        near = [one for one in placed if abs(x - one[0]) < _LETTER]
        if not mark.letter or any(mark.letter == other for _, _, other in near):
            continue
        for _, taken, _ in sorted(near, key=lambda one: one[1]):
            if abs(y + up - taken) < _LETTER:
                up = taken - y + _LETTER
        axes.annotate(
            mark.letter, (mark.mu, mark.ratio - 1.0), (0.0, up), textcoords="offset points",
            fontsize=9.5, fontweight="bold", color=INK, zorder=6, ha="center", va="bottom",
            annotation_clip=False, path_effects=[withStroke(linewidth=2.0, foreground=PAPER)],
        )  # fmt: skip
        placed.append((x, y + up, mark.letter))


def _as_angles(axes: Axes, largest: float) -> None:
    """Friction by its angle, the numbers staying coefficients: what is small keeps its room."""
    axes.set_xscale("function", functions=(np.arctan, np.tan))
    shown = [t for t in _COEFFICIENTS if t <= largest]
    if largest > 1.3 * shown[-1]:
        shown.append(largest)
    axes.xaxis.set_major_locator(FixedLocator(shown))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_major_formatter(lambda value, _: f"{value:.4g}")


def _ticks(axes: Axes, low: float, high: float, logarithmic: bool) -> None:
    """Labels are ratios of sigma, whatever the axis is."""
    if not logarithmic:
        axes.yaxis.set_major_formatter(lambda value, _: f"{1.0 + value:.4g}")
        return
    figure = axes.get_figure(root=True)
    assert figure is not None
    tall = float(axes.get_window_extent().height) * 72.0 / figure.dpi
    apart = (high / low) ** (_BETWEEN / tall)
    ticks: list[float] = []
    for t in reversed([t for t in _TICKS if low <= t - 1.0 <= high]):
        if not ticks or (ticks[-1] - 1.0) / (t - 1.0) >= apart:
            ticks.append(t)
    axes.yaxis.set_major_locator(FixedLocator([t - 1.0 for t in ticks]))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter(lambda value, _: f"{1.0 + value:g}")
