"""Attacks on a held hand: what counts as out, that the stop stops, that the way out works."""

from __future__ import annotations

import functools

import numpy as np
import pytest

from icage.cage import Cage
from icage.errors import InputError
from icage.planner import plan
from sim.attack.guided import GuidedDriver, GuidedPull, object_path
from sim.attack.held import DIVERGED, ESCAPED, HELD, Attacks, attack
from sim.attack.measured_sigma_max import measure
from sim.attack.random import RandomDriver, RandomPull
from sim.attack.rigid_search import CLEAR, clear_poses, search_many, search_tree
from sim.world.hand_in_object import hull_of, separated
from sim.world.held_hand import held_batch, held_model
from sim.world.scene import Scene
from tests.sim.grasps import t_shape


@functools.cache
def t_cage() -> tuple[Scene, Cage]:
    grasp = t_shape()
    return grasp.scene(), plan(grasp.outline, grasp.contacts, grasp.radius)


def targets(count: int) -> np.ndarray:
    scene, cage = t_cage()
    return np.repeat(scene.start_positions(cage.target_placement.as_array()), count, axis=0)


def random_attacks(openings: np.ndarray, seed: int, threads: int, duration: float) -> Attacks:
    scene, _ = t_cage()
    driver = RandomDriver(
        scene, openings, np.random.default_rng(seed), RandomPull(duration=duration)
    )
    return attack(scene, held_model(scene), targets(len(openings)), openings, driver, threads)


def guided_attacks(openings: np.ndarray, seed: int, threads: int = 1) -> Attacks:
    scene, cage = t_cage()
    assert cage.escape_path is not None
    path = object_path(scene, cage.escape_path)
    driver = GuidedDriver(scene, openings, path, np.random.default_rng(seed))
    return attack(scene, held_model(scene), targets(len(openings)), openings, driver, threads)


def test_out_is_what_a_line_separates():
    square = hull_of(np.array([[0, 0], [1, 0], [0.5, 0.2], [1, 1], [0, 1.0]]))
    assert len(square) == 4
    sides = np.roll(square, -1, axis=0) - square
    turns = sides[:, 0] * np.roll(sides, -1, axis=0)[:, 1]
    assert (turns - sides[:, 1] * np.roll(sides, -1, axis=0)[:, 0] > 0).all()  # ccw
    beside = np.array([[1.2, 0.0], [2.0, 0.0], [1.5, 1.0]])
    assert separated(square, beside, 0.19)
    assert not separated(square, beside, 0.21)
    around = np.array([[-0.5, -0.5], [1.5, -0.5], [0.5, 2.0]])
    assert not separated(square, around, 0.01)
    shut = np.full((3, 2), 0.5)
    assert not separated(square, shut, 0.01)
    assert separated(square, shut + [0.0, 0.6], 0.05)


def test_the_way_of_the_object_is_the_way_of_the_hand():
    scene, cage = t_cage()
    assert cage.escape_path is not None
    path = object_path(scene, cage.escape_path)
    unit = scene.object.diameter
    assert path[0, 3] * unit == pytest.approx(cage.sigma_0)
    assert path[:, 3].max() * unit == pytest.approx(cage.escape_path[:, 3].max(), abs=1e-9)
    assert path[-1, 3] == pytest.approx(0.0, abs=1e-9)
    assert (np.diff(path[:, 4]) >= 0.0).all()
    assert np.abs(np.diff(path[:, :4], axis=0)).max() < 0.02  # also where theta wraps round
    slides = path[:, 3, None] * scene.kinematics.lengths
    back = scene.placements(np.column_stack([slides, path[:, :3]]))
    fingers, given = cage.hand.fingers(back), cage.hand.fingers(cage.escape_path)
    for row in given:  # every corner of the path is met
        assert np.abs(fingers - row).max(axis=(1, 2)).min() < 1e-8 * unit


def test_the_stop_stops_and_an_opening_must_be_one():
    scene, cage = t_cage()
    opening = np.array([1.1, 1.3]) * cage.sigma_0 / scene.object.diameter
    run = random_attacks(opening, 0, 1, 2.0)
    assert (run.ending == HELD).all()
    assert (run.rise_max > 0.999).all()
    assert (run.rise_max < 1.001).all()
    assert (run.penetration_max < 1.5e-3).all()
    with pytest.raises(InputError, match="above 0"):
        held_batch(held_model(scene), targets(1), np.array([0.0]), 1)


def test_any_number_of_threads_and_any_neighbours_give_the_same():
    scene, cage = t_cage()
    opening = np.linspace(1.1, 1.4, 4) * cage.sigma_0 / scene.object.diameter
    one, two = (random_attacks(opening, 3, threads, 0.5) for threads in (1, 2))
    fewer = random_attacks(opening[:2], 3, 2, 0.5)
    assert np.array_equal(one.end, two.end)
    assert np.array_equal(one.end[:2], fewer.end)
    assert not np.array_equal(one.end, random_attacks(opening, 4, 2, 0.5).end)


