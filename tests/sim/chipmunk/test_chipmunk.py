"""The second engine: the same ends as MuJoCo's, nothing out below sigma_max, faults seen."""

from __future__ import annotations

import functools
import re
import sys
from pathlib import Path

import numpy as np
import pytest

from icage.cage import Cage
from icage.errors import InputError
from icage.hand import HandShape
from icage.outline import Outline
from icage.planner import plan
from icage.sampling import draw_starts
from sim.attack.guided import object_path
from sim.attack.held import DIVERGED, ESCAPED, HELD
from sim.attack.random import RandomPull
from sim.chipmunk import engine
from sim.chipmunk.attack import random_attack_second
from sim.chipmunk.closing import close_many_second
from sim.chipmunk.world import World
from sim.closing.batch import close_many
from sim.closing.judge import judge
from sim.closing.outcome import ClosingOutcomes
from sim.closing.step_check import ENDINGS
from sim.grip.jam import held_at, least_mu
from sim.grip.stick import OPENED, SLIPS, opened, rubbing, stuck
from sim.world.config import SimConfig
from sim.world.scene import Scene
from tests.sim.grasps import GRASPS, KnownGrasp, l_shape, shipped, starts_near, t_shape
from tests.sim.grip.test_jam import on_a_turned_triangle, on_a_wedge

NAMES = ("T", "L", "pliers")


@pytest.fixture
def second() -> None:
    """Installed by the extras ``second``, ``test`` and ``dev``, so by ``python3 -m tests``."""
    pytest.importorskip("pymunk", reason="the second engine is optional: pip install icage[second]")


@functools.cache
def cage_of(name: str) -> tuple[KnownGrasp, Cage]:
    grasp = GRASPS[name]()
    return grasp, plan(grasp.outline, grasp.contacts, grasp.radius)


def on_the_way_out(grasp: KnownGrasp) -> tuple[Scene, float, np.ndarray]:
    """Scene, sigma_max [diameter], and where the way out first needs 0.99 sigma_max: (6,)."""
    cage = plan(grasp.outline, grasp.contacts, grasp.radius)
    assert cage.sigma_max is not None
    assert cage.escape_path is not None
    scene = grasp.scene()
    top = cage.sigma_max / scene.object.diameter
    path = object_path(scene, cage.escape_path)
    k = int(np.argmax(path[:, 3] > 0.99 * top))
    share = (0.99 * top - path[k - 1, 3]) / (path[k, 3] - path[k - 1, 3])
    x, y, turn, sigma = (path[k - 1, :4] + share * (path[k, :4] - path[k - 1, :4])).tolist()
    return scene, top, np.array([*(sigma * scene.kinematics.lengths), x, y, turn])


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.usefixtures("second")
def test_guaranteed_starts_end_in_the_target_as_in_mujoco(name: str) -> None:
    grasp, cage = cage_of(name)
    starts = draw_starts(cage, "guaranteed", 6, np.random.default_rng(3)).placements
    scene = grasp.scene()
    closings = close_many_second(scene, starts)
    verdicts = judge(closings, [grasp], grasp.outline)
    assert verdicts.counts()["target"] == len(starts)
    assert verdicts.position_error.max() <= 2e-5
    assert verdicts.angle_error.max() <= 2e-4
    assert closings.penetration_max.max() <= 1e-3
    assert closings.penetration_rest.max() <= 1e-5
    assert closings.shape_error_max.max() <= 1e-5
    assert closings.sigma_rise_max.max() <= 1.0 + 1e-9
    assert (closings.finger_forces.sum(axis=1) > 0.5).all()
    assert (closings.contacts >= 3).all()
    first = close_many(scene, starts)
    unit = scene.object.diameter
    apart = np.abs(closings.end - first.end) / [unit, unit, 1.0, unit]
    assert apart.max() <= 2e-4


@pytest.mark.usefixtures("second")
def test_the_forces_are_mujocos() -> None:
    """Four contacts on the L, so that they are no matter of taste."""
    grasp = l_shape()
    starts = starts_near(grasp, 3, seed=1)
    ours, first = (close(grasp.scene(), starts) for close in (close_many_second, close_many))
    np.testing.assert_allclose(ours.finger_forces, first.finger_forces, atol=2e-3)


def faulty(grasp: KnownGrasp, fault: str) -> Scene:
    """The scene of a grasp with an object 1 % too large, or a finger 1 degree out of place."""
    if fault == "object":
        centre = grasp.outline.centroid
        grown = Outline(centre + 1.01 * (grasp.outline.vertices - centre))
        return Scene(grown, grasp.hand, grasp.radius, SimConfig(max_time=1.5))
    c = grasp.contacts @ [1.0, 1.0j]
    c[2] = c[0] + (c[2] - c[0]) * np.exp(1j * np.deg2rad(1.0))
    hand = HandShape.from_contacts(np.column_stack([c.real, c.imag]))
    return Scene(grasp.outline, hand, grasp.radius, SimConfig(max_time=1.5))


@pytest.mark.parametrize("fault", ["object", "hand"])
@pytest.mark.usefixtures("second")
def test_a_planted_fault_is_no_target(fault: str) -> None:
    grasp = t_shape()
    scene = faulty(grasp, fault)
    starts = starts_near(grasp, 4, seed=2, opening=1.3)
    starts = starts[starts[:, 3] > 1.05 * grasp.target.sigma]
    assert len(starts) >= 2
    verdicts = judge(close_many_second(scene, starts), [grasp], grasp.outline)
    assert verdicts.counts()["target"] == 0


