"""What theory promises under friction and what closings did, of the ready studies, in one picture.

    python -m experiments.study.ready.friction_picture [DIR [FILE]]

For each object: sigma_first(mu) / sigma_0, and below it the share of the study's starts that lie
under that level, which must end near the target, beside the share that did. Starts are drawn again
from the study's seed; nothing is closed. [docs/studies.md]
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FixedLocator, NullLocator
from PIL import Image

from experiments.figures.drawing.level_curve import draw_level_curve
from experiments.figures.drawing.palette import FINGERS, INK, PAPER, QUIET_INK, RULE, SKY, tint
from experiments.figures.drawing.written import settings, write
from experiments.io.intervals import wilson
from experiments.study.ready.__main__ import OUT
from experiments.study.report.pictures import MARGIN, WIDE, Page
from experiments.study.run.document import study_of
from icage.arrays import FloatArray, IntArray
from icage.formats.whole_files import whole_file
from icage.friction.levels import JamTolerance, friction_levels

FIGURE: Final = OUT.parent / "figures" / "friction_rates.png"

STUDIES: Final = {
    "friction-pliers": "pliers", "friction-saw": "saw", "friction-wrench": "wrench",
    "friction-three-edges": "three straight edges",
}  # fmt: skip

_SEEN: Final = np.concatenate([np.linspace(0.0, 0.02, 9), np.geomspace(0.0205, 1.0, 160)])
"""Coefficients at which the curves are computed."""

_LINEAR: Final = 0.02
"""Up to here the axis of the coefficient is linear, from there on logarithmic."""

_SEEABLE: Final = 1e-4
"""[1] Less is a hundredth of a point on the page."""

_ENDS: Final = np.isin(np.arange(len(_SEEN)), (0, len(_SEEN) - 1))

_TICKS: Final = (0.0, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0)


@dataclass(frozen=True, slots=True)
class Compared:
    """One object: the level and the promised share over ``_SEEN``, and what the closings did.

    Attributes
    ----------
    ratio, promised:
        (n,) sigma_first(mu) / sigma_0, and the share of starts below sigma_first(mu).
    rows:
        (mu, in the target, closings) of the study.
    """

    name: str
    ratio: FloatArray
    promised: FloatArray
    rows: tuple[tuple[float, int, int], ...]


def compared(name: str, document: Mapping[str, Any]) -> Compared:
    """Prediction and result of one study over friction."""
    study = study_of(document)
    within = JamTolerance(study.config.position_tolerance, study.config.angle_tolerance)
    found = friction_levels(study.cage, _SEEN.tolist(), within)
    levels = np.array([np.inf if one.sigma_first is None else one.sigma_first for one in found])
    numbers = np.arange(study.config.trials)
    sigma = study.intended.placements(numbers, np.zeros_like(numbers))[:, 3]
    bins = document["found"]["variables"]["friction"]["bins"]
    return Compared(
        name, levels / study.cage.sigma_0, (sigma < levels[:, None]).mean(axis=1),
        tuple((one["mean"], one["target"], one["trials"]) for one in bins),
    )  # fmt: skip


def draw(some: Sequence[Compared], path: Path) -> None:
    """All of them on one page, two across."""
    wide, curve, rates, gap = 0.5 * (WIDE - 2.0 * MARGIN) - 46.0, 74.0, 110.0, 10.0
    block = curve + rates + gap + 66.0
    rows = (len(some) + 1) // 2
    with settings():
        page = Page(WIDE, rows * block + 30.0)
        for k, one in enumerate(some):
            x = MARGIN + 38.0 + (k % 2) * (wide + 54.0)
            y = page.height - (k // 2 + 1) * block + 44.0
            page.text(x, y + rates + gap + curve + 7.0, one.name, 9.5, fontweight="bold")
            upper = page.axes(x, y + rates + gap, wide, curve)
            bends = _bends(np.log(one.ratio))
            draw_level_curve(upper, _SEEN[bends], one.ratio[bends], ())
            for text in list(upper.texts):
                text.remove()
            upper.set_xlabel("")
            upper.yaxis.set_label_coords(-0.165, 0.5)
            _friction_axis(upper, numbers=False)
            _draw_rates(page.axes(x, y, wide, rates), one)
        page.text(
            MARGIN, 20.0,
            "Filled: starts below the level, which have to end near the target. Dots: the share "
            "of 200 closings each that did,", 8.5, color=QUIET_INK,
        )  # fmt: skip
        page.text(
            MARGIN, 8.0,
            "with Wilson's interval at 95 %. Starts above the level may end there, too, or jam.",
            8.5, color=QUIET_INK,
        )  # fmt: skip
        write(page.figure, path)


def _draw_rates(axes: Axes, one: Compared) -> None:
    bends = _bends(one.promised)
    mu, promised = _SEEN[bends], one.promised[bends]
    axes.fill_between(mu, 0.0, promised, color=tint(SKY, 0.30), lw=0.0, zorder=1)
    axes.plot(mu, promised, color=INK, lw=1.0, zorder=2)
    for mu, reached, closed in one.rows:
        low, high = wilson(reached, closed)
        axes.plot([mu, mu], [low, high], color=FINGERS[1], lw=1.2, zorder=5, clip_on=False)
        axes.plot(
            [mu], [reached / closed], "o", ms=4.0, color=FINGERS[1], mec=PAPER, mew=0.5, zorder=4,
            clip_on=False,
        )  # fmt: skip
    axes.set_ylim(0.0, 1.0)
    axes.yaxis.set_major_locator(FixedLocator([0.0, 0.25, 0.5, 0.75, 1.0]))
    axes.yaxis.set_major_formatter(lambda value, _: f"{100.0 * value:.0f} %")
    axes.set_ylabel("share of starts", fontsize=8.5, color=INK)
    axes.yaxis.set_label_coords(-0.165, 0.5)
    axes.grid(axis="y", color=RULE, lw=0.5, zorder=0)
    axes.set_axisbelow(True)
    for side, spine in axes.spines.items():
        spine.set_visible(side in ("left", "bottom"))
        spine.set_color(QUIET_INK)
        spine.set_linewidth(0.8)
    axes.tick_params(labelsize=8.0, colors=INK, width=0.7, length=3.0)
    axes.set_xlabel(r"friction of the fingers, $\mu$", fontsize=8.5, color=INK)
    _friction_axis(axes, numbers=True)


def _bends(values: FloatArray) -> IntArray:
    """Where a curve over ``_SEEN`` is not level for the eye, and its ends."""
    flat = np.abs(np.diff(values)) < _SEEABLE
    return np.flatnonzero(~(np.append(True, flat) & np.append(flat, True)) | _ENDS)


def _friction_axis(axes: Axes, *, numbers: bool) -> None:
    axes.set_xscale("symlog", linthresh=_LINEAR, linscale=0.5)
    axes.set_xlim(0.0, 1.0)
    axes.xaxis.set_major_locator(FixedLocator(list(_TICKS)))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_major_formatter(lambda value, _: f"{value:g}" if numbers else "")
    axes.tick_params(labelsize=8.0)


def _in_few_colours(path: Path) -> None:
    """A picture for a page, a quarter of the size."""
    with Image.open(path) as whole:
        few = whole.convert("RGB").quantize(48)
    with whole_file(path) as part:
        few.save(part, format="png", optimize=True)


def main(folder: str = str(OUT), figure: str = str(FIGURE)) -> None:
    """Draw the picture from the documents in a folder."""
    found = [
        compared(title, json.loads((Path(folder) / name / "study.json").read_text("utf-8")))
        for name, title in STUDIES.items()
    ]
    draw(found, Path(figure))
    if Path(figure).suffix.lower() == ".png":
        _in_few_colours(Path(figure))
    for one in found:
        at = np.interp([mu for mu, _, _ in one.rows], _SEEN, one.promised)
        for (mu, reached, closed), share in zip(one.rows, at, strict=True):
            low, high = wilson(reached, closed)
            print(
                f"{one.name}, {mu:g}: promised {100 * share:.1f} %, "
                f"reached {100 * low:.1f} to {100 * high:.1f} %"
            )


if __name__ == "__main__":
    main(*sys.argv[1:])
