"""The steps computed here against the engine's own, and what must be left to the engine."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

import mujoco
import numpy as np
import pytest

from icage.arrays import FloatArray
from sim.closing.approach import approached
from sim.closing.batch import close_many
from sim.closing.computed_step import empty_room, go_on
from sim.closing.one import data_at
from sim.closing.outcome import ClosingOutcomes
from sim.closing.plant import plant_of
from sim.closing.push import Pushed, push
from sim.closing.step_check import ENDINGS, PINCHED, RUNNING, StepCheck
from sim.closing.varied import Worlds
from sim.closing.varied_shapes import close_varied
from sim.world.config import SimConfig
from sim.world.scene import Scene
from tests.sim.grasps import GRASPS, l_shape, starts_near, t_shape


def pushed(scene: Scene, starts: FloatArray, stride: int = 1) -> tuple[Pushed, StepCheck]:
    begin = scene.start_positions(starts)
    check = StepCheck.over(scene, begin, stride)
    return push(scene, approached(scene, begin), check), check


def engine_after(scene: Scene, start: FloatArray, steps: int) -> Any:
    data = data_at(scene, approached(scene, scene.start_positions(start[None, :]))[0])
    mujoco.mj_step(scene.model, data, steps)
    return data


def assert_as_the_engine(scene: Scene, starts: FloatArray) -> int:
    """Positions to 1e-9 after all of the way; the number of steps taken in all."""
    found, check = pushed(scene, starts)
    for i, row in enumerate(starts):
        data = engine_after(scene, row, int(check.steps[i]))
        assert data.time == pytest.approx(check.steps[i] * scene.config.time_step)
        np.testing.assert_allclose(found.positions[i], data.qpos, rtol=0.0, atol=1e-9)
        np.testing.assert_allclose(found.velocities[i], data.qvel, rtol=0.0, atol=1e-6)
        np.testing.assert_allclose(found.accelerations[i], data.qacc, rtol=0.0, atol=1e-3)
    return int(check.steps.sum())


@pytest.mark.parametrize("name", GRASPS)
def test_every_step_is_the_engines(name: str) -> None:
    grasp = GRASPS[name]()
    starts = starts_near(grasp, 8, seed=31, opening=1.6, shift=0.06, turn=0.3)
    assert assert_as_the_engine(grasp.scene(), starts) > 8 * 20


@pytest.mark.parametrize("stride", [1, 5])
def test_one_loop_ends_at_the_bits_of_steps_and_looks_in_turns(stride: int) -> None:
    grasp = t_shape()
    scene, starts = (
        grasp.scene(),
        starts_near(grasp, 20, seed=33, opening=1.6, shift=0.06, turn=0.3),
    )
    found, record = pushed(scene, starts, stride)
    begin = scene.start_positions(starts)
    state, peak = np.zeros((len(starts), 3, 6)), np.zeros(len(starts))
    state[:, 0] = approached(scene, begin)
    check = StepCheck.over(scene, begin, stride)
    plant, room, most = plant_of(scene), empty_room(), scene.config.computed_contacts
    running = np.arange(len(starts))
    while len(running):
        running = running[go_on(running, plant, room, most, stride, state, peak)]
        running = check.observe(running, state[:, 0], state[:, 1])
        assert (check.ending[running] == RUNNING).all()
    assert np.array_equal(found.positions, state[:, 0])
    assert np.array_equal(found.velocities, state[:, 1])
    assert np.array_equal(found.peak_force, peak)
    for name in ("steps", "ending", "touches", "penetration_max", "sigma_rise_max"):
        assert np.array_equal(getattr(record, name), getattr(check, name)), name
    assert check.steps.min() > 20


@pytest.mark.parametrize(
    "changed",
    [
        {"time_step": 4e-4},
        {"object_damping": 40.0, "drive_force": 300.0},
        {"finger_mass": 1.5, "finger_damping": 900.0},
        {"contact_damping": 1.0, "contact_solref": 1.0, "linkage_solref": 0.1},
        {"solimp": (0.9999, 0.9999, 1e-3, 0.3, 1.0)},
    ],
    ids=lambda changed: next(iter(changed)),
)
def test_other_settings_too(changed: dict[str, Any]) -> None:
    grasp = l_shape()
    starts = starts_near(grasp, 6, seed=32, opening=1.5, turn=0.3)
    assert assert_as_the_engine(grasp.scene(SimConfig(**changed)), starts) > 6 * 20


@pytest.mark.parametrize(
    "changed",
    [
        {"friction": 0.1},
        {"linkage_compliance": 1e-7},
        {"solimp": (0.9, 0.95, 1e-3, 0.5, 2.0)},
        {"computed_contacts": 0},
    ],
    ids=lambda changed: next(iter(changed)),
)
def test_what_is_not_written_down_is_left_to_the_engine(changed: dict[str, Any]) -> None:
    grasp = l_shape()
    scene = grasp.scene(SimConfig(**changed))
    starts = starts_near(grasp, 3, seed=33)
    found, check = pushed(scene, starts)
    assert not check.steps.any()
    begin = approached(scene, scene.start_positions(starts))
    assert found.positions.tobytes() == begin.tobytes()


@pytest.mark.parametrize("name", GRASPS)
def test_a_grasp_is_never_computed(name: str) -> None:
    """Where the engine goes on, the object has more contacts, or is slow, or has been let go."""
    grasp = GRASPS[name]()
    scene = grasp.scene()
    starts = starts_near(grasp, 8, seed=34, opening=1.4)
    found, check = pushed(scene, starts)
    for i in np.flatnonzero(check.ending == RUNNING).tolist():
        data = mujoco.MjData(scene.model)
        data.qpos[:] = found.positions[i]
        mujoco.mj_forward(scene.model, data)
        slow = np.abs(found.velocities[i]).max() < 0.02 * scene.config.free_speed
        assert data.ncon > 3 or slow
    home = grasp.target.as_array()[None, :] * [1.0, 1.0, 1.0, 1.0 + 1e-9]
    _, check = pushed(scene, np.array(home))
    assert check.steps[0] <= 12  # from the target itself there is nothing to push


@pytest.mark.parametrize("name", ["T", "L", "pliers", "triangle"])
def test_whole_closings_are_the_same(name: str) -> None:
    """Verdict, steps, depths and place, of starts most of which are no cage."""
    grasp = GRASPS[name]()
    starts = starts_near(grasp, 60, seed=35, opening=2.0, turn=0.4)
    mine, engines = (
        close_many(grasp.scene(SimConfig(computed_contacts=most)), starts) for most in (3, 0)
    )
    assert mine.ending.tolist() == engines.ending.tolist()
    assert mine.steps.tolist() == engines.steps.tolist()
    assert_near(mine, engines, 1e-8, grasp.outline.diameter)


def assert_near(mine: ClosingOutcomes, other: ClosingOutcomes, near: float, size: float) -> None:
    for part in fields(ClosingOutcomes):
        a, b = getattr(mine, part.name), getattr(other, part.name)
        if part.name == "end":
            a, b = a / [size, size, 1.0, size], b / [size, size, 1.0, size]
        if part.name not in ("finger_forces", "contacts"):
            np.testing.assert_allclose(a, b, rtol=0.0, atol=near, err_msg=part.name)


def test_a_hand_that_shuts_on_nothing_is_told_so() -> None:
    grasp = t_shape()
    starts = np.array([[40.0, 0.0, 0.2, 2.0], [np.nan, 0.0, 0.0, 1.0]])
    _, check = pushed(grasp.scene(), starts)
    assert check.ending.tolist() == [PINCHED, RUNNING]


def test_looking_seldom_stops_at_a_look() -> None:
    grasp = l_shape()
    scene, starts = grasp.scene(), starts_near(grasp, 6, seed=36, opening=1.5)
    often, every = pushed(scene, starts)
    seldom, fifth = pushed(scene, starts, stride=5)
    assert fifth.steps.tolist() == (every.steps // 5 * 5).tolist()
    assert (seldom.peak_force > 0.0).all()
    assert (seldom.peak_force <= often.peak_force).all()


def test_a_studys_closings_are_the_same() -> None:
    """With forces; and a world of its own (heavier here) is left to the engine."""
    grasp = l_shape()
    starts, worlds = starts_near(grasp, 30, seed=37, opening=1.5), Worlds.usual(30)
    worlds.mass[::3] = 1.7
    which = np.zeros(30, dtype=np.int64)
    config = SimConfig()
    mine, engines = (
        close_varied(
            [Scene(grasp.outline, grasp.hand, grasp.radius, one, instrumented=True)],
            which, starts, worlds,
        )
        for one in (config, replace(config, computed_contacts=0))
    )  # fmt: skip
    assert {ENDINGS[k] for k in mine.closings.ending} == {"settled"}
    assert mine.closings.steps.tolist() == engines.closings.steps.tolist()
    np.testing.assert_allclose(mine.peak_force, engines.peak_force, rtol=1e-5)
    assert_near(mine.closings, engines.closings, 1e-8, grasp.outline.diameter)
    heavy = slice(0, None, 3)
    assert mine.closings.end[heavy].tobytes() == engines.closings.end[heavy].tobytes()
