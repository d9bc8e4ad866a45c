"""The level that friction leaves over its coefficient, filled below: there closing ends well."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

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
    axes.set_xlim(0.0, float(mu[-1]))
    axes.fill_between(mu, low, left, color=tint(SKY, 0.22), lw=0.0, zorder=1)
    axes.plot(mu, left, color=INK, lw=1.4, zorder=3, solid_joinstyle="miter")
    for mark in marks:
        axes.plot(
            [mark.mu], [mark.ratio - 1.0], "o", ms=4.0, color=INK, mec=PAPER, mew=0.7, zorder=5,
            clip_on=False,
        )  # fmt: skip
        axes.annotate(
            mark.letter, (mark.mu, mark.ratio - 1.0), (5.0, 5.0), textcoords="offset points",
            fontsize=9.5, fontweight="bold", color=INK, zorder=6,
            path_effects=[withStroke(linewidth=2.0, foreground=PAPER)],
        )  # fmt: skip
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
