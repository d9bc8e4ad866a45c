"""Branch and bound for the placement that may be off by most, over the cells of the guaranteed set.

Boxes of hands, best bound first. A box is dropped where a finger misses its piece in all of it, or
where linear bounds on the distances prove that no hand of the cell in it is better than the best by
more than the gap; else it is halved where its fingers move most. Our own. [docs/theory.md, Sec. 11]
"""

# pyright: basic
from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from icage.kernels.compiled import compiled, compiled_borrowing
from icage.kernels.storage import heap_pop, heap_push, longer
from icage.placing.kernels.boxes import (
    EACH,
    bend,
    clearance,
    displacement,
    distance_rows,
    in_cell,
    misses_cell,
    piece_rows,
)
from icage.placing.kernels.edges import NearEdges
from icage.placing.kernels.polish import capped, level_row, polish
from icage.placing.kernels.program import most_of_least, new_program

_BENT = 0.5
"""[1] A linear program is worth its time if the hands of a box bend its rows by less than this
share of how far its fingers get."""

_OUT = 1e-13
"""[diameter] A finger no further out of its piece than this is in it: rounding."""

_GAIN = 1.02
"""[1] A hand this much better than the one polished last is polished at once."""


class Asked(NamedTuple):
    """What is asked, in the frame of the pieces.

    Attributes
    ----------
    arm:
        (fingers, 2) of the unit hand, from the middle of its fingers.
    edges, near:
        Of the true outline, and which of them are near each piece.
    radius, size:
        [unit] Of the fingers; diameter of the object.
    least, top:
        [unit] Sizes that the hand may have.
    level, share:
        [unit] The level of the set; [1] how much of the way up to it the fingers may be off, 0 if
        the opening does not err: the radius of the least circle round the unit hand.
    gap, floor:
        [1] By how much the bound may exceed the best; [unit] a tolerance that counts as none.
    """

    arm: np.ndarray
    edges: np.ndarray
    near: NearEdges
    radius: float
    size: float
    least: float
    top: float
    level: float
    share: float
    gap: float
    floor: float


class Room(NamedTuple):
    """Small arrays that are written again and again."""

    middle: np.ndarray
    half: np.ndarray
    other: np.ndarray
    finger: np.ndarray
    pick: np.ndarray


class Deepest(NamedTuple):
    """The best hand (4,), its tolerance (-inf: none), what bounds all others, boxes looked at."""

    hand: np.ndarray
    value: float
    bound: float
    boxes: int


@compiled_borrowing
def _support(pieces, k, x, y):
    """How far a piece reaches along a vector."""
    most = -np.inf
    for s in range(pieces.ptr[k], pieces.ptr[k + 1]):
        v = pieces.slot_vertex[s]
        most = max(most, x * pieces.x[v] + y * pieces.y[v])
    return most


