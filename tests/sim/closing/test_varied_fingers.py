"""Friction of the fingers, speed and force of the motor, as on paper."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
import pytest

from icage.arrays import FloatArray, IntArray
from sim.closing import varied_shapes as varied_closing
from sim.closing.approach import approached
from sim.closing.judge import grasp_errors
from sim.closing.step_check import ENDINGS
from sim.closing.varied import Worlds, own_model, settings
from sim.world.contact_forces import finger_forces
from tests.sim.closing.worlds import close, endings, scene_of
from tests.sim.grasps import KnownGrasp, l_shape, shipped, starts_near, t_shape, triangle


@pytest.mark.parametrize("mu", [0.05, 0.2])
def test_friction_jams_a_three_edge_grasp_within_its_cone(mu: float):
    """|theta| <= atan(mu) at rest. [docs/physics.md, Friction]"""
    grasp = triangle()
    scene = scene_of(grasp, friction=1.0)
    starts = starts_near(grasp, 12, seed=11, turn=0.4, opening=1.3)
    worlds = Worlds.usual(24)
    worlds.friction[:12] = mu
    found = close(scene, np.tile(starts, (2, 1)), worlds)
    assert endings(found) == ["settled"] * 24
    turned = grasp_errors(found.closings.end, grasp, grasp.outline)[1]
    assert turned[:12].max() <= np.arctan(mu) + 0.01
    assert turned[:12].max() > 0.3 * np.arctan(mu)  # the bound is not idle
    assert turned[12:].max() < 1e-4  # no friction in the same scene, the same batch


@pytest.mark.parametrize("tool", ["saw", "wrench"])
def test_what_rattles_in_place_is_at_rest_where_it_stays(tool: str):
    """Some of these lose and find a contact for ever; more time changes nothing."""
    grasp = shipped(tool)
    starts, worlds = starts_near(grasp, 20, seed=13), Worlds.usual(20)
    worlds.friction[:] = 0.3
    found = close(scene_of(grasp, friction=1.0), starts, worlds)
    assert endings(found) == ["settled"] * 20
    rattling = np.flatnonzero(found.closings.steps >= 2 * varied_closing.DRIFT_STEPS)
    assert len(rattling) >= 4
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(varied_closing, "DRIFT", 0.0)
        scene = scene_of(grasp, friction=1.0, max_time=3.0)
        later = close(scene, starts[rattling], worlds[rattling])
    assert "timed_out" in endings(later)
    places = [scene.start_positions(one.end) for one in (found.closings, later.closings)]
    assert np.abs(places[0][rattling] - places[1]).max() < 2.0 * varied_closing.SWING


def test_the_time_to_close_goes_with_the_speed_and_not_with_the_force():
    """Shut on nothing: spread * sigma / (0.5 speed). A breath of gravity keeps the free travel."""
    grasp = t_shape()
    scene = scene_of(grasp)
    far = np.array([40.0, 0.0, 0.2, 0.4 * grasp.outline.diameter])
    worlds = Worlds.usual(6)
    worlds.gravity_x[:] = 1e-9
    worlds.speed[:] = [1.0, 2.0, 0.5, 0.25, 1.0, 1.0]
    worlds.force[:] = [1.0, 1.0, 1.0, 1.0, 4.0, 0.25]
    found = close(scene, np.tile(far, (6, 1)), worlds)
    assert endings(found) == ["pinched"] * 6
    time = 0.4 * scene.kinematics.spread / scene.config.free_speed
    expected = time / worlds.speed / scene.config.time_step
    np.testing.assert_allclose(found.closings.steps, expected, rtol=0.01, atol=6.0)
    assert (found.peak_force == 0.0).all()


def test_a_stronger_motor_presses_harder_in_the_same_place():
    grasp = l_shape()
    starts = np.tile(starts_near(grasp, 1, seed=12), (4, 1))
    worlds = Worlds.usual(4)
    worlds.force[:] = [1.0, 2.0, 0.1, 10.0]
    found = close(scene_of(grasp), starts, worlds)
    assert endings(found) == ["settled"] * 4
    forces = found.closings.finger_forces
    np.testing.assert_allclose(forces / forces[:1], worlds.force[:, None] * np.ones(3), rtol=1e-3)
    assert np.abs(found.closings.end - found.closings.end[0]).max() < 1e-4
    assert (found.peak_force >= forces.max(axis=1) * (1.0 - 1e-6)).all()


@pytest.mark.parametrize("mu", [0.0, 0.3])
@pytest.mark.parametrize("grasp", [triangle(), shipped("saw")], ids=["triangle", "saw"])
def test_touch_sensors_tell_the_normal_forces(grasp: KnownGrasp, mu: float):
    """Against the plain loop, and there against the engine's contacts, one after another.

    Of a finger with one frictionless contact, the sum is the length of its force.
    """
    scene = scene_of(grasp, friction=1.0)
    worlds, starts = Worlds.usual(3), starts_near(grasp, 3, seed=13)
    worlds.friction[:] = mu
    found = close(scene, starts, worlds).closings
    assert (found.ending == ENDINGS.index("settled")).all()
    model = own_model(scene.model, list(settings(scene, worlds)), 0)
    begin = approached(scene, scene.start_positions(starts))
    for i in range(3):
        data = mujoco.MjData(model)
        data.qpos[:], data.ctrl[:] = begin[i], scene.closing_force
        mujoco.mj_step(model, data, int(found.steps[i]))
        assert scene.placements(data.qpos)[0].tolist() == found.end[i].tolist()
        drive = scene.config.drive_force
        assert (data.sensordata / drive).tolist() == found.finger_forces[i].tolist()
        along, total = _normal_forces(model, data)  # of the state before the last step
        np.testing.assert_allclose(data.sensordata, along, rtol=1e-9)
        vectors, contacts = finger_forces(model, data)
        assert contacts == total.sum()
        if mu == 0.0:
            plain = total == 1
            assert plain.all() == (len(grasp.outline) == 3)
            one, other = np.hypot(*vectors.T)[plain], found.finger_forces[i][plain] * drive
            np.testing.assert_allclose(one, other, rtol=1e-4)


def _normal_forces(model: Any, data: Any) -> tuple[FloatArray, IntArray]:
    """Sum of normal forces (3,) and number of contacts (3,) of each finger, from the contacts."""
    tips = [model.geom(f"finger_{k + 1}_tip").id for k in range(3)]
    along, total, wrench = np.zeros(3), np.zeros(3, dtype=np.int64), np.zeros(6)
    for number in range(data.ncon):
        mujoco.mj_contactForce(model, data, number, wrench)
        (k,) = (tips.index(g) for g in data.contact[number].geom.tolist() if g in tips)
        along[k] += wrench[0]
        total[k] += 1
    return along, total
