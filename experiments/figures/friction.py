"""The figure of friction: the jams that limit the guarantee, and the level over the coefficient.

A panel shows a hand at rest before its target: cones of friction, the forces inside them, the
target dashed. Below is sigma_first(mu) / sigma_0, with the panels' letters on it.
"""

from __future__ import annotations

import string
from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, degrees
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from experiments.figures.drawing.jam_view import draw_jam
from experiments.figures.drawing.level_curve import Mark, draw_level_curve
from experiments.figures.drawing.numbers import significant
from experiments.figures.drawing.palette import INK, QUIET_INK
from experiments.figures.drawing.written import check_suffix, settings, write
from experiments.io.one_line import in_figure
from icage.arrays import FloatArray
from icage.cage import Cage
from icage.errors import InputError
from icage.friction.curve import FrictionCurve
from icage.friction.forces import JamForces, jam_forces
from icage.friction.levels import FrictionLevel, Jam, JamTolerance

_WIDE = 500.0
"""[pt] Of the page: a text column of a journal."""

_PANEL = 190.0
"""[pt] Height of a panel."""

_CURVE = 150.0
"""[pt] Height of the curve."""

_MOST = 6
"""Panels: the jams of the smallest coefficients that were asked for. How many more there are is
written beside them."""

_SAME = 1e-6
"""[1] Jams whose levels differ by less are one."""


@dataclass(frozen=True, slots=True)
class _Panel:
    letter: str
    level: FrictionLevel
    jam: Jam
    forces: JamForces


def draw_friction(
    cage: Cage,
    levels: Sequence[FrictionLevel],
    curve: FrictionCurve,
    name: str,
    unit: str,
    path: Path,
) -> None:
    """Draw the jams of some levels and the curve into an SVG or PNG file, whole or not at all.

    Raises
    ------
    InputError:
        The suffix is neither .svg nor .png, or the cage is none.
    """
    check_suffix(path)
    if cage.status == "not_a_cage" or not levels:
        raise InputError(f"{name} is not a cage: there is no level that friction could lower")
    with settings():
        write(_page(cage, levels, curve, name, unit), path)


def _page(
    cage: Cage,
    levels: Sequence[FrictionLevel],
    curve: FrictionCurve,
    name: str,
    unit: str,
) -> Figure:
    panels, letters, more = _panels(cage, levels)
    across = 1 if len(panels) == 1 else 2
    rows = ceil(len(panels) / across)
    gap, head, foot = 12.0, 26.0, 36.0
    tall = head + rows * (_PANEL + 16.0 + gap) + _CURVE + 22.0 + foot
    figure = Figure(figsize=(_WIDE / 72.0, tall / 72.0), facecolor="white")
    FigureCanvasAgg(figure)
    _title(figure, tall, cage, levels[0].tolerance, name, unit)
    if more:
        jams = "jam limits" if more == 1 else "jams limit"
        figure.text(
            1.0 - 18.0 / _WIDE, (foot + _CURVE + 4.0) / tall,
            f"{more} other {jams} larger coefficients: not drawn", fontsize=8.5, color=QUIET_INK,
            ha="right",
        )  # fmt: skip
    wide = (_WIDE - 28.0 - (across - 1) * gap) / across
    for k, panel in enumerate(panels):
        x = 14.0 + (k % across) * (wide + gap)
        y = tall - head - (k // across + 1) * (_PANEL + 16.0 + gap)
        axes = figure.add_axes((x / _WIDE, y / tall, wide / _WIDE, _PANEL / tall))
        draw_jam(axes, (wide, _PANEL), cage, panel.jam, panel.forces)
        words = (
            rf"$\mu$ = {panel.level.mu:g}: fingers {_list(panel.jam.fingers)} jam at "
            rf"{significant(panel.jam.sigma / cage.sigma_0, 5)} $\sigma_0$"
        )
        above = (y + _PANEL + 5.0) / tall
        figure.text(x / _WIDE, above, panel.letter, fontsize=10, fontweight="bold", color=INK)
        figure.text((x + 13.0) / _WIDE, above, words, fontsize=9, color=INK)
    box = (52.0 / _WIDE, foot / tall, (_WIDE - 52.0 - 18.0) / _WIDE, _CURVE / tall)
    marks = [
        Mark(one.mu, one.sigma_first / cage.sigma_0, letters.get(one.mu, ""))
        for one in levels
        if one.sigma_first is not None
    ]
    draw_level_curve(figure.add_axes(box), curve.mu, _ratio(cage, curve.level), marks)
    return figure


def _panels(
    cage: Cage, levels: Sequence[FrictionLevel]
) -> tuple[list[_Panel], dict[float, str], int]:
    """A panel for each jam of its own, of the smallest coefficient at which it limits.

    With them the letter of the jam that limits each coefficient, and how many jams have no panel.
    """
    panels: list[_Panel] = []
    letters: dict[float, str] = {}
    others: list[float] = []
    for level in sorted(levels, key=lambda one: one.mu):
        jam = level.jam
        if jam is None:
            continue
        same = [p for p in panels if abs(p.jam.sigma - jam.sigma) < _SAME * jam.sigma]
        if same:
            letters[level.mu] = same[0].letter
        elif len(panels) < _MOST:
            letter = string.ascii_lowercase[len(panels)]
            panels.append(_Panel(letter, level, jam, jam_forces(cage, jam, level.mu)))
            letters[level.mu] = letter
        elif all(abs(sigma - jam.sigma) >= _SAME * jam.sigma for sigma in others):
            others.append(jam.sigma)
    return panels, letters, len(others)


def _title(
    figure: Figure, tall: float, cage: Cage, tolerance: JamTolerance, name: str, unit: str
) -> None:
    fingers = (
        f"disc fingers of radius {cage.finger_radius:.4g} {unit}"
        if cage.finger_radius > 0.0
        else "point fingers"
    )
    figure.text(
        14.0 / _WIDE, 1.0 - 15.0 / tall, f"{in_figure(name)}, {fingers}", fontsize=10.5, color=INK,
        fontweight="bold", parse_math=False,
    )  # fmt: skip
    figure.text(
        14.0 / _WIDE, 1.0 - 28.0 / tall,
        f"near the target: within {tolerance.position:g} diameters and "
        f"{degrees(tolerance.angle):.4g}° of it. Dashed: the target. Wedges: friction cones.",
        fontsize=8.5, color=QUIET_INK,
    )  # fmt: skip


def _ratio(cage: Cage, level: FloatArray) -> FloatArray:
    """Over sigma_0; where the hand may open however far, the largest sigma of the cage."""
    top = cage.sigma_max if cage.sigma_max is not None else cage.sigma_largest
    return np.minimum(level, np.inf if top is None else top) / cage.sigma_0


def _list(fingers: Sequence[int]) -> str:
    names = [str(finger) for finger in fingers]
    return f"{', '.join(names[:-1])} and {names[-1]}"