@compiled_borrowing
def _root(pieces, z, cell, asked, least, middle, half):
    """The box around all hands of a cell of the sizes asked for; False if there are none."""
    top = asked.top
    x_low = -top
    x_high = top
    y_low = -top
    y_high = top
    for i in range(len(z)):
        for j in range(i + 1, len(z)):
            s_x = z[j, 0] - z[i, 0]
            s_y = z[j, 1] - z[i, 1]
            square = s_x * s_x + s_y * s_y
            # w = (f_j - f_i) / s, so u . w = v . (f_j - f_i) with v = u / conj(s)
            for turn in range(4):
                u_x = 1.0 if turn == 0 else -1.0 if turn == 2 else 0.0
                u_y = 1.0 if turn == 1 else -1.0 if turn == 3 else 0.0
                v_x = (u_x * s_x - u_y * s_y) / square
                v_y = (u_y * s_x + u_x * s_y) / square
                most = _support(pieces, cell[j], v_x, v_y) + _support(pieces, cell[i], -v_x, -v_y)
                if turn == 0:
                    x_high = min(x_high, most)
                elif turn == 1:
                    y_high = min(y_high, most)
                elif turn == 2:
                    x_low = max(x_low, -most)
                else:
                    y_low = max(y_low, -most)
    if x_low > x_high or y_low > y_high:
        return False
    near_x = max(0.0, x_low, -x_high)
    near_y = max(0.0, y_low, -y_high)
    low = max(least, np.hypot(near_x, near_y))
    high = min(top, np.hypot(max(abs(x_low), abs(x_high)), max(abs(y_low), abs(y_high))))
    if low > high:
        return False
    middle[3] = 0.5 * (low + high)
    half[3] = 0.5 * (high - low)
    if near_x == 0.0 and near_y == 0.0:
        middle[2] = 0.0
        half[2] = math.pi
    else:
        middle[2] = math.atan2(0.5 * (y_low + y_high), 0.5 * (x_low + x_high))
        half[2] = 0.0
        for corner in range(4):
            x = x_low if corner < 2 else x_high
            y = y_low if corner % 2 == 0 else y_high
            turn = math.atan2(y, x) - middle[2]
            turn -= 2.0 * math.pi * math.floor(turn / (2.0 * math.pi) + 0.5)
            half[2] = max(half[2], abs(turn))
    for axis in range(2):
        u_x = 1.0 if axis == 0 else 0.0
        mean_low = 0.0
        mean_high = 0.0
        tight_low = -np.inf
        tight_high = np.inf
        for k in range(len(z)):
            top_k = _support(pieces, cell[k], u_x, 1.0 - u_x)
            bottom_k = -_support(pieces, cell[k], -u_x, u_x - 1.0)
            arm = high * np.hypot(asked.arm[k, 0], asked.arm[k, 1])
            mean_low += bottom_k / len(z)
            mean_high += top_k / len(z)
            tight_low = max(tight_low, bottom_k - arm)
            tight_high = min(tight_high, top_k + arm)
        begin = max(mean_low, tight_low)
        end = min(mean_high, tight_high)
        if begin > end:
            return False
        middle[axis] = 0.5 * (begin + end)
        half[axis] = 0.5 * (end - begin)
    return True


@compiled_borrowing
def _widest(arm, middle, half):
    """The coordinate along which a finger gets furthest in a box."""
    longest = 0.0
    for k in range(len(arm)):
        longest = max(longest, np.hypot(arm[k, 0], arm[k, 1]))
    best = 0
    far = half[0]
    if half[1] > far:
        best = 1
        far = half[1]
    if longest * (middle[3] + half[3]) * half[2] > far:
        best = 2
        far = longest * (middle[3] + half[3]) * half[2]
    if longest * half[3] > far:
        best = 3
    return best


