"""Tables that are tilted or hold the object back, as on paper."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from icage.arrays import FloatArray
from sim.closing.judge import grasp_errors
from sim.closing.outcome import ClosingOutcomes
from sim.closing.varied import Worlds, mean_distance
from sim.world.scene import Scene
from tests.sim.closing.worlds import close, endings, scene_of
from tests.sim.grasps import KnownGrasp, l_shape, shipped, starts_near, t_shape


def wide_start(grasp: KnownGrasp, opening: float, turn: float = 0.0) -> FloatArray:
    """A hand round the middle of the target's fingers, ``opening`` times as wide."""
    target, middle = grasp.target, grasp.hand.z.mean()
    at = complex(target.x, target.y) + target.sigma * np.exp(1j * target.theta) * middle
    sigma, theta = opening * target.sigma, target.theta + turn
    d = at - sigma * np.exp(1j * theta) * middle
    return np.array([d.real, d.imag, theta, sigma])


def travel(scene: Scene, closings: ClosingOutcomes) -> FloatArray:
    """(N, 3) how far the object went: x, y [diameter] and turn [rad], in the palm's axes."""
    before, after = (scene.start_positions(rows) for rows in (closings.start, closings.end))
    return (after - before)[:, 3:]


def test_mean_distance_of_a_square_a_rectangle_and_a_disc():
    square = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
    expected = (np.sqrt(2.0) + np.arcsinh(1.0)) / 3.0
    assert mean_distance(square) == pytest.approx(expected, rel=1e-14)
    corner = (square + 1.0) / 2.0  # the origin in a corner: two edges pass through it
    assert mean_distance(corner) == pytest.approx(expected, rel=1e-14)
    angles = 2.0 * np.pi * np.arange(2000) / 2000
    disc = np.column_stack([np.cos(angles), np.sin(angles)])
    assert mean_distance(disc) == pytest.approx(2.0 / 3.0, rel=1e-5)
    assert mean_distance(3.0 * disc) == pytest.approx(3.0 * mean_distance(disc), rel=1e-12)


@pytest.mark.parametrize("grasp", [l_shape(), shipped("pliers")], ids=["L", "pliers"])
def test_mean_distance_of_a_shape_whose_edges_face_the_middle(grasp: KnownGrasp):
    thing = scene_of(grasp).object
    rng = np.random.default_rng(9)
    low, high = thing.vertices.min(axis=0), thing.vertices.max(axis=0)
    points = rng.uniform(low, high, (200_000, 2))
    points = points[shapely.contains_xy(shapely.Polygon(thing.vertices), *points.T)]
    distance = np.hypot(*points.T)
    spread = distance.std() / np.sqrt(len(distance))
    assert mean_distance(thing.vertices) == pytest.approx(distance.mean(), abs=4.0 * spread)


def test_a_slower_hand_has_as_much_longer():
    grasp = t_shape()
    starts = starts_near(grasp, 3, seed=4)
    usual = close(scene_of(grasp), starts).closings.steps.max()
    brief = scene_of(grasp, max_time=1.1e-3 * usual)
    worlds = Worlds.usual(3)
    worlds.speed[:] = 0.1
    found = close(brief, starts, worlds)
    assert endings(found) == ["settled"] * 3
    assert found.closings.steps.min() > 2 * usual


@pytest.mark.parametrize("turn", [0.0, 0.9])
def test_an_untouched_object_slides_downhill(turn: float):
    """At mass * gravity / damping, less what the table holds back; the hand hardly moves."""
    grasp = t_shape()
    slow, count, time = 0.02, 6, 0.3
    scene = scene_of(grasp, max_time=slow * time)  # slower hands have as much longer
    starts = np.tile(wide_start(grasp, 6.0, turn), (count, 1))
    worlds, downhill, pull = Worlds.usual(count), 0.7, 0.1
    worlds.gravity_x[:] = pull * np.cos(downhill)
    worlds.gravity_y[:] = pull * np.sin(downhill)
    worlds.speed[:] = slow
    worlds.mass[:] = [1.0, 2.0, 1.0, 1.0, 1.0, 1.0]
    worlds.inertia[2], worlds.com_x[3] = 3.0, 1e-9
    worlds.gravity_x[4:], worlds.gravity_y[4:] = pull, 0.0
    worlds.table_friction[4:] = [0.04, 0.11]
    found = close(scene, starts, worlds)
    assert endings(found) == ["timed_out"] * count
    gone = travel(scene, found.closings)
    speed = pull * scene.config.drive_force / scene.config.object_damping
    straight = speed * time * np.array([np.cos(downhill), np.sin(downhill)])
    for i, share in ((0, 1.0), (1, 2.0), (2, 1.0), (3, 1.0)):
        np.testing.assert_allclose(gone[i, :2], share * straight, rtol=0.03)
    np.testing.assert_allclose(gone[1, :2] / gone[0, :2], 2.0, rtol=0.02)
    assert np.abs(gone[:3, 2]).max() < 1e-12  # nothing turns it
    assert gone[4, 0] == pytest.approx(0.6 * speed * time, rel=0.03)
    assert np.abs(gone[5]).max() < 2e-5  # the table holds it, with next to no creep
    assert np.abs(gone[4:, 1]).max() < 1e-12


def test_an_object_whose_middle_is_off_its_weight_turns():
    grasp = t_shape()
    scene = scene_of(grasp, max_time=0.02 * 0.2)
    starts = np.tile(wide_start(grasp, 6.0, -grasp.target.theta), (2, 1))  # axes of both agree
    worlds = Worlds.usual(2)
    worlds.gravity_x[:], worlds.com_y[:], worlds.speed[:] = 0.05, [0.1, -0.1], 0.02
    gone = travel(scene, close(scene, starts, worlds).closings)
    spin = 0.05 * 0.1 * scene.config.drive_force
    rate = spin / (scene.config.object_damping * scene.object.gyration_squared)
    assert gone[0, 2] == pytest.approx(-0.2 * rate, rel=0.05)  # pulled in x, above the middle
    assert gone[1, 2] == pytest.approx(0.2 * rate, rel=0.05)


def test_a_table_that_holds_more_than_the_fingers_push():
    """A push is at most sqrt(3) of the closing force; free objects go much farther."""
    grasp = t_shape()
    scene = scene_of(grasp)
    starts = np.tile(starts_near(grasp, 1, seed=3), (4, 1))
    worlds = Worlds.usual(4)
    worlds.table_friction[:] = [0.0, 0.05, 3.0, 6.0]
    found = close(scene, starts, worlds)
    assert endings(found) == ["settled"] * 4
    gone = np.abs(travel(scene, found.closings)).max(axis=1)
    assert gone[0] > 0.02
    assert gone[1] > 0.02
    assert gone[2:].max() < 1e-3
    errors = grasp_errors(found.closings.end, grasp, grasp.outline)[0]
    assert errors[:2].max() < 1e-4
    assert errors[2:].min() > 5e-3
