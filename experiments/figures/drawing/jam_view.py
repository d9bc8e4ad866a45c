"""A jam drawn: the object around a hand at rest, cones of friction, the forces inside them."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, FancyArrowPatch, PathPatch, Polygon
from matplotlib.patheffects import withStroke

from experiments.figures.drawing.palette import (
    FINGERS,
    INK,
    OBJECT_EDGE,
    OBJECT_FILL,
    PAPER,
    QUIET_INK,
    RULE,
    tint,
)
from experiments.figures.drawing.shapes import as_path
from icage.arrays import FloatArray
from icage.cage import Cage
from icage.friction.forces import JamForces
from icage.friction.levels import Jam

_CONE, _ARROW = 0.8, 0.95
"""[reach] Length of a cone, and of the arrow of the largest force."""


def draw_jam(
    axes: Axes, size: tuple[float, float], cage: Cage, jam: Jam, forces: JamForces
) -> None:
    """Object, both hands (the target dashed), cones and forces, in a window around the hands.

    ``size`` is the width and height of the axes, [pt].
    """
    hands = np.concatenate([jam.contacts, cage.contacts])
    low, high = hands.min(axis=0) - cage.finger_radius, hands.max(axis=0) + cage.finger_radius
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    grow = 1.36 * max(half[0] / size[0], half[1] / size[1])
    window = np.array(size) * grow
    axes.set_xlim(middle[0] - window[0], middle[0] + window[0])
    axes.set_ylim(middle[1] - window[1], middle[1] + window[1])
    axes.set_aspect("equal")
    axes.set_xticks([])
    axes.set_yticks([])
    for spine in axes.spines.values():
        spine.set_color(RULE)
        spine.set_linewidth(0.7)
    axes.add_patch(
        PathPatch(
            as_path(cage.outline.polygon), fc=OBJECT_FILL, ec=OBJECT_EDGE, lw=1.0,
            joinstyle="round", zorder=1,
        )
    )  # fmt: skip
    dashes = (0, (4.0, 2.6))
    axes.add_patch(
        Polygon(cage.contacts, closed=True, fc="none", ec=QUIET_INK, lw=0.9, ls=dashes, zorder=4)
    )
    axes.add_patch(Polygon(jam.contacts, closed=True, fc="none", ec=INK, lw=1.3, zorder=5))
    dot = cage.finger_radius if cage.finger_radius > 0.0 else 4.4 * grow
    for finger, (point, colour) in enumerate(zip(jam.contacts, FINGERS, strict=True), 1):
        free = finger not in jam.fingers
        axes.add_patch(
            Circle(
                (float(point[0]), float(point[1])), dot, fc=PAPER if free else colour,
                ec=colour if free else PAPER, lw=1.2 if free else 0.6, zorder=7,
            )
        )  # fmt: skip
    _draw_forces(axes, forces, _reach(forces, middle, window))
    _number_fingers(axes, jam.contacts, dot, 9.0 * grow)


def _reach(forces: JamForces, middle: FloatArray, window: FloatArray) -> float:
    """Length of a cone, [unit]: of the window a good part, or less so that all stay inside."""
    usual = 0.62 * float(window.min())
    most = usual
    for contact in forces.contacts:
        left = window - np.sign(contact.cone) * (contact.at - middle)
        along = np.abs(contact.cone)
        most = min(most, float((0.97 * left / np.maximum(_CONE * along, 1e-12)).min()))
    return max(most, 0.3 * usual)


def _draw_forces(axes: Axes, forces: JamForces, reach: float) -> None:
    """Cones as wedges into the object, forces as arrows: the largest is as long as a wedge."""
    most = max(float(np.hypot(*c.force)) for c in forces.contacts)
    for contact in forces.contacts:
        colour = FINGERS[contact.finger - 1]
        edges = contact.at + _CONE * reach * contact.cone
        axes.add_patch(
            Polygon(
                [contact.at, *edges], closed=True, fc=tint(colour, 0.35), ec=colour, lw=0.5,
                alpha=0.75, zorder=2,
            )
        )  # fmt: skip
        if most > 0.0 and np.hypot(*contact.force) > 0.02 * most:
            tip = contact.at + _ARROW * reach * contact.force / most
            axes.add_patch(
                FancyArrowPatch(
                    (float(contact.at[0]), float(contact.at[1])), (float(tip[0]), float(tip[1])),
                    arrowstyle="-|>", mutation_scale=9.0, shrinkA=0.0, shrinkB=0.0, lw=1.5,
                    color=colour, zorder=8,
                    path_effects=[withStroke(linewidth=2.6, foreground=PAPER)],
                )
            )  # fmt: skip


def _number_fingers(axes: Axes, contacts: FloatArray, dot: float, beside: float) -> None:
    """1, 2, 3 on the side of the finger that looks away from the hand's middle."""
    away = contacts - contacts.mean(axis=0)
    away /= np.hypot(*away.T)[:, None]
    for k, (point, way) in enumerate(zip(contacts, away, strict=True)):
        place = point + (dot + beside) * way
        axes.text(
            float(place[0]), float(place[1]), str(k + 1), fontsize=8.5, fontweight="bold",
            color=FINGERS[k], ha="center", va="center_baseline", zorder=9,
            path_effects=[withStroke(linewidth=1.8, foreground=PAPER)],
        )  # fmt: skip
