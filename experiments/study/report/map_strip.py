"""The strip below the placement map: what the colours and lines mean."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Polygon

from experiments.figures.drawing.caption import level_digits
from experiments.figures.drawing.palette import FINGERS, INK, PAPER
from experiments.io.outcome_words import NOT_CLOSED
from experiments.study.report.map_panel import (
    colours,
    draw_crosses,
    draw_meant,
    is_solid,
    region_style,
)
from experiments.study.report.names import number
from experiments.study.report.pictures import MARGIN, ROW, Page
from icage.cage import Cage
from icage.cells.regions import FingerRegion

Key = tuple[str, str]
"""What is drawn, and what it means."""

_LINE: Final = 102
"""[character] In a line of text."""

_BAR: Final = (150.0, 8.0)
"""[pt] The colours."""

_KEYS, _KEY_ROW = 210.0, 14.0
"""[pt] Where the keys start; from one to the next."""

_FIRST, _MAX = r"$\sigma_{\mathrm{first}}$", r"$\sigma_{\mathrm{max}}$"


def strip_words(document: Mapping[str, Any], width: float, fewest: int) -> list[str]:
    """Lines about the closings; hexagons ``width`` wide have ``fewest`` closings or more."""
    found, unit = document["found"], document["unit"]
    missing = [
        f"{found['outcomes'][name]:,} ({why})"
        for name, why in NOT_CLOSED.items()
        if found["outcomes"][name]
    ]
    if not found["closed"]:
        why = f": {', '.join(missing)}" if missing else ""
        return textwrap.wrap(f"None of {found['trials']:,} trials was closed{why}.", _LINE)
    text = (
        f"{found['closed']:,} closings; {found['outcomes']['target']:,} ended in the target. The "
        f"colour of a hexagon ({number(width, 2)} {unit} wide) is their share among the closings "
        f"with this finger's start in it, pale where these are fewer than {fewest}. Hexagons end "
        "at the lines of the caging regions unless fingers started beyond."
    )
    if missing:
        text += f" Not shown, as there was no closing: {', '.join(missing)}."
    return textwrap.wrap(text, _LINE)


def strip_keys(
    cage: Cage, regions: Sequence[FingerRegion], document: Mapping[str, Any], *, crosses: bool
) -> list[Key]:
    """What is drawn over the hexagons: ``regions`` are those that can be seen."""
    unit, digits = document["unit"], level_digits(cage)
    keys: list[Key] = [("target", "the target grasp")]
    names = {region.level_name for region in regions}
    same = "" if "sigma_first" not in names or len(names) > 1 else _the_same(cage, document)
    for name, level in sorted({(region.level_name, region.level) for region in regions}):
        symbol = _FIRST if name == "sigma_first" else _MAX
        if name != "sigma_first" and cage.sigma_first == cage.sigma_max:
            symbol = f"{_FIRST} = {_MAX}"
        text = f"caging region below {symbol} = {number(level, digits)} {unit}"
        if name == "all":
            text = "where the object is caged: it never escapes"
        keys.append(("solid" if is_solid(cage, name) else "dashed", text))
    if same:
        keys.append(("", same))
    if not regions:
        keys.append(("", "no caging regions: not a cage"))
    if document.get("nominal") is not None:
        keys.append(("meant", "where the finger should start"))
    if crosses:
        keys.append(("cross", "start of a closing that failed"))
    return keys


def _the_same(cage: Cage, document: Mapping[str, Any]) -> str:
    """Of regions too near those below sigma_first to be drawn beside them."""
    if cage.sigma_max is None:
        return "(that below any opening looks the same here)"
    level = number(cage.sigma_max, level_digits(cage))
    return f"(that below {_MAX} = {level} {document['unit']} looks the same here)"


def strip_height(words: Sequence[str], keys: Sequence[Key]) -> float:
    """[pt] Height of the strip."""
    return MARGIN + ROW * len(words) + 20.0 + _KEY_ROW * max(len(keys), 3)


def draw_strip(
    page: Page, height: float, title: str, words: list[str], keys: Sequence[Key], *, bar: bool
) -> None:
    """Title, lines, the bar of colours, the keys."""
    top = height - 12.0
    page.caption(top, title, words)
    top -= ROW * len(words) + 18.0
    if bar:
        _draw_bar(page, top)
    left = _KEYS if bar else MARGIN
    axes = page.axes(0.0, 0.0, page.width, page.height, facecolor="none", zorder=-1)
    axes.set_axis_off()
    axes.set_xlim(0.0, page.width)
    axes.set_ylim(0.0, page.height)
    for k, (key, text) in enumerate(keys):
        y = top - _KEY_ROW * k
        _draw_key(axes, key, left, y + 3.0)
        page.text(left + 36.0, y, text, 8.5)


def _draw_bar(page: Page, top: float) -> None:
    """Rates 0 to 1 and their colours."""
    axes = page.axes(MARGIN + 4.0, top - 1.0, *_BAR)
    bar = page.figure.colorbar(ScalarMappable(cmap=colours()), cax=axes, orientation="horizontal")
    bar.outline.set(edgecolor=INK, linewidth=0.5)
    axes.set_xticks([0.0, 0.25, 0.5, 0.75, 1.0], ["0", "0.25", "0.5", "0.75", "1"])
    axes.tick_params(labelsize=7.5, width=0.6, length=2.5, colors=INK)
    page.text(
        MARGIN + 4.0 + 0.5 * _BAR[0],
        top - 26.0,
        "share of closings in the target",
        8.5,
        ha="center",
    )


def _draw_key(axes: Axes, key: str, x: float, y: float) -> None:
    if key == "target":
        corners = [(x + 3.0, y - 4.0), (x + 23.0, y - 4.0), (x + 11.0, y + 4.5)]
        axes.add_patch(Polygon(corners, closed=True, fc="none", ec=INK, lw=1.0))
        for corner, colour in zip(corners, FINGERS, strict=True):
            axes.add_patch(Circle(corner, 2.6, fc=PAPER, ec=colour, lw=1.4, zorder=3))
    elif key in ("solid", "dashed"):
        for k, colour in enumerate(FINGERS):
            width, dashes = region_style(key == "solid")
            xs = (x + 1.0 + 9.0 * k, x + 8.0 + 9.0 * k)
            axes.add_line(Line2D(xs, (y, y), color=colour, lw=width, ls=dashes))
    elif key == "meant":
        draw_meant(axes, np.array([[x + 13.0, y]]))
    elif key == "cross":
        draw_crosses(axes, np.array([[x + 13.0, y]]))
