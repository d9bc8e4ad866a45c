"""Where an escape path lets the object go, and the least gap of the fingers before that. Our own.

The object is free of a hand where one of two straight ways is open to the end. Either the object
goes off in a straight line while the hand stands still: no finger's ray in the opposite direction
enters it. Or the hand shrinks to a point as it stands: every finger moves straight to one common
point, none enters the object, sigma only falls, and a hand that is a point holds nothing. Both hold
where a line separates object and hand; neither needs it, for a hand may reach into a pocket.
"""

from __future__ import annotations

import numpy as np
import shapely

from icage.arrays import BoolArray, FloatArray
from icage.hand import HandShape
from icage.outline import Outline
from icage.tolerance import COLLISION, PINCHED

_ANGLE = 1e-9
"""[rad] A ray this close to the object's rim touches it, which is free."""

_NOTHING = 1e-300
"""[unit] Keeps a point finger on a vertex from dividing 0 by 0."""


def corners_before_pinch(corners: list[complex], size: float) -> int:
    """How many of these w = sigma e^{i theta} [unit] come before the hand is pinched; at least 1.

    ``size`` is the object's diameter, [unit].
    """
    count = len(corners)
    while count > 1 and abs(corners[count - 1]) <= PINCHED * size:
        count -= 1
    return count


def least_gap_on(hand: HandShape, path: FloatArray) -> float:
    """Least distance of two finger centres on a path (k, 4) before its last segment, [unit]."""
    w = path[:-1, 3] * np.exp(1j * path[:-1, 2])
    return hand.least_gap(w.tolist())


def free_from(outline: Outline, hand: HandShape, radius: float, path: FloatArray) -> int:
    """First row of an escape path (k, 4) at which the object is free of the hand as it stands.

    That is certain at the row given, and from some way between two rows it may be so a little
    before. It is never later than the last row but one, from which the path itself shrinks the
    hand to a point.
    """
    fingers = hand.fingers(path)
    free = _goes_off_straight(outline, radius, fingers) | _shrinks(outline, radius, path, fingers)
    free[-2:] = True
    return int(np.argmax(free))


def _goes_off_straight(outline: Outline, radius: float, fingers: FloatArray) -> BoolArray:
    """Which hands (k, m, 2) leave a direction in which no finger's ray meets the object, (k,).

    What a finger outside a polygon sees of it is one range of directions, and the closed ranges
    that remain for all fingers have a common direction only if an end of one is among them.
    """
    low, high = _blocked(outline, radius, fingers)
    ends = np.concatenate([low, high], axis=1)
    past = (ends[:, :, None] - low[:, None, :]) % (2.0 * np.pi)
    wide = (high - low)[:, None, :]
    clear = (past >= wide - _ANGLE) | (past <= _ANGLE) | (past >= 2.0 * np.pi - _ANGLE)
    return np.asarray(np.any(np.all(clear & (wide <= 2.0 * np.pi), axis=2), axis=1))


def _blocked(outline: Outline, radius: float, fingers: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Ends (k, m) of the range of directions, [rad], that the object blocks for each finger.

    The directions of the vertices followed round the boundary; a disc also loses what it would
    graze. A range of 2 pi or more leaves nothing: the finger is in a pocket.
    """
    slack = COLLISION * outline.diameter
    off = outline.vertices - fingers[:, :, None, :]
    ahead = np.roll(off, -1, axis=2)
    cross = off[..., 0] * ahead[..., 1] - off[..., 1] * ahead[..., 0]
    turn = np.arctan2(cross, (off * ahead).sum(axis=-1))
    # A finger that touches an edge sees it turn clockwise, as from outside, whatever the rounding.
    side = np.hypot(*np.moveaxis(ahead - off, -1, 0))
    turn = np.where(np.abs(cross) <= slack * side, -np.abs(turn), turn)
    away = np.hypot(off[..., 0], off[..., 1])
    at = away <= slack  # at a vertex: from its one neighbour to the other, through the object
    before = np.roll(off, 1, axis=2)
    inside = np.arctan2(before[..., 1], before[..., 0]) - np.arctan2(ahead[..., 1], ahead[..., 0])
    turn = np.where(at, -(inside % (2.0 * np.pi)), turn)
    turn = np.where(np.roll(at, -1, axis=2), 0.0, turn)
    first = np.arctan2(off[..., 0, 1], off[..., 0, 0])
    first = np.where(at[..., 0], np.arctan2(before[..., 0, 1], before[..., 0, 0]), first)
    angle = first[..., None] + np.concatenate(
        [np.zeros_like(first)[..., None], np.cumsum(turn, axis=-1)[..., :-1]], axis=-1
    )
    graze = np.arcsin(np.clip(radius / np.maximum(away, radius + _NOTHING), 0.0, 1.0))
    return (angle - graze).min(axis=-1), (angle + graze).max(axis=-1)


def _shrinks(outline: Outline, radius: float, path: FloatArray, fingers: FloatArray) -> BoolArray:
    """Which hands (k, m, 2) can shrink to one of their fingers, or to the path's end, (k,)."""
    origin = outline.vertices[0]
    body = shapely.Polygon(outline.vertices - origin)
    slack = COLLISION * outline.diameter
    end = np.broadcast_to(path[-1, :2], (len(path), 1, 2))
    towards = np.concatenate([fingers, end], axis=1) - origin
    ways = np.empty((*towards.shape[:2], fingers.shape[1], 2, 2))
    ways[..., 0, :] = fingers[:, None] - origin
    ways[..., 1, :] = towards[:, :, None]
    lines = shapely.linestrings(ways)
    if radius > 0.0:
        clear = shapely.distance(lines, body) >= radius - slack
    else:
        core = body.buffer(-slack, join_style="mitre")
        shapely.prepare(core)
        clear = ~shapely.intersects(core, lines)
    return np.asarray(np.any(np.all(clear, axis=2), axis=1))
