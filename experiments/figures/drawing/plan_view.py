"""One view of a plan: object, regions, hands, numbers."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.patches import Circle, Patch, PathPatch, Polygon, Rectangle
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from experiments.figures.drawing.caption import DARK, LIGHT
from experiments.figures.drawing.labels import Clutter, place_labels
from experiments.figures.drawing.palette import (
    FINGERS,
    INK,
    OBJECT_EDGE,
    OBJECT_FILL,
    PAPER,
    QUIET_INK,
)
from experiments.figures.drawing.shapes import as_path
from experiments.figures.drawing.sheet import View
from icage.cage import Cage, Puncture
from icage.cells.regions import FingerRegion

_DOT = 2.6
"""[pt] Radius of a point finger's dot."""

_NUMBER_FITS = 5.2
"""[pt] A disc from this radius on carries its number inside."""

_HAIRLINE = 0.3
"""[pt] Inner bounds leave slits narrower than this between cells: closed before drawing."""


def draw_plan_view(
    axes: Axes,
    view: View,
    cage: Cage,
    regions: Sequence[FingerRegion],
    escape: Puncture | None,
    numbers: bool = True,
) -> None:
    """Draw everything inside the view's window; ``numbers`` off for an overview."""
    window = Rectangle(
        view.window[:2], view.window[2] - view.window[0], view.window[3] - view.window[1],
        transform=axes.transData,
    )  # fmt: skip
    painter = _Painter(axes, view, window, cage.finger_radius, 1.0 if numbers else 0.5)
    for region in regions:
        painter.region(region)
    painter.object(cage)
    if escape is not None:
        painter.hand(escape.contacts, escape)
    painter.hand(cage.contacts, None)
    if numbers:
        _draw_numbers(axes, view, cage, escape, painter.disc)


def frame_of(axes: Axes, window: tuple[float, float, float, float]) -> None:
    """A thin rectangle: the edge of a detail, or its place in the overview."""
    x_0, y_0, x_1, y_1 = window
    axes.add_patch(
        Rectangle((x_0, y_0), x_1 - x_0, y_1 - y_0, fc="none", ec=QUIET_INK, lw=0.7, zorder=9)
    )


class _Painter:
    """Adds patches of one view, clipped to its window; lines ``weight`` times as wide."""

    def __init__(
        self, axes: Axes, view: View, window: Rectangle, finger_radius: float, weight: float
    ) -> None:
        self._axes, self._view, self._window, self._weight = axes, view, window, weight
        self.disc = view.zoom * finger_radius if finger_radius > 0.0 else _DOT * weight

    def _add(self, patch: Patch) -> None:
        self._axes.add_patch(patch)
        patch.set_clip_path(self._window)

    def region(self, region: FingerRegion) -> None:
        colour = FINGERS[region.finger - 1]
        on_page = self._view.shape(region.geometry)
        closed = on_page.buffer(_HAIRLINE, join_style="mitre").buffer(
            -_HAIRLINE, join_style="mitre"
        )
        path = as_path(closed)
        alpha = DARK if region.level_name == "sigma_first" else LIGHT
        self._add(PathPatch(path, fc=colour, ec="none", alpha=alpha, zorder=1))
        width = 0.5 * self._weight
        self._add(PathPatch(path, fc="none", ec=colour, lw=width, alpha=0.9, zorder=2))

    def object(self, cage: Cage) -> None:
        path = as_path(self._view.shape(cage.outline.polygon))
        self._add(
            PathPatch(
                path, fc=OBJECT_FILL, ec=OBJECT_EDGE, lw=self._weight, joinstyle="round", zorder=3
            )
        )

    def hand(self, contacts: NDArray[np.float64], puncture: Puncture | None) -> None:
        """Triangle and fingers: solid for the target, dashed and hollow for a puncture.

        A disc that touches nothing has a dashed rim.
        """
        corners = self._view.point(contacts)
        target = puncture is None
        self._add(
            Polygon(
                corners,
                closed=True,
                fc="none",
                ec=INK,
                lw=(1.4 if target else 1.0) * self._weight,
                ls="-" if target else (0, (4.0, 2.6)),
                joinstyle="round",
                zorder=6 if target else 4,
            )
        )
        for k, (corner, colour) in enumerate(zip(corners, FINGERS, strict=True)):
            free = puncture is not None and k + 1 in puncture.free_fingers
            self._add(
                Circle(
                    (float(corner[0]), float(corner[1])),
                    self.disc,
                    fc=colour if target else PAPER,
                    ec=PAPER if target else colour,
                    lw=(0.6 if target else 1.2) * self._weight,
                    ls=(0, (2.0, 1.4)) if free and self.disc >= _NUMBER_FITS else "-",
                    zorder=7 if target else 5,
                )
            )


def _draw_numbers(
    axes: Axes, view: View, cage: Cage, escape: Puncture | None, radius: float
) -> None:
    """1, 2, 3 at the fingers of both hands: inside the disc where it is large enough and free."""
    target = view.point(cage.contacts)
    hands = [target] + ([] if escape is None else [view.point(escape.contacts)])
    clutter = _clutter(view, cage, hands, radius)
    taken: list[shapely.Polygon] = []
    for corners, is_target in zip(hands, (True, False), strict=False):
        for k, (colour, corner) in enumerate(zip(FINGERS, corners, strict=True)):
            covered = not is_target and _nearest(corner, target) < 2.0 * radius
            inside = radius >= _NUMBER_FITS and not covered
            if inside:
                place, size = corner, min(1.25 * radius, 9.0)
                ink = PAPER if is_target else colour
            else:
                place = place_labels(corner[None], [radius], (7.0, 9.0), clutter, taken)[0]
                ink, size = colour, 8.5
            taken.append(shapely.box(*(place - [3.5, 4.5]), *(place + [3.5, 4.5])))
            axes.text(
                place[0],
                place[1],
                str(k + 1),
                fontsize=size,
                fontweight="bold" if is_target else "normal",
                color=ink,
                ha="center",
                va="center_baseline",
                zorder=8,
                path_effects=[] if inside else [withStroke(linewidth=1.6, foreground=PAPER)],
            )


def _nearest(point: NDArray[np.float64], others: NDArray[np.float64]) -> float:
    return float(np.hypot(*(others - point).T).min())


def _clutter(view: View, cage: Cage, hands: list[NDArray[np.float64]], radius: float) -> Clutter:
    discs = np.array([[x, y, radius] for corners in hands for x, y in corners])
    lines = [np.vstack([corners, corners[:1]]) for corners in hands]
    lines.append(view.point(np.vstack([cage.outline.vertices, cage.outline.vertices[:1]])))
    return Clutter(discs, shapely.MultiLineString(lines), shapely.box(*view.window))