@pytest.mark.usefixtures("second")
def test_out_above_sigma_max_and_not_below() -> None:
    """The same start, on the way out, and the same pulls."""
    scene, top, start = on_the_way_out(shipped("pliers"))
    openings = np.array([0.998, 1.05, 1.05, 1.05]) * top
    pull = RandomPull(duration=3.0)
    starts = np.repeat(start[None], len(openings), axis=0)
    run = random_attack_second(scene, starts, openings, np.random.default_rng(1), pull)
    assert (run.ending[:1] == HELD).all()
    assert (run.ending[1:] == ESCAPED).any()
    assert (run.rise_max < 1.001).all()
    assert (run.rise_max > 0.999).all()
    assert run.penetration_max.max() < 1e-3
    assert (run.steps[run.ending == HELD] == 3000).all()


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.usefixtures("second")
def test_nothing_gets_out_of_a_cage(name: str) -> None:
    grasp, cage = cage_of(name)
    assert cage.sigma_max is not None
    scene = grasp.scene()
    openings = np.full(2, 0.998 * cage.sigma_max / scene.object.diameter)
    starts = np.repeat(scene.start_positions(grasp.target.as_array()), 2, axis=0)
    pull = RandomPull(duration=2.0)
    run = random_attack_second(scene, starts, openings, np.random.default_rng(2), pull)
    assert run.escapes == 0
    assert (run.ending == HELD).all()
    assert run.penetration_max.max() < 1e-3


def same(one: ClosingOutcomes, other: ClosingOutcomes) -> bool:
    return one.end.tobytes() == other.end.tobytes() and np.array_equal(one.steps, other.steps)


@pytest.mark.usefixtures("second")
def test_neighbours_and_repetition_change_no_bit() -> None:
    grasp = t_shape()
    starts = starts_near(grasp, 3, seed=4)
    both = close_many_second(grasp.scene(), starts)
    assert same(both, close_many_second(grasp.scene(), starts))
    alone = close_many_second(grasp.scene(), starts[2:])
    assert alone.end.tobytes() == both.end[2:].tobytes()


@pytest.mark.usefixtures("second")
def test_the_arms_are_slides() -> None:
    """Tips are where the linkage has them, to what R promises, and qpos is what was asked for."""
    scene = t_shape().scene()
    sigma = 0.8
    qpos = np.array([*(sigma * scene.kinematics.lengths), 3.0, 2.0, 0.3])
    world = World(scene, qpos)
    np.testing.assert_allclose(world.positions(), qpos, rtol=0.0, atol=1e-12)
    wanted = scene.kinematics.directions * qpos[:3, None]
    for arm, place in zip(world.arms, wanted, strict=True):
        (tip,) = arm.shapes
        seen = arm.local_to_world(tip.offset)
        np.testing.assert_allclose([seen.x, seen.y], place, rtol=0.0, atol=1e-7)
    world.step(scene.closing_force)
    steady = [world.step(scene.closing_force) for _ in range(60)][-1]
    speed = np.linalg.norm(steady[6:9])
    assert speed == pytest.approx(scene.config.free_speed, rel=2e-3)  # the same damper


@pytest.mark.usefixtures("second")
def test_ends_without_a_grasp_are_called_what_they_are() -> None:
    grasp = t_shape()
    away = close_many_second(grasp.scene(), np.array([[40.0, 0.0, 0.2, 2.0]]))
    assert ENDINGS[int(away.ending[0])] == "pinched"
    broken = close_many_second(grasp.scene(), np.array([[np.nan, 0.0, 0.0, 1.0]]))
    assert ENDINGS[int(broken.ending[0])] == "diverged"
    brief = close_many_second(grasp.scene(SimConfig(max_time=0.02)), starts_near(grasp, 1, seed=9))
    assert ENDINGS[int(brief.ending[0])] == "timed_out"
    assert len(close_many_second(grasp.scene(), np.zeros((0, 4)))) == 0
    starts = np.full((1, 6), np.nan)
    run = random_attack_second(grasp.scene(), starts, np.ones(1), np.random.default_rng(0))
    assert run.ending.tolist() == [DIVERGED]
    none = random_attack_second(grasp.scene(), starts[:0], np.ones(0), np.random.default_rng(0))
    assert len(none) == 0
    with pytest.raises(InputError, match="above 0"):
        random_attack_second(grasp.scene(), starts, np.zeros(1), np.random.default_rng(0))
    yielding = SimConfig(linkage_compliance=1e-6)
    with pytest.raises(InputError, match="rigid linkage"):
        close_many_second(grasp.scene(yielding), starts_near(grasp, 1, seed=9))


@pytest.mark.parametrize("make", [lambda: on_a_wedge(8.0), lambda: on_a_turned_triangle(0.2)])
def test_it_slides_below_the_least_friction_and_sticks_above(make) -> None:
    scene, placement = make()
    wanted = least_mu(held_at(scene, placement))
    for share, sticks in ((0.97, False), (1.03, True)):
        there = rubbing(scene, share * wanted, SimConfig(max_time=0.3))
        closed = close_many_second(there, opened(scene, placement, OPENED))
        assert stuck(there, closed, 10.0 * SLIPS).tolist() == [sticks]


def test_without_pymunk_the_error_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pymunk", None)
    with pytest.raises(InputError, match=r"pip install 'icage\[second\]'"):
        engine.chipmunk()


def test_nothing_imports_it_before_it_is_asked_for() -> None:
    root = Path(engine.__file__).parents[2]
    for room in ("icage", "sim", "experiments"):
        for path in root.glob(f"{room}/**/*.py"):
            assert not re.search(r"^\s*(import|from) pymunk", path.read_text(), re.MULTILINE), path
