"""The object's own view of many closings: it stands still, the fingers' ways pile up on it."""

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
)
from experiments.figures.drawing.plots import Box
from experiments.figures.drawing.shapes import as_path, is_blank, tidied
from icage.arrays import FloatArray
from icage.cage import Cage
from icage.cells.regions import FingerRegion

_DETAIL = 2.2
"""[1] Show only the hand's surroundings if that makes them larger by this."""


class ObjectView:
    """The object's frame fitted into a box of pixels."""

    def __init__(
        self, cage: Cage, regions: Sequence[FingerRegion], starts: FloatArray, box: Box
    ) -> None:
        self._cage, self._box = cage, box
        hands = shapely.MultiPoint(cage.hand.fingers(starts).reshape(-1, 2))
        hand = shapely.union_all(
            [hands.buffer(2.0 * cage.finger_radius), *(r.geometry.envelope for r in regions)]
        )
        near = hand.buffer(3.0 * cage.finger_radius).bounds
        whole = shapely.union_all([shapely.box(*hand.bounds), cage.outline.polygon]).bounds
        shown = near if self._scale(near) > _DETAIL * self._scale(whole) else whole
        self._zoom = self._scale(shown)
        self._middle = (0.5 * (shown[0] + shown[2]), 0.5 * (shown[1] + shown[3]))
        ring = cage.outline.vertices
        self._object = Path(np.vstack([ring, ring[:1]]), closed=True)
        detail = 1e-3 * cage.outline.diameter
        self._regions = [
            (FINGERS[r.finger - 1], DARK if r.level_name == "sigma_first" else LIGHT, path)
            for r in regions
            if not is_blank(path := as_path(tidied(r.geometry, detail)))
        ]

    def _scale(self, bounds: tuple[float, ...]) -> float:
        left, top, right, bottom = self._box
        return min(
            (right - left) / (bounds[2] - bounds[0]), (bottom - top) / (bounds[3] - bounds[1])
        )

    def _place(self) -> Affine2D:
        left, top, right, bottom = self._box
        x, y = self._middle
        return (
            Affine2D()
            .translate(-x, -y)
            .scale(self._zoom, -self._zoom)
            .translate(0.5 * (left + right), 0.5 * (top + bottom))
        )

    def draw_still(self, canvas: Canvas) -> None:
        """Object and regions: once per closing."""
        canvas.clip(self._box)
        place = self._place()
        for colour, alpha, path in self._regions:
            canvas.path(path, place, fill=colour, alpha=alpha)
        canvas.path(self._object, place, fill=OBJECT_FILL, pen=Pen(OBJECT_EDGE, 1.2))
        canvas.clip(None)

    def draw_ways(self, canvas: Canvas, placements: FloatArray, alpha: float) -> None:
        """The fingers' ways over frames (F, 4)."""
        canvas.clip(self._box)
        ways = self._pixels(placements)
        for k, colour in enumerate(FINGERS):
            canvas.line(ways[:, k], colour, 1.6, alpha=alpha)
        canvas.clip(None)

    def draw_fingers(self, canvas: Canvas, placement: FloatArray) -> None:
        """The fingers now, placement (4,)."""
        canvas.clip(self._box)
        radius = max(self._zoom * self._cage.finger_radius, 3.0)
        for centre, colour in zip(self._pixels(placement[None])[0], FINGERS, strict=True):
            canvas.disc(centre, radius, colour, PAPER, 1.0)
        canvas.clip(None)

    def draw_hand(self, canvas: Canvas, placement: FloatArray, alpha: float = 1.0) -> None:
        """The hand at a placement (4,): its polygon, its fingers and their numbers."""
        canvas.clip(self._box)
        centres = self._pixels(placement[None])[0]
        canvas.line(np.vstack([centres, centres[:1]]), INK, 2.2, alpha=alpha)
        radius = max(self._zoom * self._cage.finger_radius, 4.0)
        size = float(np.clip(1.2 * radius, 12.0, 20.0))
        for k, (centre, colour) in enumerate(zip(centres, FINGERS, strict=True)):
            canvas.disc(centre, radius, colour, PAPER, 1.5, alpha=alpha)
            fits = radius >= 9.0
            x = centre[0] + (0.0 if fits else radius + 8.0)
            ink = PAPER if fits else colour
            y = centre[1] + 0.36 * size
            canvas.text(x, y, str(k + 1), size, ink, bold=True, anchor="middle")
        canvas.clip(None)

    def draw_goal(self, canvas: Canvas, placement: FloatArray) -> None:
        """The fingers of a placement (4,) as dashed circles: where they belong."""
        canvas.clip(self._box)
        radius = max(self._zoom * self._cage.finger_radius, 4.0)
        turn = np.linspace(0.0, 2.0 * np.pi, 41)
        circle = radius * np.column_stack([np.cos(turn), np.sin(turn)])
        centres = self._pixels(placement[None])[0]
        canvas.line(np.vstack([centres, centres[:1]]), ORANGE, 1.8, (7.0, 4.0))
        for centre in centres:
            canvas.line(centre + circle, ORANGE, 2.2, (5.0, 3.0))
        canvas.clip(None)

    def draw_marks(self, canvas: Canvas, placements: FloatArray, radius: float) -> None:
        """A dot, [pixel], for every finger of placements (n, 4)."""
        canvas.clip(self._box)
        for k, colour in enumerate(FINGERS):
            for centre in self._pixels(placements)[:, k]:
                canvas.disc(centre, radius, colour, PAPER, 0.6)
        canvas.clip(None)

    def _pixels(self, placements: FloatArray) -> FloatArray:
        """Finger centres (F, 3, 2), [pixel]."""
        points = self._cage.hand.fingers(placements)
        return self._place().transform(points.reshape(-1, 2)).reshape(points.shape)
