"""Why a closing jammed: the object at rest, every contact's force inside its cone of friction.

    python -m experiments.study.report.jam DIR INDEX FILE.svg

draws one trial of a study at its end.
"""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.patches import Circle, PathPatch, Polygon

from experiments.figures.drawing.palette import (
    FINGERS,
    INK,
    OBJECT_EDGE,
    OBJECT_FILL,
    PAPER,
    QUIET_INK,
)
from experiments.figures.drawing.shapes import as_pair, as_path
from experiments.figures.drawing.written import settings, write
from experiments.study.inputs.variables import input_of
from experiments.study.report.pictures import MARGIN, WIDE, Page
from experiments.study.run.one_trial_again import StudyRerun, filmed_scene, rerun_trial
from experiments.study.run.worlds import worlds_of
from icage.arrays import FloatArray
from icage.errors import InputError
from sim.closing.one import data_at
from sim.world.contact_forces import contacts
from sim.world.engine import mj

_STRIP: Final = 70.0
"""[pt] Below the picture, for words."""

_ARROW: Final = 0.09
"""[diameter] Length of an arrow for the largest force."""


@dataclass(frozen=True, slots=True)
class Press:
    """A contact in the object's frame; ``force`` on the object over the closing force."""

    finger: int
    point: FloatArray
    inward: FloatArray
    force: FloatArray


def presses(done: StudyRerun) -> list[Press]:
    """Contacts of a trial at its end."""
    ran = done.ran
    variant = ran.variants[int(ran.which[0])]
    scene = filmed_scene(variant.scene, worlds_of(ran.values, ran.starts, ran.sizes))
    qpos = scene.start_positions(ran.closings.closings.end)[0]
    data = data_at(scene, qpos)
    mj.mj_forward(scene.model, data)
    turn = np.array(
        [[math.cos(qpos[5]), math.sin(qpos[5])], [-math.sin(qpos[5]), math.cos(qpos[5])]]
    )
    found: list[Press] = []
    for one in contacts(scene.model, data):
        point = turn @ (one.point - qpos[3:5]) * scene.object.diameter + scene.object.centre
        force = -(turn @ one.force) / scene.config.drive_force
        found.append(Press(one.finger, point, -(turn @ one.normal), force))
    return found


def draw_jam(done: StudyRerun, path: Path) -> None:
    """Object, fingers, target hand (dashed), cones and forces at the end of a trial.

    Raises
    ------
    InputError:
        The trial was not closed, or nothing touches at its end.
    """
    found = presses(done) if len(done.ran.done) else []
    if not found:
        raise InputError(f"trial {done.index} ended with no contact ({done.now['outcome']})")
    study, ran = done.study, done.ran
    variant = ran.variants[int(ran.which[0])]
    end = ran.closings.closings.end[0]
    fingers = variant.hand.fingers(end)
    mu = float(ran.values[input_of("world", "friction").name][0])
    size, target = variant.outline.diameter, study.cage.contacts
    parts = [variant.outline.polygon, shapely.MultiPoint(np.vstack([fingers, target]))]
    x_0, y_0, x_1, y_1 = shapely.total_bounds(np.array(parts, dtype=object))
    room = 0.06 * size
    width = WIDE - 2 * MARGIN
    height = width * (y_1 - y_0 + 2 * room) / (x_1 - x_0 + 2 * room)
    with settings():
        page = Page(WIDE, height + _STRIP + MARGIN)
        axes = page.axes(MARGIN, _STRIP, width, height)
        axes.set(xlim=(x_0 - room, x_1 + room), ylim=(y_0 - room, y_1 + room), aspect="equal")
        axes.axis("off")
        axes.add_patch(
            PathPatch(as_path(variant.outline.polygon), fc=OBJECT_FILL, ec=OBJECT_EDGE, lw=1.0)
        )
        axes.add_patch(Polygon(target, fc="none", ec=QUIET_INK, lw=0.8, ls=(0, (4.0, 2.6))))
        axes.add_patch(Polygon(fingers, fc="none", ec=INK, lw=1.2))
        for k, at in enumerate(fingers):
            axes.add_patch(
                Circle((at[0], at[1]), variant.finger_radius, fc=FINGERS[k], ec=PAPER, lw=0.6)
            )
        most = max(float(np.hypot(*one.force)) for one in found)
        for one in found:
            _draw_press(axes, one, mu, _ARROW * size, most)
        angle = math.degrees(float(done.now["angle_error"]))
        page.caption(
            _STRIP - 16.0,
            f"Jammed: trial {done.index}, friction {mu:.3g}",
            [
                "Shaded: the cones of friction at the contacts, atan(mu) round the normal.",
                "Arrows: the forces on the object; they balance inside the cones. Dashed: the hand",
                f"in the target grasp, {angle:.3g} degrees and {done.now['position_error']:.3g} "
                f"{study.case.unit} away.",
            ],
        )
        write(page.figure, path)


def _draw_press(axes: Axes, one: Press, mu: float, length: float, most: float) -> None:
    """The cone behind, the force in front, both from the contact inwards."""
    half = math.atan(mu)
    middle = math.atan2(one.inward[1], one.inward[0])
    rim = np.linspace(middle - half, middle + half, 24)
    arc = one.point + 1.6 * length * np.column_stack([np.cos(rim), np.sin(rim)])
    colour = FINGERS[one.finger]
    axes.add_patch(Polygon(np.vstack([one.point, arc]), fc=colour, ec="none", alpha=0.22, zorder=4))
    tip = one.point + length * one.force / most
    axes.annotate(
        "", xy=as_pair(tip), xytext=as_pair(one.point), zorder=6,
        arrowprops={"arrowstyle": "-|>", "color": colour, "lw": 1.6, "shrinkA": 0, "shrinkB": 0},
    )  # fmt: skip


def main(folder: str, index: str, file: str) -> None:
    """Draw one trial."""
    draw_jam(rerun_trial(Path(folder), int(index)), Path(file))


if __name__ == "__main__":
    main(*sys.argv[1:])
