"""The hand's own view of a closing, drawn in two dimensions: what MuJoCo's camera shows elsewhere.

The palm stands still; the object, with the caging regions fixed to it, is pushed about. Engine
positions (6,) = three finger slides, then the object's x, y and turn, all in object diameters.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from matplotlib.path import Path
from matplotlib.transforms import Affine2D

from experiments.figures.drawing.canvas import Canvas, Pen
from experiments.figures.drawing.caption import DARK, LIGHT
from experiments.figures.drawing.palette import (
    FINGERS,
    INK,
    OBJECT_EDGE,
    OBJECT_FILL,
    ORANGE,
    PAPER,
    RULE,
)
from experiments.figures.drawing.shapes import as_path, is_blank, tidied
from icage.arrays import FloatArray
from icage.cells.regions import FingerRegion
from icage.hand import Placement
from sim.camera.stage import View
from sim.world.scene import Scene

_RAIL = 1.5
"""[diameter] Drawn length of the rails; the view cuts them off."""

_WORTH_CLOSING_IN = 2.0
"""[1] The hand must appear larger by this before a part of the object is left out."""


class HandView:
    """One scene seen through one window, drawn into the top left corner of a canvas."""

    def __init__(
        self, scene: Scene, view: View, regions: Sequence[FingerRegion], target: Placement
    ) -> None:
        self._scene, self._view = scene, view
        self._box = (0.0, 0.0, float(view.width), float(view.height))
        self.radius = max(
            scene.finger_radius / scene.object.diameter * view.height / view.extent, 3.0
        )
        self._object = Path(
            np.vstack([scene.object.vertices, scene.object.vertices[:1]]), closed=True
        )
        self._regions = [
            (FINGERS[r.finger - 1], DARK if r.level_name == "sigma_first" else LIGHT, path)
            for r in regions
            if not is_blank(path := _normal_path(scene, r))
        ]
        self._goal = scene.start_positions(target.as_array())[0]

    def draw(self, canvas: Canvas, qpos: FloatArray, start: FloatArray) -> None:
        """One moment of a closing that began at ``start``; both (6,)."""
        canvas.clip(self._box)
        self._draw_rails(canvas)
        place = self._place(qpos)
        for colour, alpha, path in self._regions:
            canvas.path(path, place, fill=colour, alpha=alpha, pen=Pen(colour, alpha=0.8))
        canvas.path(self._object, place, fill=OBJECT_FILL, pen=Pen(OBJECT_EDGE, 1.8))
        self.draw_goal(canvas)
        canvas.clip(self._box)
        for k, centre in enumerate(self.fingers(start)):
            canvas.disc(centre, self.radius, None, FINGERS[k], 1.4, alpha=0.6)
        centres = self.fingers(qpos)
        canvas.line(np.vstack([centres, centres[:1]]), INK, 2.2)
        for k, centre in enumerate(centres):
            canvas.disc(centre, self.radius, FINGERS[k], PAPER, 1.5)
        canvas.clip(None)
        self.draw_numbers(canvas, qpos)

    def draw_numbers(self, canvas: Canvas, qpos: FloatArray) -> None:
        """1, 2, 3 on the fingers, or beside them if they are small."""
        size = float(np.clip(1.2 * self.radius, 12.0, 20.0))
        fits = self.radius >= 9.0
        for k, (x, y) in enumerate(self.fingers(qpos).tolist()):
            if not (0.0 < x < self._view.width and 0.0 < y < self._view.height):
                continue
            across, ink = (0.0, PAPER) if fits else (self.radius + 8.0, FINGERS[k])
            canvas.text(
                x + across, y + 0.36 * size, str(k + 1), size, ink, bold=True, anchor="middle"
            )

    def fingers(self, qpos: FloatArray) -> FloatArray:
        """Finger centres (3, 2), [pixel]."""
        return self._view.pixels(qpos[:3, None] * self._scene.kinematics.directions)

    def _place(self, qpos: FloatArray) -> Affine2D:
        """From the normalized object to pixels."""
        scale = self._view.height / self._view.extent
        x, y = self._view.centre
        return (
            Affine2D()
            .rotate(float(qpos[5]))
            .translate(float(qpos[3]) - x, float(qpos[4]) - y)
            .scale(scale, -scale)
            .translate(0.5 * self._view.width, 0.5 * self._view.height)
        )

    def _draw_rails(self, canvas: Canvas) -> None:
        hub = self._view.pixels(np.zeros(2))
        for direction in self._scene.kinematics.directions:
            end = self._view.pixels(_RAIL * direction)
            canvas.line([hub, end], RULE, 5.0)
            canvas.line([hub, end], PAPER, 1.6)
        canvas.disc(hub, 8.0, RULE)
        canvas.disc(hub, 3.0, PAPER)

    def draw_goal(self, canvas: Canvas) -> None:
        """Where the object will stand in the hand: a dashed outline, over camera frames too."""
        pen = Pen(ORANGE, 2.2, (7.0, 4.0))
        canvas.clip(self._box)
        canvas.path(self._object, self._place(self._goal), pen=pen)
        canvas.clip(None)


def _normal_path(scene: Scene, region: FingerRegion) -> Path:
    """A region in the normalized object's frame."""
    normal = shapely.transform(
        region.geometry, lambda points: (points - scene.object.centre) / scene.object.diameter
    )
    return as_path(tidied(normal, 1e-3))


def window_on(
    scene: Scene, qpos: FloatArray, width: int, height: int, *, whole: bool = False
) -> View:
    """The window for all frames (F, 6): hand and object.

    Where the hand is small on the object, only the hand with some room around it, unless the
    ``whole`` object is wanted.
    """
    everything = View.around(scene, qpos, width, height)
    fingers = (qpos[:, :3, None] * scene.kinematics.directions).reshape(-1, 2)
    low, high = fingers.min(axis=0), fingers.max(axis=0)
    room = 0.9 * float((high - low).max())
    extent = max(high[1] - low[1] + room, (high[0] - low[0] + room) * height / width)
    if whole or everything.extent < _WORTH_CLOSING_IN * extent:
        return everything
    x, y = (0.5 * (low + high)).tolist()
    return View((x, y), float(extent), width, height)
