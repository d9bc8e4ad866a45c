"""Closings in worlds of their own: the same bits in any company, and physics as on paper."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import mujoco
import numpy as np
import pytest
import shapely

from icage.arrays import FloatArray, IntArray
from icage.errors import InputError
from sim.closing import varied_shapes as varied_closing
from sim.closing.approach import approached
from sim.closing.batch import close_many
from sim.closing.judge import grasp_errors
from sim.closing.outcome import ClosingOutcomes
from sim.closing.step_check import ENDINGS
from sim.closing.varied import Worlds, expand, mean_distance, own_model, settings
from sim.closing.varied_shapes import VariedOutcomes, close_varied
from sim.world.config import SimConfig
from sim.world.contact_forces import finger_forces
from sim.world.scene import Scene
from tests.sim.grasps import KnownGrasp, l_shape, shipped, starts_near, t_shape, triangle


def scene_of(grasp: KnownGrasp, **changed: Any) -> Scene:
    config = SimConfig(**{"max_time": 5.0, **changed})
    return Scene(grasp.outline, grasp.hand, grasp.radius, config, instrumented=True)


def close(
    scene: Scene, starts: FloatArray, worlds: Worlds | None = None, threads: int = 1
) -> VariedOutcomes:
    count = len(starts)
    which = np.zeros(count, dtype=np.int64)
    return close_varied([scene], which, starts, worlds or Worlds.usual(count), threads)


def assert_identical(one: VariedOutcomes, other: VariedOutcomes) -> None:
    assert one.peak_force.tobytes() == other.peak_force.tobytes()
    for part in fields(ClosingOutcomes):
        a, b = getattr(one.closings, part.name), getattr(other.closings, part.name)
        assert a.tobytes() == b.tobytes(), f"{part.name} differs"


def picked(found: VariedOutcomes, rows: IntArray) -> VariedOutcomes:
    return VariedOutcomes(found.closings.picked(rows), found.peak_force[rows])


def wild(count: int, seed: int) -> Worlds:
    """Everything varies, and every fifth world is as usual in something."""
    rng = np.random.default_rng(seed)
    low = {"friction": 0.0, "table_friction": 0.0, "softness": 1.0}
    high = {"friction": 0.6, "table_friction": 0.3, "softness": 20.0}
    ranges = {
        **{name: (low[name], high[name]) for name in low},
        **dict.fromkeys(("gravity_x", "gravity_y"), (-0.2, 0.2)),
        **dict.fromkeys(("com_x", "com_y"), (-0.1, 0.1)),
        **dict.fromkeys(("mass", "inertia", "speed", "force"), (0.3, 3.0)),
    }
    worlds = Worlds(**{f.name: rng.uniform(*ranges[f.name], count) for f in fields(Worlds)})
    usual = Worlds.usual(1)
    for k, name in enumerate(ranges):
        getattr(worlds, name)[k % 5 :: 5] = getattr(usual, name)[0]
    worlds.gravity_y[worlds.gravity_x == 0.0] = 0.0  # level tables too
    return worlds


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


def endings(found: VariedOutcomes) -> list[str]:
    return [ENDINGS[int(code)] for code in found.closings.ending]


@pytest.mark.parametrize("grasp", [t_shape(), l_shape(), triangle()], ids=["T", "L", "triangle"])
def test_usual_worlds_end_where_a_replay_ends(grasp: KnownGrasp):
    starts = starts_near(grasp, 26, seed=1)
    plain = close_many(grasp.scene(), starts, threads=1)
    mine = close(scene_of(grasp), starts).closings
    size = grasp.outline.diameter
    off = np.abs(mine.end - plain.end) / [size, size, 1.0, size]
    assert off.max() <= 1e-5
    assert mine.ending.tolist() == plain.ending.tolist()
    assert np.abs(mine.steps - plain.steps).max() <= varied_closing.LOOK_EVERY


@pytest.mark.parametrize("grasp", [t_shape(), triangle()], ids=["T", "triangle"])
def test_no_company_changes_a_bit(grasp: KnownGrasp, monkeypatch: pytest.MonkeyPatch):
    """One batch with its model's fields expanded = own models = alone = any threads and order."""
    scene = scene_of(grasp, friction=1.0, max_time=2.0)
    count = 30
    assert count >= varied_closing.TOGETHER
    starts, worlds = starts_near(grasp, count, seed=2), wild(count, seed=3)
    assert all(len(np.unique(getattr(worlds, f.name))) > 10 for f in fields(Worlds))
    together = close(scene, starts, worlds)
    assert "settled" in endings(together)
    assert_identical(together, close(scene, starts, worlds, threads=2))
    order = np.random.default_rng(4).permutation(count)
    assert_identical(picked(together, order), close(scene, starts[order], worlds[order]))
    for i in range(0, count, 7):
        row = slice(i, i + 1)
        assert_identical(picked(together, np.array([i])), close(scene, starts[row], worlds[row]))
    monkeypatch.setattr(varied_closing, "TOGETHER", count + 1)
    assert_identical(together, close(scene, starts, worlds))


