"""How much clearance the hands of a box can have: linear bounds on distances from above.

A hand is (m_x, m_y, theta, sigma): the middle of its fingers, direction and size, so that finger k
is at m + sigma e^{i theta} a_k with its arm a_k = z_k - mean z. A box is its middle and four
half widths. The distance to an edge is at most that to its line or to one of its points, plus what
the box adds to that; both are linear in the finger up to the square of its displacement.
[docs/theory.md, Sec. 11]
"""

# pyright: basic
from __future__ import annotations

import math

import numpy as np

from icage.kernels.compiled import compiled_borrowing
from icage.kernels.locate import holds
from icage.placing.kernels.edges import AX, AY, LENGTH, TX, TY, distance_to_edge, nearest

EACH = 6
"""Edges looked at for one finger, the nearest ones."""


@compiled_borrowing
def place_finger(arm, k, hand, out):
    """Finger k of a hand (4,), as out (2,), and its arm turned and not scaled, as out[2:4]."""
    c = math.cos(hand[2])
    s = math.sin(hand[2])
    out[2] = c * arm[k, 0] - s * arm[k, 1]
    out[3] = s * arm[k, 0] + c * arm[k, 1]
    out[0] = hand[0] + hand[3] * out[2]
    out[1] = hand[1] + hand[3] * out[3]


@compiled_borrowing
def displacement(arm, k, middle, half):
    """How far finger k gets from its place in the middle of a box, at most."""
    length = np.hypot(arm[k, 0], arm[k, 1])
    turn = middle[3] * 2.0 * math.sin(0.5 * min(half[2], math.pi))
    return np.hypot(half[0], half[1]) + length * (turn + half[3])


@compiled_borrowing
def bend(arm, k, middle, half):
    """How far finger k gets from where a linear function of the hand has it."""
    length = np.hypot(arm[k, 0], arm[k, 1])
    return length * (0.5 * middle[3] * half[2] * half[2] + half[3] * half[2])


@compiled_borrowing
def clearance(edges, near, cell, arm, radius, hand, finger):
    """Least distance of the fingers from the object, less their radius, in a cell's pieces."""
    least = np.inf
    for k in range(len(arm)):
        place_finger(arm, k, hand, finger)
        least = min(least, nearest(edges, near, cell[k], finger[0], finger[1]))
    return least - radius


@compiled_borrowing
def in_cell(pieces, cell, arm, hand, finger, slack):
    """Whether all fingers of a hand are in the pieces of a cell, or no further out than slack."""
    for k in range(len(arm)):
        place_finger(arm, k, hand, finger)
        if not holds(pieces, cell[k], finger[0], finger[1], slack):
            return False
    return True


@compiled_borrowing
def misses_cell(pieces, cell, arm, middle, half, finger):
    """Whether a finger is out of its piece in the whole box."""
    for k in range(len(arm)):
        place_finger(arm, k, middle, finger)
        reach = displacement(arm, k, middle, half)
        for s in range(pieces.ptr[cell[k]], pieces.ptr[cell[k] + 1]):
            v = pieces.slot_vertex[s]
            gap = pieces.normal_x[s] * (finger[0] - pieces.x[v])
            gap += pieces.normal_y[s] * (finger[1] - pieces.y[v])
            if gap < -reach:
                return True
    return False


@compiled_borrowing
def _row(program, rows, counts, offset, n_x, n_y, finger, middle, half):
    """A row that is linear in a finger: offset in the middle, growing along n."""
    program.counts[rows] = counts
    program.offset[rows] = offset
    program.slope[rows, 0] = n_x * half[0]
    program.slope[rows, 1] = n_y * half[1]
    program.slope[rows, 2] = (n_y * finger[2] - n_x * finger[3]) * middle[3] * half[2]
    program.slope[rows, 3] = (n_x * finger[2] + n_y * finger[3]) * half[3]


