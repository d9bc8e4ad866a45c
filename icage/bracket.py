"""Bounds of a drawing's sigma_max: from one placement, on outlines inside and around it. Our own.

A smaller obstacle leaves the hand more room: what escapes around the drawing escapes around an
outline inside it, by the same way, and what escapes around an outer outline escapes around the
drawing. So take a placement that is clear of both, deep in the guaranteed set of the cage that was
planned; the level at which the object can escape from there lies, for the drawing itself, between
those of the two outlines. With discs the inner outline is grown to chords and the outer one to
tangents of the arcs, which keeps the sides.

sigma_first is not monotone in the obstacle and has no such bounds. The target itself would be no
place to start from: the best grasps stand where a finger is just about to be free, and on another
outline the same hand has its least opening elsewhere.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import shapely

from icage.arrays import FloatArray, IntArray
from icage.cage import Cage
from icage.case import Case
from icage.cells.free_space import FreeSpace, search
from icage.cells.membership import Locator
from icage.checks import an_instance
from icage.discs.offsets import offsets
from icage.errors import GraspError, InputError
from icage.formats.drawings.read import trace_file
from icage.formats.drawings.reading import Side
from icage.geometry.near_frame import NearFrame
from icage.hand import Placement
from icage.outline import Outline
from icage.planner import plan
from icage.sampling import SamplingError, draw_starts

_DRAWN = 256
"""Placements among which the deepest is taken."""

_SEGMENTS = 64
"""Of an arc of the grown outline, per quadrant: 7.5e-5 radii between the curve and its polygons."""

_ON = 1e-12
"""[diameter] Slack of point location."""


@dataclass(frozen=True, slots=True)
class Bracket:
    """Bounds of the sigma_max of a drawing, for one hand.

    Attributes
    ----------
    lower, upper:
        [unit] Levels of the escape from ``placement`` around the outline inside the drawing, and
        around the one outside; None: the object never escapes.
    tolerance:
        [unit] How far either outline is from the drawing, at most.
    placement:
        Where the hand stands, clear of both outlines, in the frame of the
        case's outline.
    clearance:
        [unit] Its least distance from the case's outline.
    vertices:
        Of the outline inside and of the one outside.
    """

    lower: float | None
    upper: float | None
    tolerance: float
    placement: Placement
    clearance: float
    vertices: tuple[int, int]


def bracket(case: Case) -> Bracket:
    """Bounds of sigma_max for the drawing that a case was read from.

    Raises
    ------
    InputError:
        The case was not read from a drawing.
    GraspError:
        There is no grasp, it is no cage, or its guaranteed set has no placement that is clear of
        both outlines: the tolerance is too coarse for this grasp.
    """
    an_instance(case, Case, "case")
    _ = case.contacts  # says that there is no grasp
    if case.reading is None:
        raise InputError(
            f"{case.name} was not read from a drawing: its outline is exact, and so are its levels"
        )
    cage = plan(case)
    row, clearance = _deepest(cage, case)
    levels: list[float | None] = []
    vertices: list[int] = []
    tolerance = 0.0
    sides: tuple[Side, Side] = ("inside", "outside")
    for side in sides:
        traced = trace_file(case.sources[-1], replace(case.reading, safe=side))
        tolerance = max(tolerance, traced.distance)
        levels.append(_level(cage, traced.outline, side, row))
        vertices.append(len(traced.outline))
    if levels[0] == 0.0 or levels[1] == 0.0:
        raise GraspError(
            f"{case.name}: no placement in the guaranteed set keeps clear of the outlines inside "
            f"and around the drawing (the deepest has {clearance:.3g} {case.unit}); give a smaller "
            f"tolerance than {tolerance:.3g} {case.unit}"
        )
    return Bracket(
        levels[0], levels[1], tolerance, Placement(*row.tolist()), clearance,
        (vertices[0], vertices[1]),
    )  # fmt: skip


def _deepest(cage: Cage, case: Case) -> tuple[FloatArray, float]:
    """The placement of the guaranteed set that is furthest from the outline, and how far."""
    try:
        rows = draw_starts(cage, "guaranteed", _DRAWN, np.random.default_rng(0)).placements
    except SamplingError as error:
        raise GraspError(f"{case.name}: no bounds from this grasp: {error}") from error
    fingers = cage.hand.fingers(rows)
    away = shapely.distance(shapely.points(fingers), cage.outline.polygon) - cage.finger_radius
    least = away.min(axis=1)
    return rows[int(least.argmax())], float(least.max())


def _level(cage: Cage, outline: Outline, side: Side, row: FloatArray) -> float | None:
    """Level of the escape from a placement; None: never; 0 where it is not free."""
    frame = NearFrame.of(outline)
    outline, row = frame.outline_into(outline), frame.rows_into(row)
    if cage.finger_radius > 0.0:
        grown = offsets(outline, cage.finger_radius, _SEGMENTS)
        outline = grown.inner if side == "inside" else grown.outer
    free_space = FreeSpace.around(outline, cage.hand)
    fingers = cage.hand.fingers(row[None, :])
    cells: IntArray = Locator.of(free_space).cells(fingers, _ON * outline.diameter)
    if (cells < 0).any():
        return 0.0
    found = search(free_space, cells[0], float(row[3]))
    return None if found.never_escapes else max(found.level, float(row[3]))
