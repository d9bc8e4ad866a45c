"""One tendon, one motor, and a linkage that keeps the triangle: laws of the hand."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
import pytest

from icage.errors import InputError
from icage.hand import HandShape
from sim.world.config import SimConfig
from sim.world.hand_file import hand_file, hand_mjcf
from sim.world.hand_model import LEAST_RADIUS, HandKinematics, build_hand

SHAPES = [
    HandShape.from_angles_deg(33.0, 130.0),
    HandShape.from_angles_deg(60.0, 120.0),
    HandShape.from_angles_deg(8.0, 172.0),
    HandShape.from_angles_deg(80.0, 95.0),
]


def model_of(shape: HandShape, **changes: Any) -> Any:
    return build_hand(shape, 0.03, SimConfig(**changes)).compile()


def slides(shape: HandShape, sigma: float) -> Any:
    return sigma * HandKinematics(shape).lengths


@pytest.mark.parametrize("shape", SHAPES)
def test_one_motor_and_it_acts_on_the_tendon(shape: HandShape) -> None:
    model = model_of(shape)
    assert model.nu == 1
    assert model.nv == 3
    assert model.actuator("motor").trntype == mujoco.mjtTrn.mjTRN_TENDON
    assert model.actuator("motor").trnid[0] == model.tendon("drive").id
    data = mujoco.MjData(model)
    data.qpos[:] = slides(shape, 0.4)
    data.ctrl[0] = -50.0
    mujoco.mj_forward(model, data)
    pull = -50.0 * HandKinematics(shape).tendon_coefficients
    np.testing.assert_allclose(data.qfrc_actuator, pull, rtol=1e-12)


@pytest.mark.parametrize("shape", SHAPES)
def test_tendon_length_is_sigma_and_fingers_form_the_triangle(shape: HandShape) -> None:
    model = model_of(shape)
    data = mujoco.MjData(model)
    for sigma in (0.05, 0.4, 1.3):
        data.qpos[:] = slides(shape, sigma)
        mujoco.mj_forward(model, data)
        assert data.ten_length[model.tendon("drive").id] == pytest.approx(sigma, rel=1e-12)
        tips = np.array([data.body(f"finger_{k}").xpos[:2] for k in (1, 2, 3)])
        side = tips[1] - tips[0]
        np.testing.assert_allclose(side, [sigma, 0.0], atol=1e-12)
        third = complex(*(tips[2] - tips[0])) / complex(*side)
        assert third == pytest.approx(shape.z_3, rel=1e-12)


@pytest.mark.parametrize("shape", SHAPES)
def test_linkage_holds_the_shape_against_a_push_on_one_finger(shape: HandShape) -> None:
    model = model_of(shape)
    data = mujoco.MjData(model)
    data.qpos[:] = slides(shape, 0.5)
    data.ctrl[0] = -300.0
    data.qfrc_applied[0] = 400.0
    mujoco.mj_step(model, data, 300)
    mujoco.mj_forward(model, data)  # lengths at the last position
    sigma = float(data.ten_length[model.tendon("drive").id])
    assert abs(sigma - 0.5) > 1e-3
    assert np.abs(data.qpos - slides(shape, sigma)).max() < 1e-5


def test_tendon_alone_is_a_differential_and_loses_the_shape() -> None:
    shape = SHAPES[0]
    spec = build_hand(shape, 0.03, SimConfig())
    for link in list(spec.equalities):
        spec.delete(link)
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qpos[:] = slides(shape, 0.5)
    data.ctrl[0] = -300.0
    data.qfrc_applied[0] = 400.0
    mujoco.mj_step(model, data, 300)
    mujoco.mj_forward(model, data)  # lengths at the last position
    sigma = float(data.ten_length[0])
    assert np.abs(data.qpos - slides(shape, sigma)).max() > 1e-2


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("compliance", [1e-5, 1e-7, 1e-9])
def test_a_compliant_linkage_yields_by_force_over_stiffness(
    shape: HandShape, compliance: float
) -> None:
    model = build_hand(
        shape, 0.03, SimConfig(linkage_compliance=compliance), visuals=False
    ).compile()
    assert model.nu == 1
    assert model.neq == 0
    assert [model.tendon(k).name for k in range(model.ntendon)] == [
        *(f"linkage_{k}" for k in (1, 2, 3)),
        "drive",
    ]
    data = mujoco.MjData(model)
    data.qpos[:] = slides(shape, 0.5)
    data.ctrl[0] = -300.0
    data.qfrc_applied[:] = [400.0, -30.0, 70.0]
    mujoco.mj_step(model, data, 400)
    mujoco.mj_forward(model, data)
    off = data.qpos - slides(shape, float(data.ten_length[model.tendon("drive").id]))
    np.testing.assert_allclose(data.ten_length[:3], off, rtol=1e-6, atol=1e-15)
    along = HandKinematics(shape).lengths / HandKinematics(shape).spread
    push = data.qfrc_applied - along * (along @ data.qfrc_applied)
    np.testing.assert_allclose(off, compliance * push, rtol=1e-4, atol=1e-6 * abs(off).max())


def test_yield_of_an_equilateral_hand_by_hand() -> None:
    """A push F on finger 1: it yields 2/3 F / K, and the others 1/3 F / K the other way."""
    shape = HandShape.from_angles_deg(60.0, 120.0)
    assert HandKinematics(shape).shape_projector[0] == pytest.approx([2 / 3, -1 / 3, -1 / 3])
    model = model_of(shape, linkage_compliance=1e-6)
    data = mujoco.MjData(model)
    data.qpos[:] = slides(shape, 0.5)
    data.qfrc_applied[0] = 300.0
    mujoco.mj_step(model, data, 200)
    mujoco.mj_forward(model, data)
    assert data.ten_length[:3] == pytest.approx([2e-4, -1e-4, -1e-4], rel=1e-6)


def test_the_linkage_is_rigid_unless_told_otherwise() -> None:
    model, same = model_of(SHAPES[0]), model_of(SHAPES[0], linkage_compliance=0.0)
    assert (model.neq, model.ntendon) == (2, 2)  # the drive, and the cable to be seen
    assert not model.tendon_stiffness.any()
    ends: list[bytes] = []
    for one in (model, same):
        data = mujoco.MjData(one)
        data.qpos[:], data.ctrl[0], data.qfrc_applied[0] = slides(SHAPES[0], 0.5), -300.0, 400.0
        mujoco.mj_step(one, data, 300)
        ends.append(data.qpos.tobytes())
    assert ends[0] == ends[1]


def test_free_speed_and_force_limit_do_not_depend_on_the_labels() -> None:
    shape = HandShape.from_angles_deg(20.0, 100.0)
    for first in range(3):
        turned = shape.relabelled(first)
        kinematics = HandKinematics(turned)
        model = model_of(turned)
        data = mujoco.MjData(model)
        data.qpos[:] = kinematics.lengths / kinematics.spread
        data.ctrl[0] = -1e9  # the limit, not this, counts
        mujoco.mj_step(model, data, 50)
        config = SimConfig()
        assert np.linalg.norm(data.qfrc_actuator) == pytest.approx(config.drive_force, rel=1e-9)
        assert np.linalg.norm(data.qvel) == pytest.approx(config.free_speed, rel=1e-3)


def test_point_fingers_are_refused() -> None:
    with pytest.raises(InputError, match="radius above 0"):
        build_hand(SHAPES[0], 0.0, SimConfig())


@pytest.mark.parametrize(
    ("radius", "mass", "words"),
    [
        (1e-5, 0.2, "simulated fingers need 2e-05 or more"),
        (1e-300, 0.2, "simulated fingers need 2e-05 or more"),
        (0.03, 1e-12, "moment of inertia of 3.6e-16"),
        (2e-5, 1e-6, "moment of inertia of 1.6e-16"),
        (0.03, 0.0, "moment of inertia of 0;"),
    ],
)
def test_fingers_that_the_engine_would_not_take_are_refused(
    radius: float, mass: float, words: str
) -> None:
    with pytest.raises(InputError, match=words):
        build_hand(SHAPES[0], radius, SimConfig(finger_mass=mass))


@pytest.mark.parametrize(
    ("radius", "mass"), [(LEAST_RADIUS, 0.2), (0.03, 1e-11), (LEAST_RADIUS, 2e-5)]
)
def test_the_engine_takes_the_least_fingers(radius: float, mass: float) -> None:
    model = build_hand(SHAPES[0], radius, SimConfig(finger_mass=mass)).compile()
    assert model.nv == 3


def test_shipped_mjcf_is_up_to_date_and_loads() -> None:
    assert hand_file().read_text(encoding="utf-8") == hand_mjcf()
    model = mujoco.MjModel.from_xml_path(str(hand_file()))
    assert model.nu == 1
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("open").id)
    mujoco.mj_forward(model, data)
    assert data.ten_length[model.tendon("drive").id] == pytest.approx(0.3, abs=1e-6)


@pytest.mark.parametrize(
    "change",
    [
        {"time_step": 0.0},
        {"drive_force": -1.0},
        {"friction": -0.1},
        {"linkage_compliance": -1e-9},
        {"linkage_compliance": float("inf")},
    ],
)
def test_impossible_settings_are_refused(change: dict[str, float]) -> None:
    with pytest.raises(InputError, match=next(iter(change))):
        SimConfig(**change)  # type: ignore[arg-type]
