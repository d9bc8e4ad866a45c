"""Fewer vertices for a ring, all on one side of it: a polygon inside the area, or one around it.

An obstacle inside the drawn one leaves the hand more room, so its sigma_max is a lower bound of the
drawing's; one around it gives an upper bound. Our own, after the progressive hulls of [Sander2000].

Two steps keep to the safe side. A corner that points away from it is cut off: the chord between its
neighbours replaces it. An edge between two corners that point towards it is dropped: its neighbours
are drawn out until they meet. Each is done only if no other corner lies in the triangle that is cut
off or filled, so the ring stays simple, and only while the ring stays near.
"""

from __future__ import annotations

import heapq
import math
from itertools import pairwise
from typing import Final

import numpy as np
import shapely

from icage.arrays import FloatArray
from icage.errors import FormatError
from icage.formats.drawings.reading import Side

_MARGIN: Final = 1e-9
"""[longer side] Distance kept from the drawn edges, far above rounding."""

_HALVINGS: Final = 12

_MITRE: Final = 2.0
"""[distance] Furthest that a corner of the moved ring is from the corner it stands for."""


def one_sided(ring: FloatArray, within: float, side: Side, error: float) -> FloatArray:
    """Ring (m, 2) inside or around the area of ``ring`` (k, 2, open), counterclockwise.

    Parameters
    ----------
    ring:
        Boundary of a simple area, either orientation.
    within:
        Largest distance between the two boundaries; at a sharp corner the ring moved by ``error``
        alone may be further off.
    side:
        "inside" or "outside".
    error:
        How far the true boundary may be from ``ring``: the result keeps that distance, too.

    Raises
    ------
    FormatError:
        Nothing is left inside, or the area inside falls apart.

    Examples
    --------
    >>> ring = np.array([[0, 0], [4, 0], [4.1, 2], [4, 4], [0, 4]], dtype=float)
    >>> one_sided(ring, 0.2, "inside", 0.0).round(3).tolist()
    [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]]
    """
    source = shapely.Polygon(ring)
    exact = shapely.get_coordinates(shapely.orient_polygons(source).exterior)[:-1]
    longer = float((ring.max(axis=0) - ring.min(axis=0)).max())
    moved = _moved(source, max(error, _MARGIN * longer), side)
    for halving in range(_HALVINGS):
        distance = within / 2.0**halving
        if error == 0.0 and len(_fewer(exact, distance, side)) == len(exact):
            return exact  # straight edges, and none that could be spared: the area itself
        fewer = _fewer(moved, distance, side)
        polygon = shapely.Polygon(fewer)
        if not polygon.is_valid or not _on_side(polygon, source, side):
            continue
        if shapely.hausdorff_distance(polygon.exterior, source.exterior) <= within:
            return fewer
    return moved


def _on_side(polygon: shapely.Polygon, source: shapely.Polygon, side: Side) -> bool:
    return bool(source.covers(polygon) if side == "inside" else polygon.covers(source))


def _moved(source: shapely.Polygon, by: float, side: Side) -> FloatArray:
    """The ring moved to the safe side; what is too narrow for that is gone, or is said."""
    signed = -by if side == "inside" else by
    area = shapely.buffer(source, signed, join_style="mitre", mitre_limit=_MITRE)
    parts = [part for part in shapely.get_parts(area) if part.area > by * by]
    if len(parts) != 1:
        what = "falls apart" if parts else "is empty"
        raise FormatError(
            f"the outline {side} the drawing {what}: it has places narrower than twice {by:.3g} "
            "units of the file; give a smaller tolerance"
        )
    return shapely.get_coordinates(shapely.orient_polygons(parts[0]).exterior)[:-1]


def _fewer(ring: FloatArray, within: float, side: Side) -> FloatArray:
    """The two steps, the nearest first, until none is left that stays near."""
    thinning = _Thinning(ring, within, 1.0 if side == "inside" else -1.0)
    return thinning.run()


