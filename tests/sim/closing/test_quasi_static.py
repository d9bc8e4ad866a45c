"""Speed, time step, inertia and compliance change nothing that counts, until they are large."""

from __future__ import annotations

from dataclasses import fields, replace

import mujoco
import numpy as np
import pytest

from sim.closing.batch import close_many
from sim.closing.one import data_at
from sim.closing.outcome import ClosingOutcomes
from sim.closing.quasi_static import CHANGES, SLOWER, Change, compare
from sim.world.config import SimConfig
from tests.sim.grasps import l_shape, starts_near, t_shape, triangle

GRASPS = [triangle, l_shape, t_shape]


@pytest.mark.parametrize("make", GRASPS)
def test_twice_slower_or_half_the_time_step_changes_no_end(make):
    known = make()
    starts = starts_near(known, 4, seed=3, opening=1.3)
    for variant in compare(known.scene(), [known], starts, SLOWER):
        assert variant.changed == variant.timed_out == 0
        assert variant.same
        assert variant.position < 1e-6
        assert variant.angle < 1e-5


@pytest.mark.parametrize("make", GRASPS)
def test_twice_the_inertia_or_a_little_compliance_changes_no_end(make):
    known = make()
    starts = starts_near(known, 3, seed=4, opening=1.3)
    changes = [Change(inertia=2.0), Change(yielding=1e-6)]
    for variant in compare(known.scene(), [known], starts, changes):
        assert variant.same
        assert variant.timed_out == 0
        assert variant.position < 3e-6
        assert variant.angle < 1e-5


def test_a_compliant_hand_moves_the_end_in_proportion():
    known = l_shape()
    starts = starts_near(known, 2, seed=5)
    soft = compare(known.scene(), [known], starts, [Change(yielding=1e-4), Change(yielding=1e-3)])
    assert soft[0].position == pytest.approx(6e-5, rel=0.5)
    assert soft[1].position == pytest.approx(10.0 * soft[0].position, rel=0.1)
    assert not soft[1].same


def test_a_yielding_finger_bears_its_contact_by_its_spring():
    """At rest K e_k is what the contacts press on the slides, without the part along the drive."""
    known = l_shape()
    config = replace(SimConfig(), linkage_compliance=1e-6)
    scene = known.scene(config)
    data = data_at(scene, scene.start_positions(starts_near(known, 1, seed=5))[0])
    mujoco.mj_step(scene.model, data, 2000)
    mujoco.mj_forward(scene.model, data)
    assert abs(data.qvel).max() < 1e-6
    pressed = data.qfrc_constraint[:3]
    expected = scene.kinematics.shape_projector @ pressed * config.linkage_compliance
    off = data.qpos[:3] - scene.kinematics.lengths * scene.sigma(data.qpos[None, :])[0]
    np.testing.assert_allclose(off, expected, atol=1e-3 * abs(off).max())
    assert abs(off).max() > 1e-5


@pytest.mark.parametrize("factor", [0.5, 20.0])
def test_masses_times_f_are_forces_and_dampings_over_f(factor: float):
    known = l_shape()
    usual, heavy = known.scene(), known.scene(Change(inertia=factor).config(SimConfig()))
    spec = usual.spec(visuals=False)
    thing = spec.body("object")
    thing.mass, thing.inertia = thing.mass * factor, thing.inertia * factor
    for k in (1, 2, 3):
        tip = spec.geom(f"finger_{k}_tip")
        tip.mass = tip.mass * factor
    model = spec.compile()
    start = usual.start_positions(starts_near(known, 1, seed=6))[0]
    one, other = mujoco.MjData(model), data_at(heavy, start)
    one.qpos[:], one.ctrl[:] = start, usual.closing_force
    mujoco.mj_step(model, one, 150)
    mujoco.mj_step(heavy.model, other, 150)
    assert abs(one.qpos[3:] - start[3:]).max() > 1e-3  # the object was pushed
    np.testing.assert_allclose(one.qpos, other.qpos, atol=1e-9)


def test_no_change_is_the_usual_closing_bit_for_bit():
    known = l_shape()
    starts = starts_near(known, 3, seed=7)
    assert Change().config(SimConfig()) == SimConfig()
    usual, same = (
        close_many(known.scene(config), starts)
        for config in (None, replace(SimConfig(), linkage_compliance=0.0))
    )
    for part in fields(ClosingOutcomes):
        assert getattr(usual, part.name).tobytes() == getattr(same, part.name).tobytes()


def test_what_breaks_is_seen():
    """Three hundred times the force, or a hand of rubber: other ends, or discs in the object."""
    known = l_shape()
    starts = starts_near(known, 10, seed=3, opening=1.4, turn=0.2)
    scene = known.scene(replace(SimConfig(), max_time=1.0))
    wild, rubber = compare(
        scene, [known], starts, [Change(speed=300.0, step=4.0), Change(yielding=0.1)]
    )
    assert wild.penetration > 1e-2
    assert not wild.same
    assert rubber.position > 1e-2
    assert not rubber.same


def test_a_change_keeps_what_stillness_means():
    usual, slow = SimConfig(), Change(speed=0.5, step=0.5).config(SimConfig())
    assert slow.free_speed == pytest.approx(0.5 * usual.free_speed)
    assert slow.max_steps == 4 * usual.max_steps
    assert slow.still_speed == 0.5 * usual.still_speed
    assert np.isclose(slow.contact_solref, usual.contact_solref)
    heavy = Change(inertia=3.0).config(usual)
    assert heavy.free_speed == usual.free_speed
    assert len(set(CHANGES)) == len(CHANGES)