@pytest.mark.slow
def test_the_way_out_works_above_sigma_max_and_not_below():
    scene, cage = t_cage()
    assert cage.sigma_max is not None
    top = cage.sigma_max / scene.object.diameter
    run = guided_attacks(top * np.array([0.998, 0.998, 1.002, 1.002]), 1)
    assert run.ending.tolist() == [HELD, HELD, ESCAPED, ESCAPED]
    assert run.penetration_max.max() < 1e-3


def led_in_vain(retries: int) -> np.ndarray:
    """(steps, 4) wrench and motor while an object that nothing moves is led, till it is held."""
    scene, cage = t_cage()
    assert cage.escape_path is not None
    path = object_path(scene, cage.escape_path)
    openings = np.array([1.1 * cage.sigma_0 / scene.object.diameter])
    rng, pull = np.random.default_rng(0), GuidedPull(retries=retries)
    driver = GuidedDriver(scene, openings, path, rng, pull)
    one, wrench, motor = np.arange(1), np.zeros((1, 3)), np.zeros(1)
    seen: list[np.ndarray] = []
    for step in range(driver.max_steps):
        given_up = driver.drive(one, step, targets(1), wrench, motor)
        seen.append(np.append(wrench[0], motor))
        if len(given_up):
            return np.array(seen)
    raise AssertionError("never held")


def test_what_is_stuck_comes_again_before_it_is_held():
    once, thrice = led_in_vain(0), led_in_vain(2)
    patience = GuidedPull().patience / t_cage()[0].config.time_step
    assert patience < len(once) < 2.0 * patience
    assert 3.0 * patience < len(thrice) < 6.0 * patience
    assert np.array_equal(once, thrice[: len(once)])  # till then it is the same attack
    assert np.hypot(thrice[:, 0], thrice[:, 1]).max() < 300.0 * (0.5 + 0.1 * np.sqrt(2.0))


def threshold(openings: np.ndarray, _rng: np.random.Generator) -> Attacks:
    """Attacks that escape from 0.7314 on."""
    count = len(openings)
    ending = np.where(openings >= 0.7314, ESCAPED, HELD)
    zeros = np.zeros(count)
    steps = np.ones(count, dtype=np.int64)
    return Attacks(openings, ending, steps, zeros, zeros + 1.0, np.zeros((count, 6)))


def test_the_interval_closes_in_on_where_escapes_begin():
    rng = np.random.default_rng(0)
    found = measure(threshold, (0.5, 1.0), rng, rounds=5, sections=4, repeats=2)
    assert found.low < 0.7314 <= found.high
    assert found.high - found.low == pytest.approx(0.5 / 5**5, rel=1e-6)
    assert found.escaped + found.held == found.attacks
    known = threshold(np.array([0.72, 0.74]), rng)
    sooner = measure(threshold, (0.5, 1.0), rng, rounds=1, sections=2, repeats=1, known=[known])
    assert (sooner.low, sooner.high) == (0.72, 0.74)
    assert sooner.attacks == 6
    never = measure(threshold, (0.5, 0.7), rng, rounds=5, sections=4, repeats=2)
    assert (never.low, never.high, never.escaped) == (0.7, np.inf, 0)
    always = measure(threshold, (0.8, 0.9), rng, rounds=5, sections=4, repeats=2)
    assert (always.low, always.high) == (0.0, 0.8)
    with pytest.raises(InputError, match="no width"):
        measure(threshold, (0.9, 0.9), rng, rounds=1, sections=1, repeats=1)


def test_a_broken_run_is_no_success():
    scene, cage = t_cage()
    opening = np.full(2, 1.1 * cage.sigma_0 / scene.object.diameter)
    starts = targets(2)
    starts[1, 3] = 1e12
    driver = RandomDriver(scene, opening, np.random.default_rng(0), RandomPull(duration=0.05))
    run = attack(scene, held_model(scene), starts, opening, driver, 1)
    assert run.ending.tolist() == [HELD, DIVERGED]
    assert (run.escapes, run.diverged) == (0, 1)


def test_a_rigid_hand_is_left_above_sigma_max_only():
    scene, cage = t_cage()
    assert cage.sigma_max is not None
    top = cage.sigma_max / scene.object.diameter
    inside = random_attacks(np.full(4, 0.99 * top), 0, 2, 2.0).end
    assert len(clear_poses(scene, inside, 0.99 * top)) == 4
    assert not len(clear_poses(scene, inside, 0.5 * top))
    openings = top * np.array([0.998, 1.004])
    run = search_many(scene, inside, openings, np.random.default_rng(0))
    assert run.ending.tolist() == [HELD, ESCAPED]
    assert (run.penetration_max == CLEAR).all()
    again = search_many(scene, inside, openings[1:], np.random.default_rng(1))
    assert again.escapes == 1
    nowhere = search_tree(scene, np.zeros((0, 3)), top, np.random.default_rng(0))
    assert (nowhere.escaped, nowhere.nodes) == (False, 0)
