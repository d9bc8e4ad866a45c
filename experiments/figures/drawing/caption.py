"""The strip below the drawing: name, the values of sigma, what the shades mean, a scale bar."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass

from matplotlib.lines import Line2D
from matplotlib.patches import Polygon, Rectangle
from matplotlib.text import Text

from experiments.figures.drawing.numbers import significant
from experiments.figures.drawing.palette import FINGERS, INK, QUIET_INK
from experiments.figures.drawing.shapes import scale_bar_length
from experiments.figures.drawing.sheet import Sheet
from experiments.io.one_line import in_figure
from icage.cage import Cage

ROW = 14.0
"""[pt] From one line to the next."""

_CHIPS, _SYMBOL, _VALUE, _RATIO, _WORDS = 0.0, 36.0, 72.0, 136.0, 206.0
"""[pt] Where the columns start, from the left margin."""

LIGHT, DARK = 0.20, 0.42
"""[1] Opacity of the regions at sigma_max and at sigma_first."""


@dataclass(frozen=True, slots=True)
class Line:
    """One row: a key ("target", "escape", "light", "dark", ""), symbol, value, ratio, words."""

    key: str
    symbol: str
    value: str
    ratio: str
    words: str


def caption_lines(cage: Cage, unit: str) -> tuple[Line, ...]:
    """What there is to say about a cage, a row each."""
    target = Line("target", r"$\sigma_0$", _length(cage.sigma_0, unit), "", "target grasp")
    if cage.status == "not_a_cage":
        why = textwrap.wrap(f"not a cage: {cage.why}", 74)
        return (target, *(Line("", "", "", "", text) for text in why))
    rows = [target]
    first, last = cage.sigma_first, cage.sigma_max
    if first is not None and first != last:
        rows.append(_level("dark", r"$\sigma_{\mathrm{first}}$", first, cage, unit))
    if last is None:
        rows.append(Line("light", r"$\sigma_{\mathrm{max}}$", "none", "", "never escapes"))
        return tuple(rows)
    if first == last:
        rows.append(_level("light", r"$\sigma_{\mathrm{first}}$", last, cage, unit))
        words = "below: the object cannot escape"
        rows.append(Line("", r"$\sigma_{\mathrm{max}}$", "the same", "", words))
    else:
        rows.append(_level("light", r"$\sigma_{\mathrm{max}}$", last, cage, unit))
    rows.append(Line("escape", "", "", "", r"escape puncture, at $\sigma_{\mathrm{max}}$"))
    rows.append(Line("", "", "", "", "shaded: the regions from inside, the safe side"))
    return tuple(rows)


def _level(key: str, symbol: str, level: float, cage: Cage, unit: str) -> Line:
    words = {
        "dark": "below: closing ends in the target",
        "light": "below: the object cannot escape",
    }[key]
    if cage.sigma_first == cage.sigma_max:
        words = "below: closing ends in the target"
    if cage.wedge is not None and "target" in words:
        words += ", if all fits exactly"
    digits = level_digits(cage)
    ratio = rf"$= {significant(level / cage.sigma_0, digits)}\,\sigma_0$"
    return Line(key, symbol, _length(level, unit, digits), ratio, words)


def level_digits(cage: Cage) -> int:
    """Digits that tell sigma_first and sigma_max apart where they differ: 4 to 6."""
    first, last = cage.sigma_first, cage.sigma_max
    if first is None or last is None or first == last:
        return 4
    ratios = (first / cage.sigma_0, last / cage.sigma_0)
    return next((n for n in (4, 5) if len({f"{ratio:.{n}g}" for ratio in ratios}) == 2), 6)


def _length(value: float, unit: str, digits: int = 4) -> str:
    return f"{significant(value, digits)} {unit}"


def strip_height(lines: tuple[Line, ...]) -> float:
    """[pt] Height of the caption with these lines."""
    return 22.0 + ROW * len(lines) + 6.0


def draw_caption(sheet: Sheet, cage: Cage, lines: tuple[Line, ...], name: str, unit: str) -> None:
    """Name and hand on the first line, then the lines, the scale bar at the right."""
    top = sheet.floor - 16.0
    phi_1, phi_2 = cage.hand.phi_deg
    words = rf"$\varphi$ = ({phi_1:.1f}°, {phi_2:.1f}°)"
    if cage.finger_radius > 0.0:
        words += f",  disc fingers of radius {cage.finger_radius:.4g} {unit}"
    about = sheet.axes.text(sheet.left, top, words, fontsize=8.5, color=QUIET_INK, va="baseline")
    title = sheet.axes.text(
        sheet.left, top, in_figure(name), fontsize=11, fontweight="bold", color=INK, va="baseline"
    )
    room = sheet.right - sheet.left - _width(about) - 10.0
    for kept in range(len(name) - 1, 0, -1):
        if _width(title) <= room:
            break
        title.set_text(f"{in_figure(name[:kept])}…")
    about.set_x(sheet.left + _width(title) + 10.0)
    for k, line in enumerate(lines):
        _draw_line(sheet, line, top - 6.0 - ROW * (k + 1))
    _draw_scale_bar(sheet, unit, top - 6.0 - ROW)


def _width(text: Text) -> float:
    """[pt] How wide a text is on the page."""
    figure = text.get_figure(root=True)
    assert figure is not None
    return float(text.get_window_extent().width * 72.0 / figure.dpi)


def _draw_line(sheet: Sheet, line: Line, y: float) -> None:
    _draw_key(sheet, line.key, y + 3.0)
    if line.symbol:
        columns = ((_SYMBOL, line.symbol), (_VALUE, line.value), (_RATIO, line.ratio))
        for column, text in columns:
            sheet.axes.text(sheet.left + column, y, text, fontsize=9, color=INK, va="baseline")
    start = _WORDS if line.symbol else _SYMBOL
    sheet.axes.text(sheet.left + start, y, line.words, fontsize=9, color=INK, va="baseline")


def _draw_key(sheet: Sheet, key: str, y: float) -> None:
    """Three chips in the fingers' colours, or a small triangle, solid or dashed."""
    x = sheet.left + _CHIPS
    if key in ("light", "dark"):
        for k, colour in enumerate(FINGERS):
            shades = (LIGHT, DARK) if key == "dark" else (LIGHT,)
            for alpha in shades:
                chip = Rectangle((x + 9.0 * k, y - 4.0), 8.0, 8.0, fc=colour, alpha=alpha, lw=0)
                sheet.axes.add_patch(chip)
            frame = Rectangle((x + 9.0 * k, y - 4.0), 8.0, 8.0, fc="none", ec=colour, lw=0.6)
            sheet.axes.add_patch(frame)
    elif key in ("target", "escape"):
        corners = [(x + 5.0, y - 4.0), (x + 21.0, y - 4.0), (x + 12.0, y + 5.0)]
        style = "-" if key == "target" else (0, (3.2, 2.0))
        width = 1.3 if key == "target" else 1.0
        sheet.axes.add_patch(
            Polygon(corners, closed=True, fc="none", ec=INK, lw=width, ls=style, joinstyle="round")
        )


def _draw_scale_bar(sheet: Sheet, unit: str, row: float) -> None:
    length = scale_bar_length(100.0 / sheet.main.zoom)
    x_1, x_0 = sheet.right, sheet.right - length * sheet.main.zoom
    y = row - 2.0
    for xs, ys in (
        ((x_0, x_1), (y, y)),
        ((x_0, x_0), (y - 2.5, y + 2.5)),
        ((x_1, x_1), (y - 2.5, y + 2.5)),
    ):
        sheet.axes.add_line(Line2D(xs, ys, color=INK, lw=1.2, solid_capstyle="butt"))
    sheet.axes.text(
        0.5 * (x_0 + x_1), y + 4.5, f"{length:g} {unit}", fontsize=8.5, color=INK, ha="center"
    )
