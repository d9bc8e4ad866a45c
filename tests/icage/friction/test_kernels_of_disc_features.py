"""What disc fingers touch, their hands, and how arcs are halved: against points drawn."""

from __future__ import annotations

import math

import numpy as np
import pytest

from icage.friction.disc_contacts import DiscContacts
from icage.friction.kernels.disc_features import EDGE
from icage.friction.kernels.disc_halving import _away, _room_for, halved
from icage.friction.kernels.disc_hands import (
    COLUMNS,
    OUTSIDE,
    _held_off,
    hands_on,
    place_of,
    sagitta,
    slack_of,
)
from icage.friction.kernels.disc_jams import _room
from tests.icage.friction.drawn_discs import RADIUS, contacts
from tests.icage.friction.flat_polygons import ROOM, Flat, fingers_of
from tests.icage.friction.square_pieces import piece_of, square_pieces
from tests.icage.friction.test_cones_of_forces import Z
from tests.oracles.geometry import Floats

pytestmark = pytest.mark.usefixtures("plain")


def test_an_arc_stands_as_its_chord_and_is_no_further_off_than_its_sagitta() -> None:
    rng = np.random.default_rng(1)
    which = contacts(rng)
    state = np.full(COLUMNS, -1.0)
    state[:2] = 0.9, 0.4
    place = np.empty(4)
    for feature in (0, 1):
        place_of(which, feature, state, place)
        assert place.tolist() == which.place[feature].tolist()
        assert sagitta(which, feature, state) == 0.0
    place_of(which, 2, state, place)
    centre = complex(*which.place[2, :2])
    start, side = complex(*place[:2]), complex(*place[2:])
    arc = centre + RADIUS * np.exp(1j * np.linspace(0.5, 1.3, 201))
    assert (start, start + side) == pytest.approx((arc[0], arc[-1]))
    height = np.abs(((arc - start) * np.conj(side / abs(side))).imag)
    assert height.max() == pytest.approx(sagitta(which, 2, state), rel=1e-6)


def test_hands_on_true_arcs_are_off_by_no_more_than_the_slack() -> None:
    """Two fingers anywhere on their arcs against the same shares of the chords."""
    rng = np.random.default_rng(2)
    for _ in range(10):
        which = contacts(rng)
        finger = rng.permutation(3)[:2]
        chosen = np.array([2, 3]) if rng.random() < 0.5 else np.array([3, 0])
        state = np.full((3, COLUMNS), np.nan)
        state[finger, :2] = which.angle[chosen]
        slack = slack_of(Z, finger, chosen, which, state)
        sags = [sagitta(which, f, state[i]) for i, f in zip(finger, chosen, strict=True)]
        assert slack.sag == pytest.approx(sum(sags))
        z = Z @ [1.0, 1j]
        gap = abs(z[finger[1]] - z[finger[0]])
        assert slack.w == pytest.approx(slack.sag / gap)
        off = np.array([1.0, 1j, -1.0, -1j])
        worst = 0.0
        for first in off * sags[0]:
            for second in off * sags[1]:
                w = (second - first) / (z[finger[1]] - z[finger[0]])
                d = first - w * z[finger[0]]
                worst = max(worst, np.abs(d + w * z).max())
        assert worst <= slack.shift * (1.0 + 1e-9)
        assert worst >= 0.4 * slack.shift


def test_a_finger_is_held_off_an_arc_in_a_range_of_directions() -> None:
    rng = np.random.default_rng(3)
    for trial in range(8):
        which, k, v = contacts(rng), trial % OUTSIDE, trial % 3
        middle, half = float(rng.uniform(-3, 3)), float(rng.uniform(0.2, 1.4))
        state = np.full(COLUMNS, -1.0)
        state[2 + 3 * k : 5 + 3 * k] = v, middle, half
        flat = Flat.drawn(rng, np.array([0.0, 0.0, 1e-3, 0.0]), 1.0)
        z = Z[trial % 3]
        about = which.apex[v] + RADIUS * np.array([np.cos(middle), np.sin(middle)])
        at = fingers_of(flat.middle[None], z[None])[0, 0]
        flat.middle[:2] += about - [at.real, at.imag]
        polygon = flat.room()
        n = _held_off(
            z, which, state, k, 1e-9, np.empty(5), polygon, len(flat.inside), np.empty((ROOM, 4))
        )
        hands = flat.hands(rng, 200)
        way = fingers_of(hands, z[None])[:, 0] - complex(*which.apex[v])
        turn = np.abs(np.angle(way * np.exp(-1j * middle)))
        ahead = (way * np.exp(-1j * middle)).real - RADIUS * math.cos(half)
        gap = np.minimum(np.abs(way) * np.sin(half - turn), ahead)
        gap[turn > half + 0.5 * np.pi] = -1.0
        assert (gap > 0.0).any()
        assert (gap < 0.0).any()
        for hand, value in zip(hands, gap, strict=True):
            if abs(value) > 1e-6:
                assert flat.holds(polygon[:n], hand) == (value > 0.0)