@compiled_borrowing
def piece_rows(program, rows, pieces, cell, arm, middle, half, finger):
    """Rows that keep the fingers in their pieces; returns how many rows there are then."""
    for k in range(len(arm)):
        place_finger(arm, k, middle, finger)
        more = bend(arm, k, middle, half)
        reach = displacement(arm, k, middle, half)
        for s in range(pieces.ptr[cell[k]], pieces.ptr[cell[k] + 1]):
            v = pieces.slot_vertex[s]
            n_x = pieces.normal_x[s]
            n_y = pieces.normal_y[s]
            gap = n_x * (finger[0] - pieces.x[v]) + n_y * (finger[1] - pieces.y[v])
            if gap > reach:  # holds in the whole box
                continue
            _row(program, rows, 0.0, gap + more, n_x, n_y, finger, middle, half)
            rows += 1
    return rows


@compiled_borrowing
def distance_rows(program, rows, edges, near, cell, arm, radius, middle, half, exact, finger, pick):
    """Rows that bound the distances less the radius; returns how many rows there are then.

    ``exact``: only their values and slopes in the middle of the box, for a step towards the best.
    """
    for k in range(len(arm)):
        place_finger(arm, k, middle, finger)
        reach = displacement(arm, k, middle, half)
        more = 0.0 if exact else bend(arm, k, middle, half)
        chosen = _nearest_few(edges, near, cell[k], finger, reach, pick)
        for c in range(chosen):
            at = int(pick[c, 1])
            e = near.items[at]
            gx = finger[0] - edges[e, AX]
            gy = finger[1] - edges[e, AY]
            along = gx * edges[e, TX] + gy * edges[e, TY]
            height = gx * edges[e, TY] - gy * edges[e, TX]
            foot = min(edges[e, LENGTH], max(0.0, along))
            line = _beyond_line(along, height, edges[e, LENGTH], reach, near.ahead[at])
            apart = pick[c, 0]
            point = 0.5 * reach * reach / apart if reach <= 2.0 * apart else 2.0 * (reach - apart)
            if exact:
                line = 0.0 if along == foot and height > 0.0 else np.inf
            if line <= point:
                _row(
                    program, rows, 1.0, height - radius + more + (0.0 if exact else line),
                    edges[e, TY], -edges[e, TX], finger, middle, half,
                )  # fmt: skip
            elif apart > 0.0:
                n_x = (gx - foot * edges[e, TX]) / apart
                n_y = (gy - foot * edges[e, TY]) / apart
                extra = 0.0 if exact else point
                _row(
                    program, rows, 1.0, apart - radius + more + extra, n_x, n_y, finger, middle,
                    half,
                )  # fmt: skip
            else:
                _row(program, rows, 1.0, reach - radius, 0.0, 0.0, finger, middle, half)
            rows += 1
    return rows


@compiled_borrowing
def _beyond_line(along, height, length, reach, ahead):
    """By how much the distance to an edge exceeds the height above its line, at most."""
    over = max(0.0, reach - along, along + reach - length)
    lowest = height - reach
    if lowest >= 0.0 or ahead:
        lowest = max(0.0, lowest)
        return np.hypot(lowest, over) - lowest
    return over - 2.0 * lowest


@compiled_borrowing
def _nearest_few(edges, near, piece, finger, reach, pick):
    """Fill pick (EACH, 2) with distance and index of the edges that may bound a finger's distance.

    Ordered by distance; those that are further than the nearest by twice the reach never do.
    """
    count = 0
    for at in range(near.start[piece], near.start[piece + 1]):
        apart = distance_to_edge(edges, near.items[at], finger[0], finger[1])
        if count == EACH and apart >= pick[EACH - 1, 0]:
            continue
        if count and apart > pick[0, 0] + 2.0 * reach:
            continue
        if count < EACH:
            count += 1
        b = count - 1
        while b > 0 and pick[b - 1, 0] > apart:
            pick[b, 0] = pick[b - 1, 0]
            pick[b, 1] = pick[b - 1, 1]
            b -= 1
        pick[b, 0] = apart
        pick[b, 1] = at
    while count > 1 and pick[count - 1, 0] > pick[0, 0] + 2.0 * reach:
        count -= 1
    return count