def test_objects_of_their_own_run_in_one_batch(monkeypatch: pytest.MonkeyPatch):
    """Scenes of two layouts, one of them rare and one common, in any mixture."""
    grasps = [t_shape(), l_shape(), triangle()]
    scenes = [scene_of(grasp, friction=1.0) for grasp in grasps]
    which = np.random.default_rng(5).permutation(np.repeat([0, 1, 2], [25, 4, 3]))
    starts = np.empty((len(which), 4))
    for number, grasp in enumerate(grasps):
        here = np.flatnonzero(which == number)
        starts[here] = starts_near(grasp, len(here), seed=6)
    worlds = wild(len(which), seed=7)
    mixed = close_varied(scenes, which, starts, worlds)
    for number, scene in enumerate(scenes):
        rows = np.flatnonzero(which == number)
        assert_identical(picked(mixed, rows), close(scene, starts[rows], worlds[rows]))
    backwards = close_varied(scenes[::-1], 2 - which[::-1], starts[::-1], worlds[::-1])
    assert_identical(picked(mixed, np.arange(len(which))[::-1]), backwards)
    monkeypatch.setattr(varied_closing, "TOGETHER", 1)
    assert_identical(mixed, close_varied(scenes, which, starts, worlds, threads=2))


def test_no_trials_are_no_trials():
    none = close(scene_of(t_shape()), np.zeros((0, 4)))
    assert len(none.closings) == len(none.peak_force) == 0


def test_a_setting_is_one_value_a_trial_in_a_batch_and_on_own_models():
    scene, worlds = scene_of(t_shape(), friction=1.0), wild(6, seed=8)
    changes = list(settings(scene, worlds))
    assert {one.name for one in changes} >= {"body_mass", "opt.gravity", "geom_friction"}
    batch = varied_closing.Batch(scene.model, nsim=6, nthread=1)
    expand(batch, changes)
    for i in range(6):
        mine = own_model(scene.model, changes, i)
        body = mine.body("object")
        assert body.mass[0] == worlds.mass[i]
        spin = worlds.mass[i] * worlds.inertia[i] * scene.object.gyration_squared
        np.testing.assert_allclose(body.inertia, spin, rtol=1e-14)
        assert body.ipos[:2].tolist() == [worlds.com_x[i], worlds.com_y[i]]
        for name in ("dof_invweight0", "body_subtreemass", "dof_frictionloss", "geom_friction"):
            assert np.array_equal(batch.expand(name)[i], getattr(mine, name)), name
    assert scene.model.body("object").mass[0] == 1.0  # the compiled one is left alone
    assert list(settings(scene_of(t_shape()), Worlds.usual(3))) == []


