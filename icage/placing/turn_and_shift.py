"""How far a hand may be shifted while it may also be turned: exact, for one placement.

Turn the hand about the middle of its fingers by any angle of [-t, t], and shift it by any vector
no longer than s. No finger then meets the object if and only if the arcs on which the turns carry
the fingers keep s away from it (from the disc's edge). The size does not change on the way, so that
the hand stays in its component. Our own. [docs/theory.md, Sec. 11]
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from icage.arrays import BoolArray, ComplexArray, FloatArray, read_only
from icage.checks import a_number

_HALVINGS = 100
"""Of the angle that is searched: more than a double has digits."""

POINTS = 65
"""On a curve that is drawn or written."""


@dataclass(frozen=True, slots=True)
class TurnAndShift:
    """The turns about ``pivot`` and the shifts that a hand on ``fingers`` bears together.

    ``ring`` (n, 2) is the object's outline, ``fingers`` (f, 2) the finger centres, ``radius``
    that of their discs; all in one frame.
    """

    ring: FloatArray
    fingers: FloatArray
    radius: float

    @property
    def pivot(self) -> FloatArray:
        """(2,) the middle of the fingers."""
        return self.fingers.mean(axis=0)

    def shift_at(self, turn: float) -> float:
        """The length of shift that is borne in every direction, with every turn up to ``turn``.

        [rad] and [unit]; exact up to rounding: arcs and edges are nearest at their ends, where an
        edge's normal meets the pivot, or where a corner lies on the ray of a finger.

        Raises
        ------
        InputError:
            The turn is no finite number.
        """
        turn = a_number(turn, "turn")
        return max(0.0, self._clear_of_arcs(min(abs(turn), math.pi)) - self.radius)

    @property
    def shift(self) -> float:
        """The shift that is borne without a turn."""
        return self.shift_at(0.0)

    def turn_at(self, shift: float) -> float:
        """[rad] The turn either way that is borne with every shift up to ``shift``; pi: any."""
        shift = a_number(shift, "shift")
        if self.shift_at(math.pi) >= shift and self.shift_at(math.pi) > 0.0:
            return math.pi
        low, high = 0.0, math.pi
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            room = self.shift_at(middle)
            if room >= shift and room > 0.0:
                low = middle
            else:
                high = middle
        return low

    @property
    def turn(self) -> float:
        """[rad] The turn either way that is borne without a shift."""
        return self.turn_at(0.0)

    def curve(self, points: int = POINTS) -> FloatArray:
        """(points, 2) = turn [rad], shift: from no turn to the most."""
        turns = np.linspace(0.0, self.turn, points)
        rows = np.array([(turn, self.shift_at(turn)) for turn in turns.tolist()])
        if self.turn < math.pi:
            rows[-1, 1] = 0.0
        return read_only(rows)

    def within_tolerance(self, tolerance: float, turn: float) -> float:
        """The shift that the tolerance of the fingers alone promises together with a turn."""
        arm = float(np.hypot(*(self.fingers - self.pivot).T).max())
        return max(0.0, tolerance - arm * 2.0 * math.sin(0.5 * min(abs(turn), math.pi)))

    def _clear_of_arcs(self, turn: float) -> float:
        """Least distance of the outline from the arcs of all fingers; 0 where one crosses it."""
        v, f = _complex(self.ring - self.pivot), _complex(self.fingers - self.pivot)
        side = np.roll(v, -1) - v
        v, side = v[side != 0.0], side[side != 0.0]
        length = np.abs(side)
        e = side / length
        least = np.inf
        for finger in f.tolist():
            arm, at = abs(finger), np.angle(finger)
            ends = finger * np.exp(np.array([-1j, 1j]) * turn)
            least = min(least, *(_from_edges(v, e, length, end) for end in ends.tolist()))
            corner = np.abs(np.abs(v) - arm)
            least = min(least, float(corner[_within(np.angle(v) - at, turn)].min(initial=np.inf)))
            # along the normal from the pivot: the foot has to lie on the edge
            foot = v - e * np.real(v * np.conj(e))
            along = -np.real(v * np.conj(e))
            over = (along >= 0.0) & (along <= length)
            height = np.abs(foot)
            normal = np.where(height > 0.0, np.angle(foot), np.angle(1j * e))
            for way in (0.0, math.pi):
                on = over & _within(normal + way - at, turn)
                near = np.abs(arm * math.cos(way) - height)
                least = min(least, float(near[on].min(initial=np.inf)))
            # an arc that crosses an edge
            half = np.sqrt(np.maximum(arm * arm - height * height, 0.0))
            for sign in (-1.0, 1.0):
                on = (
                    (height <= arm) & (along + sign * half >= 0.0) & (along + sign * half <= length)
                )
                if np.any(on & _within(np.angle(foot + sign * half * e) - at, turn)):
                    return 0.0
        return least


def _complex(points: FloatArray) -> ComplexArray:
    """Points (n, 2) as complex numbers."""
    return points[:, 0] + 1j * points[:, 1]


def _from_edges(v: ComplexArray, e: ComplexArray, length: FloatArray, point: complex) -> float:
    """Least distance of a point from the edges."""
    gap = (point - v) * np.conj(e)
    beyond = np.maximum(0.0, np.maximum(-gap.real, gap.real - length))
    return float(np.hypot(gap.imag, beyond).min())


def _within(angle: FloatArray, turn: float) -> BoolArray:
    """Which angles, brought to [-pi, pi), are in [-turn, turn]."""
    inside: BoolArray = np.abs((angle + math.pi) % (2.0 * math.pi) - math.pi) <= turn
    return inside