def test_hands_of_two_discs_are_in_their_pieces_and_on_their_features() -> None:
    """Two fingers on opposite sides of the square, the third in its piece, or on a side too."""
    pieces, origin = square_pieces()
    rng = np.random.default_rng(5)
    z = Z @ [1.0, 1j]
    sides = np.array([[0, -RADIUS, 1, 0], [1 + RADIUS, 0, 0, 1], [0, 1 + RADIUS, 1, 0]], float)
    sides[:, :2] -= origin
    none = np.empty(0, np.int64)
    which = DiscContacts(
        ptr=none, which=none, kind=np.array([EDGE, EDGE, EDGE]), place=sides,
        angle=np.zeros((3, 2)), apex=np.array([[0.0, 0.0]]) - origin, radius=RADIUS,
    )  # fmt: skip
    x, y = np.array(pieces.x), np.array(pieces.y)
    seen = [0, 0]
    for trial in range(60):
        finger, chosen = np.array([0, 1, 2]), rng.permutation(3)
        count = int(rng.integers(2, 4))
        share = rng.random((300, 2))
        p, q = sides[chosen[0]], sides[chosen[1]]
        one = (p[0] + share[:, 0] * p[2]) + 1j * (p[1] + share[:, 0] * p[3])
        two = (q[0] + share[:, 1] * q[2]) + 1j * (q[1] + share[:, 1] * q[3])
        w = (two - one) / (z[1] - z[0])
        at = (one - w * z[0])[:, None] + w[:, None] * z
        cell = np.array([piece_of(pieces, p) for p in at[0]])
        if trial % 2:
            cell[2] = rng.integers(0, len(pieces.ptr) - 1)
        state = np.full((3, COLUMNS), -1.0)
        slack = slack_of(Z, finger, chosen, which, state)
        assert slack.sag == slack.shift == 0.0
        room = _room(3)
        thick = 0.05
        n = hands_on(pieces, Z, cell, finger, chosen, count, which, state, slack, thick, room)
        gap = np.full(300, np.inf)
        for f in range(3):
            for s in range(pieces.ptr[cell[f]], pieces.ptr[cell[f] + 1]):
                v = pieces.slot_vertex[s]
                inner = pieces.normal_x[s] * (at[:, f].real - x[v])
                gap = np.minimum(gap, inner + pieces.normal_y[s] * (at[:, f].imag - y[v]) + thick)
        if count == 3:
            r = sides[chosen[2]]
            along = (at[:, 2] - complex(*r[:2])) * np.conj(complex(*r[2:]))
            own = 0.02 * thick
            gap = np.minimum(gap, own - np.abs(along.imag))
            gap = np.minimum(gap, np.minimum(along.real + own, 1.0 + own - along.real))
        seen[int(gap.max() > 1e-6)] += 1
        assert (n > 0) or gap.max() < 1e-6
        if n == 0:
            continue
        hands = np.column_stack([(one - w * z[0]).real, (one - w * z[0]).imag, w.real, w.imag])
        corners = room.polygon[:n]
        for hand, value in zip(hands[:40], gap[:40], strict=True):
            plane = Flat(share[:3], hands[0], np.array([hands[1] - hands[0], hands[2] - hands[0]]))
            ring = (corners - hands[0]) @ np.linalg.pinv(plane.axes)
            turn = np.sum(
                ring[:, 0] * np.roll(ring[:, 1], -1) - ring[:, 1] * np.roll(ring[:, 0], -1)
            )
            if abs(value) > 1e-6 and abs(turn) > 1e-9:
                assert plane.holds(corners[:: int(np.sign(turn))], hand, 1e-8) == (value > 0.0)
    assert min(seen) >= 5


def asked_halving(which: DiscContacts, state: Floats, point: Floats, subset: list[bool]) -> tuple:
    pieces, _ = square_pieces()
    finger = np.flatnonzero(subset)
    chosen = np.array([2, 3])[: len(finger)]
    child = np.full((2, 3, COLUMNS), np.nan)
    cell = np.zeros(3, np.int64)
    done = halved(
        pieces, Z, cell, np.array(subset), chosen, finger, len(finger), which, state.copy(), point,
        1e-9, child,
    )  # fmt: skip
    return done, child


