"""Shaking, form closure and play: what holds is held, what does not is told."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from icage.geometry.contact_types import supports
from icage.outline import Outline
from sim.closing.one import close
from sim.grip.form_closure import form_closure, touches, wrench_matrix
from sim.grip.play import clearance, measure_play, opened, predicted_play
from sim.grip.shake import HELD_SHIFT, PUSH, PUSH_TIME, SHAKES, pushes, random_wrenches, shake
from tests.sim.grasps import GRASPS, KnownGrasp, l_shape, t_shape, triangle

CORNERS = {"triangle": 0, "L": 1, "T": 2, "pliers": 1, "saw": 1}


def skew() -> KnownGrasp:
    """Discs on three edges of a triangle without symmetry, at the feet of its incentre."""
    a = np.array([[0.0, 0.0], [4.0, 0.0], [1.2, 2.6]])
    outline = Outline(a)
    sides = np.hypot(*(np.roll(a, -1, axis=0) - np.roll(a, -2, axis=0)).T)
    centre = (sides[:, None] * a).sum(axis=0) / sides.sum()
    r = 0.02 * outline.diameter
    contacts = []
    for p, q in zip(a, np.roll(a, -1, axis=0), strict=True):
        along = (q - p) / np.hypot(*(q - p))
        foot = p + ((centre - p) @ along) * along
        contacts.append(foot + r * np.array([along[1], -along[0]]))
    return KnownGrasp(outline, r, np.array(contacts))


def closed(known: KnownGrasp):
    scene = known.scene()
    held = supports(known.outline, known.contacts, known.radius)
    end = close(scene, opened(held, known.contacts, 1.02)).end
    return scene, held, scene.start_positions(end.as_array())[0]


@pytest.mark.parametrize("name", sorted(CORNERS))
def test_rank_and_closure_are_those_of_the_contacts(name: str):
    known = GRASPS[name]()
    scene, held, qpos = closed(known)
    assert held.concave_corners == CORNERS[name]
    found = touches(scene, qpos)
    answer = form_closure(wrench_matrix(found.points, found.normals, qpos[3:5]))
    assert answer.agrees_with(held)
    assert (answer.rank, answer.closed) == ((3, True) if CORNERS[name] else (2, False))
    assert found.carrying == len(found.finger) == 3 + CORNERS[name]
    if CORNERS[name]:
        assert answer.margin > 0.01
    other = replace(held, types=("edge", "edge", "free" if CORNERS[name] else "concave_corner"))
    assert not answer.agrees_with(other)


@pytest.mark.parametrize("name", ["triangle", "T"])
def test_a_closed_hand_holds(name: str):
    scene, _, qpos = closed(GRASPS[name]())
    answer = shake(scene, qpos, np.random.default_rng(1))
    assert answer.held
    assert len(answer.pushes) == 10
    assert answer.penetration < 1e-5
    assert answer.shift < 1e-4
    assert answer.turn < (1e-2 if name == "triangle" else 1e-3)


def test_an_open_hand_does_not_hold():
    known = l_shape()
    scene = known.scene()
    held = supports(known.outline, known.contacts, known.radius)
    wide = scene.start_positions(opened(held, known.contacts, 1.1).as_array())[0]
    answer = shake(scene, wide, np.random.default_rng(1))
    assert not answer.held
    assert answer.shift > HELD_SHIFT
    again = shake(scene, wide, np.random.default_rng(1))
    assert again == answer  # the same seed, the same shake


def test_two_parallel_edges_hold_in_one_direction_only():
    """A slab between three fingers on its long sides slides out along them."""
    outline = Outline([[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [0.0, 1.0]])
    r = 0.06
    slab = KnownGrasp(outline, r, np.array([[1.5, 1.0 + r], [1.0, -r], [2.0, -r]]))
    scene = slab.scene()
    answer = shake(
        scene, scene.start_positions(slab.target.as_array())[0], np.random.default_rng(0)
    )
    assert not answer.held
    far = PUSH * scene.config.drive_force / scene.config.object_damping * PUSH_TIME
    way = -slab.target.theta - 0.25 * np.pi * np.arange(8)  # between the slab and each force
    shifts = [push.shift for push in answer.pushes[:8]]
    assert shifts == pytest.approx(far * np.abs(np.cos(way)), rel=0.05)
    assert max(push.shift for push in answer.pushes[8:]) < 1e-4


def test_wrenches_are_what_they_say():
    rows = pushes(0.3)
    assert np.hypot(rows[:8, 0], rows[:8, 1]) == pytest.approx(np.full(8, PUSH))
    assert rows[8:, 2].tolist() == pytest.approx([0.3 * PUSH, -0.3 * PUSH])
    drawn = random_wrenches(np.random.default_rng(2), 50 * SHAKES, 0.3)
    assert np.hypot(drawn[:, 0], drawn[:, 1]).max() <= PUSH
    assert np.abs(drawn[:, 2]).max() <= 0.3 * PUSH
    assert np.abs(drawn.mean(axis=0)).max() < 0.05 * PUSH


@pytest.mark.parametrize("make", [triangle, skew], ids=["equilateral", "skew"])
@pytest.mark.parametrize("delta", [1e-4, 1e-3, 1e-2])
def test_three_edges_play_by_the_law(make, delta: float):
    known = make()
    held = supports(known.outline, known.contacts, known.radius)
    assert held.three_edges
    play = measure_play(known.scene(), held, known.contacts, delta)
    assert play.on_edges
    assert play.law == pytest.approx(math.acos(1.0 / (1.0 + delta)))
    assert play.predicted == pytest.approx((play.law, play.law), rel=1e-6)
    assert play.measured == pytest.approx((play.law, play.law), rel=0.15)
    assert play.measured == pytest.approx((play.law, play.law), rel=0.005)  # seen: 0.0002
    assert play.penetration < 1e-2 * delta


@pytest.mark.slow
@pytest.mark.parametrize("make", [l_shape, t_shape], ids=["L", "T"])
def test_concave_corners_play_linearly_as_their_edges_say(make):
    known = make()
    held = supports(known.outline, known.contacts, known.radius)
    plays = [measure_play(known.scene(), held, known.contacts, d) for d in (1e-4, 1e-3)]
    for play in plays:
        assert play.on_edges
        assert play.measured == pytest.approx(play.predicted, rel=0.01)
        assert max(play.measured) < 0.3 * play.law
    assert plays[1].measured == pytest.approx([10 * x for x in plays[0].measured], rel=0.1)


def test_opening_gives_room_and_closing_does_not():
    known = triangle()
    held = supports(known.outline, known.contacts, known.radius)
    assert clearance(held, known.contacts, 1.01, 0.0)[0] > 0.0
    assert clearance(held, known.contacts, 1.0, 0.0)[0] == pytest.approx(0.0, abs=1e-12)
    assert clearance(held, known.contacts, 1.0, 0.01)[0] < 0.0
    assert predicted_play(held, known.contacts, 0.0) == pytest.approx((0.0, 0.0), abs=1e-6)


@pytest.mark.parametrize(
    ("columns", "rank", "held"),
    [
        (np.array([[1, -1, 0, 0], [0, 0, 1, -1], [0.2, 0.2, -0.2, -0.2]]), 3, True),
        (np.array([[1, -1, 0, 0], [0, 0, 1, -1], [0.2, 0.2, 0.2, -0.2]]), 3, False),
        (np.array([[1.0, -0.5, -0.5], [0.0, 0.9, -0.9], [0.0, 0.0, 0.0]]), 2, False),
        (np.array([[1.0, -1.0], [0.0, 0.0], [0.0, 0.0]]), 1, False),
        (np.zeros((3, 0)), 0, False),
    ],
)
def test_form_closure_of_known_wrenches(columns: np.ndarray, rank: int, held: bool):
    answer = form_closure(columns)
    assert (answer.rank, answer.closed) == (rank, held)
