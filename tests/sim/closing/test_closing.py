"""Closings: accuracy, determinism, and failures that must not pass for success."""

from __future__ import annotations

from dataclasses import fields

import mujoco
import numpy as np
import pytest

from icage.hand import Placement
from icage.outline import Outline
from sim.closing.batch import close_many
from sim.closing.judge import OUTCOMES, judge
from sim.closing.one import close, data_at
from sim.closing.outcome import ClosingOutcomes
from sim.closing.step_check import ENDINGS
from sim.world.config import SimConfig
from sim.world.scene import Scene
from tests.sim.grasps import KnownGrasp, disc_case, l_shape, starts_near, t_shape, triangle


def assert_identical(one: ClosingOutcomes, other: ClosingOutcomes) -> None:
    for part in fields(ClosingOutcomes):
        a, b = getattr(one, part.name), getattr(other, part.name)
        assert a.tobytes() == b.tobytes(), f"{part.name} differs"


@pytest.mark.parametrize(
    ("grasp", "count"),
    [(t_shape(), 60), (l_shape(), 60), (disc_case("disc_hammer"), 16), (disc_case("disc_Y"), 16)],
    ids=["T", "L", "hammer", "Y"],
)
def test_every_start_near_the_target_reaches_it(grasp: KnownGrasp, count: int) -> None:
    _check_guarantee(grasp, close_many(grasp.scene(), starts_near(grasp, count, seed=4)))


@pytest.mark.slow
@pytest.mark.parametrize("grasp", [t_shape(), l_shape()], ids=["T", "L"])
def test_a_thousand_wide_starts_reach_the_target(grasp: KnownGrasp) -> None:
    """Openings up to 1.5, half of the way to sigma_first of the point-finger cases."""
    starts = starts_near(grasp, 1000, seed=5, opening=1.5, shift=0.06, turn=0.25)
    _check_guarantee(grasp, close_many(grasp.scene(), starts))


def _check_guarantee(grasp: KnownGrasp, closings: ClosingOutcomes) -> None:
    verdicts = judge(closings, [grasp], grasp.outline)
    assert verdicts.counts()["target"] == len(closings)
    assert verdicts.position_error.max() <= 1e-4
    assert verdicts.angle_error.max() <= 1e-3
    assert closings.penetration_max.max() <= 1e-3
    assert closings.penetration_rest.max() <= 1e-5
    assert closings.shape_error_max.max() <= 1e-5
    assert closings.sigma_rise_max.max() <= 1.0
    assert (closings.finger_forces > 0.01).all()  # the hand still presses, with every finger
    assert (closings.contacts >= 3).all()


def test_batch_is_the_plain_loop_bit_for_bit_at_any_number_of_threads() -> None:
    grasp = l_shape()
    scene = grasp.scene()
    starts = starts_near(grasp, 12, seed=6, opening=1.3)
    plain = [close(scene, Placement(*row)) for row in starts.tolist()]
    one = close_many(scene, starts, threads=1)
    assert_identical(one, close_many(scene, starts, threads=2))
    for k, alone in enumerate(plain):
        for part in fields(alone):
            mine, batched = getattr(alone, part.name), getattr(one[k], part.name)
            assert np.array_equal(mine, batched), f"{part.name} differs"
    again = close_many(grasp.scene(), starts[5:6], threads=1)
    assert again.end.tobytes() == one.end[5:6].tobytes()  # a fresh scene, without neighbours


def test_looks_do_not_change_the_motion() -> None:
    grasp = t_shape()
    scene = grasp.scene()
    start = scene.start_positions(starts_near(grasp, 1, seed=7))[0]
    ends = []
    for looks in (False, True):
        model = scene.spec(looks).compile()
        data = mujoco.MjData(model)
        data.qpos[:], data.ctrl[:] = start, scene.closing_force
        mujoco.mj_step(model, data, 400)
        ends.append(data.qpos.tobytes())
    assert ends[0] == ends[1]


def test_the_unit_and_place_of_the_case_do_not_matter() -> None:
    grasp = l_shape()
    starts = starts_near(grasp, 6, seed=8)
    home = close_many(grasp.scene(), starts)
    for scale, shift in ((1e-3, 0.0), (1e3, 2e4)):
        moved = KnownGrasp(
            Outline(grasp.outline.vertices * scale + shift),
            grasp.radius * scale,
            grasp.contacts * scale + shift,
        )
        rows = starts * [scale, scale, 1.0, scale] + [shift, shift, 0.0, 0.0]
        away = close_many(moved.scene(), rows)
        found = judge(away, [moved], moved.outline)
        assert found.counts()["target"] == len(starts)
        np.testing.assert_allclose(away.end[:, 3] / scale, home.end[:, 3], rtol=1e-8)


def test_an_empty_hand_shuts_and_counts_as_escaped() -> None:
    grasp = t_shape()
    starts = np.array([[40.0, 0.0, 0.2, sigma] for sigma in np.linspace(2.0, 2.01, 8)])
    closings = close_many(grasp.scene(), starts)
    assert {ENDINGS[ending] for ending in closings.ending} == {"pinched"}
    assert judge(closings, [grasp], grasp.outline).counts()["escaped"] == 8
    assert all(closings[i].end.sigma >= 0.0 for i in range(8))  # the last step overshoots zero