def test_the_longest_part_of_an_arc_is_halved() -> None:
    which = contacts(np.random.default_rng(6))
    state = np.full((3, COLUMNS), -1.0)
    state[0, :2], state[1, :2] = (0.3, 0.05), (2.0, 0.12)
    away = np.array([50.0, 50.0, 1.0, 0.0])
    for swap in (False, True):
        done, child = asked_halving(which, state, away, [True, True, False])
        row = 0 if swap else 1
        assert done
        for k, sign in enumerate((-1.0, 1.0)):
            known = state.copy()
            known[row, 0] += sign * 0.5 * state[row, 1]
            known[row, 1] = 0.5 * state[row, 1]
            assert child[k] == pytest.approx(known)
        state[0, :2], state[1, :2] = state[1, :2].copy(), state[0, :2].copy()
    state[:2, 1] = 1e-10
    assert not asked_halving(which, state, away, [True, True, False])[0]
    state[:2, 1] = 0.1
    which.kind[:] = EDGE
    assert not asked_halving(which, state, away, [True, True, False])[0]


def test_a_free_finger_in_an_arc_is_held_off_its_vertex_first() -> None:
    which = contacts(np.random.default_rng(7))
    which.apex[:] = [[9.0, 9.0], [0.5, 0.5], [0.5, 0.6]]
    state = np.full((3, COLUMNS), -1.0)
    state[:2, :2] = [[0.3, 0.1], [2.0, 0.12]]
    z = Z[2]
    point = np.array([0.5 - z[0] + z[1], 0.52 - z[1] - z[0], 1.0, 1.0])  # finger 3 at (0.5, 0.52)
    done, child = asked_halving(which, state, point, [True, True, False])
    assert done
    middle = [child[k, 2, 3] for k in range(2)]
    assert child[:, 2, 2].tolist() == [1.0, 1.0]  # the vertex it is deepest in
    assert child[:, 2, 4].tolist() == [0.25 * np.pi] * 2
    pieces, _ = square_pieces()
    away = _away(pieces, 0, which.apex[1])
    assert middle == pytest.approx([away - 0.25 * np.pi, away + 0.25 * np.pi])
    assert child[0, :2].tolist() == state[:2].tolist()
    again, grandchild = asked_halving(which, child[0], point, [True, True, False])
    assert again
    assert grandchild[0, 2, 2:5].tolist() == pytest.approx([1.0, middle[0] - np.pi / 8, np.pi / 8])
    # no deeper in the vertex than the arc is long: the arc
    shallow = point + [0.0, -0.02 - RADIUS + 0.01, 0.0, 0.0]
    _, child = asked_halving(which, state, shallow, [True, True, False])
    assert child[0, 1, 1] == 0.06
    # a finger that touches is on its own feature
    _, child = asked_halving(which, state, point, [False, True, True])
    fingers = fingers_of(point[None], Z)[0]
    assert min(abs(fingers[0] - complex(*a)) for a in which.apex) > RADIUS
    assert child[:, 2, 2].tolist() == [-1.0, -1.0]


def test_the_direction_away_from_a_vertex_faces_the_whole_piece() -> None:
    pieces, origin = square_pieces()
    apex = np.array([0.5, 0.5]) - origin
    for k in range(len(pieces.ptr) - 1):
        slots = pieces.slot_vertex[pieces.ptr[k] : pieces.ptr[k + 1]]
        angle = _away(pieces, k, apex)
        corners = np.column_stack([pieces.x[slots], pieces.y[slots]]) - apex
        assert (corners @ [math.cos(angle), math.sin(angle)]).min() > 0.0


def test_a_free_finger_is_held_off_three_vertices_at_most() -> None:
    state = np.full(COLUMNS, -1.0)
    assert _room_for(state, 4) == 0
    state[2:5] = 4.0, 0.3, 0.5
    assert (_room_for(state, 4), _room_for(state, 0)) == (0, 1)
    state[4] = 1e-6
    assert (_room_for(state, 4), _room_for(state, 0)) == (-1, 1)
    state[5:11] = 0.0, 0.1, 0.2, 7.0, 0.1, 0.2
    assert (_room_for(state, 0), _room_for(state, 7), _room_for(state, 1)) == (1, 2, -1)