class _Thinning:
    """A ring that loses corners. ``sign`` 1: towards its inside; -1: away from it."""

    def __init__(self, ring: FloatArray, within: float, sign: float) -> None:
        self.at = [(float(x), float(y)) for x, y in ring]
        self.within, self.sign = within, sign
        n = len(ring)
        self.next = [(k + 1) % n for k in range(n)]
        self.last = [(k - 1) % n for k in range(n)]
        self.alive = np.ones(n, dtype=bool)
        self.corners = ring.copy()
        self.stamp = [0] * n
        self.dropped: list[list[int]] = [[] for _ in range(n)]
        self.heap: list[tuple[float, int, int, bool]] = []
        self.source = ring

    def run(self) -> FloatArray:
        """The ring that is left."""
        for k in range(len(self.at)):
            self._offer(k)
        count = len(self.at)
        while self.heap and count > 3:
            _, k, stamp, edge = heapq.heappop(self.heap)
            if not self.alive[k] or self.stamp[k] != stamp:
                continue
            if self._drop_edge(k) if edge else self._cut_corner(k):
                count -= 1
        start = int(np.flatnonzero(self.alive)[0])
        order = [start]
        while self.next[order[-1]] != start:
            order.append(self.next[order[-1]])
        return np.array([self.at[k] for k in order])

    def _offer(self, k: int) -> None:
        """Corner k, and the edge that leaves it, as they stand now."""
        self.stamp[k] += 1
        if self._turn(k) > 0.0:
            cost = self._off_chord(k)
            if cost <= self.within:
                heapq.heappush(self.heap, (cost, k, self.stamp[k], False))
        elif self._turn(self.next[k]) <= 0.0:
            meeting = self._meeting(k)
            if meeting is not None:
                cost = self._off_meeting(k, meeting)
                if cost <= self.within:
                    heapq.heappush(self.heap, (cost, k, self.stamp[k], True))

    def _turn(self, k: int) -> float:
        """Above 0: the corner points away from the safe side."""
        (ax, ay), (bx, by), (cx, cy) = (self.at[j] for j in (self.last[k], k, self.next[k]))
        return self.sign * ((bx - ax) * (cy - by) - (by - ay) * (cx - bx))

    def _cut_corner(self, k: int) -> bool:
        before, after = self.last[k], self.next[k]
        if not self._is_free(self.at[before], self.at[k], self.at[after], (before, k, after)):
            return False
        self.dropped[before] = [*self.dropped[before], k, *self.dropped[k]]
        self.next[before], self.last[after] = after, before
        self.alive[k] = False
        for j in (before, after, self.last[before]):
            self._offer(j)
        return True

    def _drop_edge(self, k: int) -> bool:
        second = self.next[k]
        meeting = self._meeting(k)
        if meeting is None or not self._is_free(self.at[k], meeting, self.at[second], (k, second)):
            return False
        before, after = self.last[k], self.next[second]
        chain = [*self.dropped[before], k, *self.dropped[k], second, *self.dropped[second]]
        self.at[k] = meeting
        self.corners[k] = meeting
        self.next[k], self.last[after] = after, k
        self.alive[second] = False
        # Every corner that is gone belongs to the nearer one of the two edges that are left.
        first = [j for j in chain if self._off(j, before, k) <= self._off(j, k, after)]
        self.dropped[before] = first
        self.dropped[k] = [j for j in chain if j not in set(first)]
        for j in (before, k, after, self.last[before]):
            self._offer(j)
        return True

    def _is_free(
        self,
        a: tuple[float, float],
        b: tuple[float, float],
        c: tuple[float, float],
        own: tuple[int, ...],
    ) -> bool:
        """No other corner stands in the triangle or on its edges."""
        x, y = self.corners[:, 0], self.corners[:, 1]
        area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        turn = 1.0 if area >= 0.0 else -1.0
        inside = self.alive.copy()
        for (px, py), (qx, qy) in ((a, b), (b, c), (c, a)):
            inside &= turn * ((qx - px) * (y - py) - (qy - py) * (x - px)) >= 0.0
        inside[list(own)] = False
        return not inside.any()

    def _meeting(self, k: int) -> tuple[float, float] | None:
        """Where the edges before and after the one that leaves corner k meet, drawn out."""
        second = self.next[k]
        (ax, ay), (bx, by) = self.at[self.last[k]], self.at[k]
        (cx, cy), (dx, dy) = self.at[second], self.at[self.next[second]]
        ux, uy, vx, vy = bx - ax, by - ay, dx - cx, dy - cy
        cross = ux * vy - uy * vx
        if self.sign * cross >= 0.0 or self.next[self.next[second]] == self.last[k]:
            return None
        ahead = ((cx - bx) * vy - (cy - by) * vx) / cross
        behind = ((cx - bx) * uy - (cy - by) * ux) / cross
        if ahead < 0.0 or behind > 0.0:
            return None
        return bx + ahead * ux, by + ahead * uy

    def _off_chord(self, k: int) -> float:
        before, after = self.last[k], self.next[k]
        gone = [*self.dropped[before], k, *self.dropped[k]]
        return max(self._off(j, before, after) for j in gone)

    def _off_meeting(self, k: int, meeting: tuple[float, float]) -> float:
        """How far the new corner is from the stretch of the source that it stands for."""
        before, second = self.last[k], self.next[k]
        after = self.next[second]
        chain = [
            before, *self.dropped[before], k, *self.dropped[k],
            second, *self.dropped[second], after,
        ]  # fmt: skip
        places = [(float(x), float(y)) for x, y in self.source[list(dict.fromkeys(chain))]]
        return min(_distance(meeting, p, q) for p, q in pairwise(places))

    def _off(self, j: int, first: int, second: int) -> float:
        """Distance of an original corner from an edge."""
        x, y = self.source[j]
        return _distance((float(x), float(y)), self.at[first], self.at[second])


def _distance(p: tuple[float, float], a: tuple[float, float], b: tuple[float, float]) -> float:
    """Distance of a point from a segment."""
    ux, uy = b[0] - a[0], b[1] - a[1]
    square = ux * ux + uy * uy
    share = 0.0 if square == 0.0 else ((p[0] - a[0]) * ux + (p[1] - a[1]) * uy) / square
    share = min(1.0, max(0.0, share))
    return math.hypot(p[0] - a[0] - share * ux, p[1] - a[1] - share * uy)