def test_a_closing_that_is_cut_short_has_timed_out() -> None:
    grasp = t_shape()
    scene = grasp.scene(SimConfig(max_time=0.02))
    closings = close_many(scene, starts_near(grasp, 3, seed=9))
    assert closings.steps.tolist() == [20, 20, 20]
    assert judge(closings, [grasp], grasp.outline).counts()["timed_out"] == 3


@pytest.mark.parametrize("kind", ["explosion", "not a number"])
def test_divergence_is_seen_and_never_a_success(kind: str, capfd: pytest.CaptureFixture) -> None:
    """An engine left to itself resets an exploded trial to where it began, silently."""
    grasp = t_shape()
    starts = np.repeat(grasp.target.as_array()[None, :], 3, axis=0)
    config = SimConfig()
    if kind == "explosion":
        config = SimConfig(time_step=1.0, drive_force=1e13, finger_damping=1e-3, max_time=50.0)
        starts[:, 3] *= 1.1
    else:
        starts[1, 0] = np.nan
    scene = grasp.scene(config)
    closings = close_many(scene, starts)
    verdicts = judge(closings, [grasp], grasp.outline)
    codes = [OUTCOMES[int(k)] for k in verdicts.outcome]
    expected = ["diverged"] * 3 if kind == "explosion" else ["target", "diverged", "target"]
    assert codes == expected
    assert close(scene, Placement(*starts[0])).ending == ENDINGS[int(closings.ending[0])]
    assert capfd.readouterr() == ("", "")


def test_no_log_file_is_left_behind(tmp_path: object, monkeypatch: pytest.MonkeyPatch) -> None:
    from pathlib import Path

    folder = Path(str(tmp_path))
    monkeypatch.chdir(folder)
    grasp = t_shape()
    starts = np.array([[np.nan, 0.0, 0.0, 1.0]])
    close_many(grasp.scene(), starts)
    assert list(folder.iterdir()) == []


def test_no_trials_are_no_trials() -> None:
    grasp = t_shape()
    closings = close_many(grasp.scene(), np.zeros((0, 4)))
    assert len(closings) == 0
    assert sum(judge(closings, [grasp], grasp.outline).counts().values()) == 0


def test_progress_counts_every_trial() -> None:
    grasp = t_shape()
    told: list[int] = []
    close_many(grasp.scene(), starts_near(grasp, 9, seed=10), progress=told.append)
    assert sum(told) == 9


def test_three_edges_obey_sigma_0_over_cos_theta() -> None:
    """Turning about the concurrency point with all fingers touching. [docs/theory.md, Sec. 2.6]"""
    grasp = triangle()
    scene = grasp.scene()
    place = grasp.target.as_array()
    angle = 0.35
    d = complex(place[0], place[1]) * np.exp(1j * angle) / np.cos(angle)
    start = np.array([[d.real, d.imag, place[2] + angle, place[3] / np.cos(angle) * (1 + 1e-9)]])
    data = data_at(scene, scene.start_positions(start)[0])
    mujoco.mj_step(scene.model, data, 100)  # the fingers hit and settle on the edges
    seen = 0
    for _ in range(600):
        mujoco.mj_step(scene.model, data)
        now = scene.placements(data.qpos)[0]
        theta = now[2] - place[2]
        if data.ncon == 3 and theta > 0.01:
            assert now[3] * np.cos(theta) == pytest.approx(place[3], rel=2e-5)
            seen += 1
    assert seen > 30


def test_friction_jams_a_three_edge_grasp_within_its_cone() -> None:
    """|theta| <= atan(mu) + 0.01 at rest, and the jam is no success. [docs/physics.md, Friction]"""
    grasp, mu = triangle(), 0.1
    scene = grasp.scene(SimConfig(friction=mu, max_time=2.0))
    assert (scene.model.geom_condim[scene.model.geom_contype > 0] == 3).all()
    closings = close_many(scene, starts_near(grasp, 12, seed=11, turn=0.3, opening=1.1))
    verdicts = judge(closings, [grasp], grasp.outline, friction=True)
    assert verdicts.angle_error.max() <= np.arctan(mu) + 0.01
    assert verdicts.angle_error.max() > 1e-2
    assert verdicts.counts()["target"] < len(closings)
    assert verdicts.counts()["unmatched"] == 0


def test_implicitfast_agrees_with_the_new_integrator() -> None:
    """``discrete`` is under development upstream: an old integrator must find the same grasp."""
    grasp = l_shape()
    scene = grasp.scene()
    spec = scene.spec(visuals=False)
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.timestep = 2e-4
    for joint in spec.joints:
        if joint.name.startswith("finger"):
            joint.damping = [250.0, 0.0, 0.0]
    for item in (*spec.geoms, *spec.equalities):
        item.solref = [4e-4, 1.0]
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qpos[:] = scene.start_positions(starts_near(grasp, 1, seed=12))[0]
    data.ctrl[:] = scene.closing_force
    mujoco.mj_step(model, data, 10_000)
    end = scene.placements(data.qpos)[0]
    np.testing.assert_allclose(end, grasp.target.as_array(), atol=2e-4 * grasp.outline.diameter)


def test_scene_is_what_its_arguments_say() -> None:
    grasp = t_shape()
    scene = Scene(grasp.outline, grasp.hand, grasp.radius, SimConfig())
    assert scene.model.geom("finger_2_tip").size[0] == grasp.radius / grasp.outline.diameter
    assert scene.model.opt.timestep == SimConfig().time_step
