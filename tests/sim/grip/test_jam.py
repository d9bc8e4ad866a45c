"""Where friction holds: closed forms beside the balance of forces, and beside closings."""

from __future__ import annotations

import math

import numpy as np
import pytest

from icage.hand import HandShape, Placement
from icage.outline import Outline
from sim.grip.jam import BALANCED, held_at, held_by_engine, least_mu, residual
from sim.grip.stick import STIFF, moved, opened, put_down, released_at, rubbing, stuck, threshold
from sim.world.config import SimConfig
from sim.world.scene import Scene
from tests.sim.grasps import triangle

RADIUS = 0.03


def on_a_wedge(degrees: float) -> tuple[Scene, np.ndarray]:
    """Two discs squeeze the sides of a wedge at one height, the third is off: tan(angle)."""
    angle = math.radians(degrees)
    outline = Outline([[-math.tan(angle), 0.0], [math.tan(angle), 0.0], [0.0, 1.0]])
    reach = 0.6 * math.tan(angle) + RADIUS * math.cos(angle)
    height = 0.4 + RADIUS * math.sin(angle)
    contacts = np.array([[reach, height], [-reach, height], [0.0, -0.5]])
    scene = Scene(outline, HandShape.from_contacts(contacts), RADIUS, SimConfig())
    return scene, Placement.from_contacts(contacts).as_array()


def on_a_turned_triangle(turn: float) -> tuple[Scene, np.ndarray]:
    """Three discs on the edges of a regular triangle, turned: tan(turn). [docs/physics.md]"""
    known = triangle()
    inradius = 0.5
    reach = (inradius + known.radius) / math.cos(turn)
    angles = np.deg2rad([30.0, 150.0, 270.0]) + turn
    contacts = reach * np.column_stack([np.cos(angles), np.sin(angles)])
    # the discs' contacts are not on the hand's lines: their tangents have an arm of their own
    scene = Scene(known.outline, HandShape.from_contacts(contacts), known.radius, SimConfig())
    return scene, Placement.from_contacts(contacts).as_array()


@pytest.mark.parametrize("degrees", [3.0, 15.0, 35.0])
def test_a_wedge_takes_the_tangent_of_its_angle(degrees: float) -> None:
    scene, placement = on_a_wedge(degrees)
    wanted = math.tan(math.radians(degrees))
    for held in (held_at(scene, placement), held_by_engine(scene, placement)):
        assert least_mu(held) == pytest.approx(wanted, rel=1e-6)
        assert residual(held, 1.001 * wanted) <= BALANCED < residual(held, 0.999 * wanted)


@pytest.mark.parametrize("turn", [0.05, -0.2])
def test_a_turned_triangle(turn: float) -> None:
    """Torque about the middle: a disc's normal has the arm (a + r) tan(turn), its friction a."""
    scene, placement = on_a_turned_triangle(turn)
    away = 0.5 + scene.finger_radius
    wanted = away * math.tan(abs(turn)) / 0.5
    assert least_mu(held_at(scene, placement)) == pytest.approx(wanted, rel=1e-6)


def test_nothing_holds_what_two_fingers_push_one_way() -> None:
    scene, placement = on_a_wedge(15.0)
    lone = held_at(scene, placement)
    one = lone._replace(finger=lone.finger[:1], points=lone.points[:1], normals=lone.normals[:1])
    assert least_mu(one) == np.inf
    nobody = lone._replace(finger=lone.finger[:0], points=lone.points[:0], normals=lone.normals[:0])
    assert least_mu(nobody) == np.inf


@pytest.mark.parametrize("make", [lambda: on_a_wedge(15.0), lambda: on_a_turned_triangle(0.2)])
def test_slides_below_the_least_friction_and_sticks_above(make) -> None:
    scene, placement = make()
    wanted = least_mu(held_at(scene, placement))
    for share, sticks in ((0.97, False), (1.03, True)):
        there = rubbing(scene, share * wanted)
        assert stuck(there, put_down(there, placement)).tolist() == [sticks]


@pytest.mark.parametrize(
    "config",
    [
        None,
        SimConfig(impratio=STIFF, time_step=5e-4),
        SimConfig(impratio=10.0),
        SimConfig(impratio=STIFF, drive_force=300.0),
    ],
    ids=["usual", "half the step", "more creep", "a third of the drive"],
)
def test_the_measured_threshold_is_the_closed_form(config: SimConfig | None) -> None:
    scene, placement = on_a_wedge(15.0)
    wanted = math.tan(math.radians(15.0))
    found = threshold(scene, placement, 1.1 * wanted, config)
    assert 0.99 * wanted < found.slips < found.sticks < 1.01 * wanted
    assert found.penetration < 5e-4


@pytest.mark.parametrize("degrees", [3.0, 35.0])
def test_flat_and_steep_wedges(degrees: float) -> None:
    scene, placement = on_a_wedge(degrees)
    wanted = math.tan(math.radians(degrees))
    found = threshold(scene, placement, 0.95 * wanted)
    assert 0.99 * wanted < found.slips < found.sticks < 1.01 * wanted


def test_a_threshold_far_from_the_one_foretold_is_said_to_be_so() -> None:
    scene, placement = on_a_wedge(15.0)
    wanted = math.tan(math.radians(15.0))
    assert threshold(scene, placement, 0.4 * wanted).sticks == np.inf
    assert threshold(scene, placement, 2.5 * wanted).slips == 0.0


@pytest.mark.parametrize("make", [lambda: on_a_wedge(15.0), lambda: on_a_turned_triangle(0.2)])
def test_what_sticks_lets_go_at_the_same_friction(make) -> None:
    scene, placement = make()
    wanted = least_mu(held_at(scene, placement))
    assert 0.97 * wanted < released_at(scene, placement, wanted) < 1.02 * wanted
    assert released_at(scene, placement, 0.1 * wanted) == np.inf
    assert released_at(scene, placement, 2.0 * wanted) == 0.0


def test_creep_falls_as_impratio_grows() -> None:
    scene, placement = on_a_wedge(15.0)
    crept: list[float] = []
    for impratio in (1.0, 100.0):
        config = SimConfig(impratio=impratio)
        there = rubbing(scene, 1.1 * math.tan(math.radians(15.0)), config)
        shift, _ = moved(there, placement, put_down(there, placement).end)
        crept.append(float(shift[0]))
    assert 1e-6 < crept[0] < 1e-4
    assert crept[1] < 0.05 * crept[0]


def test_opened_hands_keep_their_middle() -> None:
    scene, placement = on_a_wedge(15.0)
    wider = opened(scene, placement, 0.01)
    was, now = scene.hand.fingers(placement), scene.hand.fingers(wider)[0]
    np.testing.assert_allclose(now.mean(axis=0), was.mean(axis=0), atol=1e-12)
    np.testing.assert_allclose(now - now.mean(0), 1.01 * (was - was.mean(0)), atol=1e-12)