@compiled
def deepest(pieces, z, cells, least, asked, limit):
    """The best placement in cells (n, 3) of hands no smaller than ``least`` (n,), and a bound.

    No more than ``limit`` boxes are looked at; what is left then is in the bound.
    """
    fingers = len(z)
    sides = 0
    for k in range(len(pieces.ptr) - 1):
        sides = max(sides, pieces.ptr[k + 1] - pieces.ptr[k])
    program = new_program(fingers * (EACH + sides) + 1)
    room = Room(np.empty(4), np.empty(4), np.empty(4), np.empty(4), np.empty((EACH, 2)))
    every = np.full(fingers, len(pieces.ptr) - 1, np.int64)
    middle, half = np.empty(4), np.empty(4)
    boxes = np.empty((256, 8))
    of_cell = np.empty((256, 1), np.int64)
    heap_value = np.empty((256, 1))
    heap_item = np.empty((256, 1), np.int64)
    free = np.empty((256, 1), np.int64)
    n_free = 0
    n_boxes = 0
    n_heap = 0
    hand = np.zeros(4)
    value = -np.inf
    polished = -np.inf
    dropped = -np.inf
    looked = 0
    row = 0
    parent = np.inf
    cell = cells[0]
    axis = -1
    begin = np.empty(8)
    while True:
        # the next boxes: the roots one by one, then the halves of the box with the largest bound
        if row < len(cells):
            cell = cells[row]
            at_cell = row
            parent = np.inf
            for k in range(fingers):
                parent = min(parent, asked.near.most[cell[k]] - asked.radius)
            parts = 1
            if not _root(pieces, z, cell, asked, least[row], middle, half):
                parts = 0
            row += 1
        else:
            if n_heap == 0 or looked >= limit:
                break
            bar = max(asked.floor, value * (1.0 + asked.gap))
            parent = -heap_value[0, 0]
            if parent <= bar:
                break
            item = heap_item[0, 0]
            heap_pop(heap_value[:, 0], heap_item[:, 0], n_heap)
            n_heap -= 1
            for j in range(8):
                begin[j] = boxes[item, j]
            free[n_free, 0] = item
            n_free += 1
            at_cell = of_cell[item, 0]
            cell = cells[at_cell]
            for j in range(4):
                middle[j] = begin[j]
                half[j] = begin[4 + j]
            axis = _widest(asked.arm, middle, half)
            half[axis] *= 0.5
            middle[axis] -= half[axis]
            parts = 2
        for part in range(parts):
            if part == 1:
                for j in range(4):
                    middle[j] = begin[j]
                middle[axis] += half[axis]
            looked += 1
            if misses_cell(pieces, cell, asked.arm, middle, half, room.finger):
                continue
            bar = max(asked.floor, value * (1.0 + asked.gap))
            bound = min(parent, capped(np.inf, middle[3] - half[3], asked.level, asked.share))
            reach = 0.0
            bent = 0.0
            for k in range(fingers):
                reach = max(reach, displacement(asked.arm, k, middle, half))
                bent = max(bent, bend(asked.arm, k, middle, half))
            clear = clearance(
                asked.edges, asked.near, cell, asked.arm, asked.radius, middle, room.finger
            )
            bound = min(bound, clear + reach)
            if bound <= bar:
                dropped = max(dropped, bound)
                continue
            tries = 1
            if bent <= _BENT * reach:
                rows = distance_rows(
                    program, 0, asked.edges, asked.near, cell, asked.arm, asked.radius, middle,
                    half, False, room.finger, room.pick,
                )  # fmt: skip
                if asked.share > 0.0:
                    rows = level_row(program, rows, asked.level, asked.share, middle, half)
                rows = piece_rows(program, rows, pieces, cell, asked.arm, middle, half, room.finger)
                bound = min(bound, most_of_least(program, rows, bar))
                tries = 2
            # the middle of the box, and where the linear bounds would have the best hand
            for attempt in range(tries):
                if bound <= bar and attempt == 1:
                    break
                for j in range(4):
                    room.other[j] = middle[j]
                    if attempt == 1:
                        room.other[j] += half[j] * program.at[j]
                room.other[3] = min(asked.top, max(least[at_cell], room.other[3]))
                if not in_cell(pieces, cell, asked.arm, room.other, room.finger, _OUT * asked.size):
                    continue
                found = clearance(
                    asked.edges, asked.near, cell, asked.arm, asked.radius, room.other, room.finger
                )
                found = capped(found, room.other[3], asked.level, asked.share)
                if found > value:
                    value = found
                    for j in range(4):
                        hand[j] = room.other[j]
            if value > asked.floor and value > polished * _GAIN:
                value = polish(asked, every, hand, value, program, room)
                polished = value
            bar = max(asked.floor, value * (1.0 + asked.gap))
            if bound <= bar:
                dropped = max(dropped, bound)
                continue
            if n_free > 0:
                n_free -= 1
                item = free[n_free, 0]
            else:
                if n_boxes == len(boxes):
                    boxes = longer(boxes)
                    of_cell = longer(of_cell)
                    free = longer(free)
                    heap_value = longer(heap_value)
                    heap_item = longer(heap_item)
                item = n_boxes
                n_boxes += 1
            for j in range(4):
                boxes[item, j] = middle[j]
                boxes[item, 4 + j] = half[j]
            of_cell[item, 0] = at_cell
            heap_push(heap_value[:, 0], heap_item[:, 0], n_heap, -bound, item)
            n_heap += 1
    if value > asked.floor:
        value = polish(asked, every, hand, value, program, room)
    if n_heap > 0:
        dropped = max(dropped, -heap_value[0, 0])
    return Deepest(hand, value, max(value, dropped), looked)
