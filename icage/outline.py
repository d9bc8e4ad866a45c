"""The object: one simple polygon, counterclockwise. [Bunis2018, Sec. IV-A]"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
import shapely
from numpy.typing import ArrayLike

from icage.arrays import FloatArray, read_only, real_numbers
from icage.errors import GeometryError, OutlineError
from icage.kernels.widest import largest_square
from icage.library_faults import geometry_told
from icage.near_touch import NEAREST, near_touch
from icage.values import Value

MAX_VERTICES = 2000
"""Largest outline accepted: the planner's work grows about like n^2.4, minutes beyond this."""

LARGEST_COORDINATE = 1e12
"""Beyond this, coordinates of an object of ordinary size have lost half of their digits."""

SMALLEST_DIAMETER = 1e-12
"""[unit] The counterpart of ``LARGEST_COORDINATE``; far below it, squares of lengths vanish."""

_THINNEST = 1e-9
"""[diameter^2] Area below which a polygon counts as having none: a triangle of this area is seven
times as wide as the bumps that the planner takes for straight (``tolerance.MERGE_VERTEX``)."""

_FEW = 300
"""Vertices of which all pairs are compared sooner than their convex hull is found."""

_ROWS = 256
"""Vertices that are compared with all others at a time, so that no table grows with the square."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Outline(Value):
    """A simple polygon with an area, its vertices counterclockwise.

    Repeated vertices are dropped and a clockwise ring is turned round; apart from that the
    vertices are used bit for bit as given.

    Parameters
    ----------
    vertices:
        (n, 2), open ring (a repeated last vertex is dropped), either orientation.

    Raises
    ------
    OutlineError:
        Not finite, fewer than three different vertices, self-crossing or nearly touching itself
        (says where), no area,
        more than ``MAX_VERTICES`` vertices, coordinates beyond ``LARGEST_COORDINATE`` or a
        diameter below ``SMALLEST_DIAMETER``.

    Examples
    --------
    >>> square = Outline([[0, 0], [0, 1], [1, 1], [1, 0]])
    >>> square.vertices.tolist()
    [[1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0]]
    >>> round(square.diameter, 6)
    1.414214
    """

    vertices: FloatArray
    diameter: float = field(init=False)
    polygon: shapely.Polygon = field(init=False, repr=False, compare=False)

    def __init__(self, vertices: ArrayLike) -> None:
        points = _as_points(vertices)
        if len(points) > MAX_VERTICES:
            raise OutlineError(f"the outline has {len(points)} vertices; at most {MAX_VERTICES}")
        self._settle(points)
        self._check_apart()

    @classmethod
    def computed(cls, vertices: ArrayLike) -> Outline:
        """A polygon that we made ourselves: of any number of vertices, and an error is ours.

        Raises
        ------
        GeometryError:
            Where ``Outline(vertices)`` raises OutlineError.
        """
        outline = object.__new__(cls)
        try:
            outline._settle(_as_points(vertices))
        except OutlineError as error:
            raise GeometryError(f"a computed polygon: {error}") from error
        return outline

    @geometry_told()
    def _settle(self, points: FloatArray) -> None:
        repeated = (points == points[np.arange(len(points)) - 1]).all(axis=1)
        if repeated.any():
            points = points[~repeated] if not repeated.all() else points[:1]
        if len(points) < 3:
            raise OutlineError(
                f"the outline has {len(points)} different vertices; at least 3 are needed"
            )
        diameter = _diameter(points)
        if diameter < SMALLEST_DIAMETER:
            raise OutlineError(
                f"the outline has the diameter {diameter:.3g}; "
                f"at least {SMALLEST_DIAMETER:g} is needed"
            )
        polygon = shapely.Polygon(points)
        if not polygon.is_valid:
            raise OutlineError(f"the outline is not simple: {shapely.is_valid_reason(polygon)}")
        if not polygon.area > _THINNEST * diameter**2:
            raise OutlineError(
                f"the outline has no area: {polygon.area / diameter**2:.3g} of its diameter "
                f"squared; more than {_THINNEST:g} is needed"
            )
        if not polygon.exterior.is_ccw:
            points = points[::-1].copy()
            polygon = shapely.Polygon(points)
        object.__setattr__(self, "vertices", read_only(points))
        object.__setattr__(self, "diameter", diameter)
        object.__setattr__(self, "polygon", polygon)

    @geometry_told()
    def _check_apart(self) -> None:
        """Refuse a slit or a neck that is thinner than the planner can tell from none."""
        found = near_touch(self.vertices, self.diameter)
        if found is not None:
            vertex, edge = (self.vertices[k].tolist() for k in (found.vertex, found.edge))
            raise OutlineError(
                f"the outline nearly touches itself: its vertex {vertex} is {found.gap:.3g} from "
                f"its edge that begins at {edge}; at least {NEAREST * self.diameter:.3g} "
                f"({NEAREST:g} of its diameter) is needed"
            )

    def __len__(self) -> int:
        return len(self.vertices)

    def __repr__(self) -> str:
        width, height = np.ptp(self.vertices, axis=0)
        return f"<Outline: {len(self)} vertices, {width:.6g} x {height:.6g}>"

    @property
    def area(self) -> float:
        """[unit^2]."""
        return float(self.polygon.area)

    @property
    def centroid(self) -> FloatArray:
        """Area centroid, (2,)."""
        centre = self.polygon.centroid
        return np.array([centre.x, centre.y])


def _as_points(vertices: ArrayLike) -> FloatArray:
    try:
        points = real_numbers(vertices)
    except (TypeError, ValueError, OverflowError) as error:
        raise OutlineError("outline vertices must be pairs of numbers [x, y]") from error
    if points.ndim != 2 or points.shape[1:] != (2,):
        raise OutlineError(
            f"outline vertices must be pairs of numbers [x, y]; found an array {points.shape}"
        )
    if np.abs(points).max(initial=0.0) <= LARGEST_COORDINATE:  # not if one of them is nan
        return points
    bad = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(bad):
        raise OutlineError(f"outline vertex {bad[0]} is {points[bad[0]].tolist()}; must be finite")
    far = np.flatnonzero((np.abs(points) > LARGEST_COORDINATE).any(axis=1))
    if len(far):
        raise OutlineError(
            f"outline vertex {far[0]} is {points[far[0]].tolist()}; "
            f"coordinates up to {LARGEST_COORDINATE:g} are allowed"
        )
    return points


def _diameter(points: FloatArray) -> float:
    """Largest distance between two vertices."""
    if len(points) <= _FEW:
        x, y = np.array(points.T, order="C")
        return math.sqrt(largest_square(x, y))
    hull = shapely.get_coordinates(shapely.convex_hull(shapely.linestrings(points)))
    largest = 0.0
    for k in range(0, len(hull), _ROWS):
        x, y = (hull[k : k + _ROWS, None] - hull[None, k:]).transpose(2, 0, 1)
        largest = max(largest, float((x * x + y * y).max()))
    return math.sqrt(largest)