def test_friction_in_a_scene_compiled_without_is_an_error():
    worlds = Worlds.usual(2)
    worlds.friction[1] = 0.3
    with pytest.raises(InputError, match="compiled without"):
        close(scene_of(t_shape()), starts_near(t_shape(), 2, seed=1), worlds)


# ---------------------------------------------------------------------------- tables


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


# ---------------------------------------------------------------------------- fingers


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


# ---------------------------------------------------------------------------- failures


@pytest.mark.parametrize("together", [1, 99], ids=["expanded", "own models"])
@pytest.mark.filterwarnings("ignore:invalid value:RuntimeWarning")
def test_a_start_that_is_no_number_has_diverged(
    together: int, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
):
    monkeypatch.setattr(varied_closing, "TOGETHER", together)
    grasp = t_shape()
    scene, starts = scene_of(grasp), starts_near(grasp, 6, seed=14)
    good = close(scene, starts)
    bad = starts.copy()
    bad[1, 0], bad[3, 3], bad[4, 2] = np.nan, np.nan, np.inf
    found = close(scene, bad)
    planted = np.array([1, 3, 4])
    assert [endings(found)[i] for i in planted] == ["diverged"] * 3
    others = np.setdiff1d(np.arange(6), planted)
    assert_identical(picked(found, others), picked(good, others))
    assert capfd.readouterr() == ("", "")


BLASTS = [
    {"force": 1e13, "speed": 1e13},
    {"gravity_x": 1e20},
    {"force": np.inf},
    {"mass": -1.0},
    {"com_x": 1e12},
]


@pytest.mark.parametrize("together", [1, 99], ids=["expanded", "own models"])
def test_an_exploding_setting_has_diverged(
    together: int, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
):
    monkeypatch.setattr(varied_closing, "TOGETHER", together)
    grasp = t_shape()
    scene, starts = scene_of(grasp), starts_near(grasp, 3 + len(BLASTS), seed=15)
    worlds = Worlds.usual(len(starts))
    good = close(scene, starts)
    for i, blast in enumerate(BLASTS):
        for name, value in blast.items():
            getattr(worlds, name)[i + 1] = value
    found = close(scene, starts, worlds)
    planted = np.arange(1, 1 + len(BLASTS))
    assert [endings(found)[i] for i in planted] == ["diverged"] * len(planted)
    others = np.setdiff1d(np.arange(len(starts)), planted)
    assert_identical(picked(found, others), picked(good, others))
    assert capfd.readouterr() == ("", "")


def test_what_diverges_in_the_middle_has_diverged(monkeypatch: pytest.MonkeyPatch):
    """A trial poisoned after thirty steps, while its neighbours run on in the same call."""
    grasp = t_shape()
    scene, starts = scene_of(grasp, computed_contacts=0), starts_near(grasp, 5, seed=16)
    good = close(scene, starts)

    class Poisoned:
        def __init__(self, *given: Any, **named: Any) -> None:
            self._inner, self._calls = varied_closing_batch(*given, **named), 0

        def __getattr__(self, name: str) -> Any:
            return getattr(self._inner, name)

        def __setattr__(self, name: str, value: Any) -> None:
            if name.startswith("_"):
                object.__setattr__(self, name, value)
            else:
                setattr(self._inner, name, value)

        def step(self, *given: Any, **named: Any) -> None:
            self._calls += 1
            if self._calls == 7:
                velocities = np.array(self._inner.qvel)
                velocities[2] = np.nan
                self._inner.qvel = velocities
            self._inner.step(*given, **named)

    varied_closing_batch = varied_closing.Batch
    monkeypatch.setattr(varied_closing, "Batch", Poisoned)
    found = close(scene, starts)
    assert endings(found)[2] == "diverged"
    assert found.closings.steps[2] == 7 * varied_closing.LOOK_EVERY
    others = np.array([0, 1, 3, 4])
    assert_identical(picked(found, others), picked(good, others))
