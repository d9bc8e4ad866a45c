"""The object's moments, the border between frames, and laws every compiled scene obeys."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from icage.hand import HandShape
from icage.outline import Outline
from sim.world.config import SimConfig
from sim.world.object_model import HALF_HEIGHT, NormalObject, bipyramid, polar_moment
from sim.world.scene import Scene
from tests.sim.grasps import KnownGrasp, case_outline, l_shape, shipped, t_shape, triangle

GRASPS = [t_shape(), l_shape(), triangle()]
SIZES = {
    "nbody": "body", "njnt": "joint", "ngeom": "geom", "nsite": "site", "ncam": "camera",
    "nlight": "light", "nmesh": "mesh", "ntendon": "tendon", "nu": "actuator", "neq": "equality",
}  # fmt: skip


@pytest.mark.parametrize("grasp", GRASPS)
@pytest.mark.parametrize("visuals", [False, True])
def test_every_element_is_named_and_nothing_warns(grasp: KnownGrasp, visuals: bool) -> None:
    model = grasp.scene().spec(visuals).compile()
    for size, kind in SIZES.items():
        for k in range(getattr(model, size)):
            object_type = getattr(mujoco.mjtObj, f"mjOBJ_{kind.upper()}")
            assert mujoco.mj_id2name(model, object_type, k), f"{kind} {k} has no name"
    assert model.nu == 1
    assert (model.geom_margin == 0).all()
    touching = model.geom_contype > 0
    assert (model.geom_condim[touching] == 1).all()
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, 5)
    assert not any(warning.number for warning in data.warning)


def test_moments_of_a_rectangle() -> None:
    a, b = 3.0, 1.0
    box = np.array([[0, 0], [a, 0], [a, b], [0, b]]) - [a / 2, b / 2]
    assert polar_moment(box) == pytest.approx(a * b * (a * a + b * b) / 12.0, rel=1e-14)


def test_moment_agrees_with_a_monte_carlo_free_sum_over_triangles() -> None:
    outline, _, _ = case_outline("handsaw_best")
    thing = NormalObject(outline)
    triangles = shapely.get_parts(
        shapely.constrained_delaunay_triangles(shapely.Polygon(thing.vertices))
    )
    total = 0.0
    for part in triangles:
        a, b, c = shapely.get_coordinates(part)[:3]
        middles = np.array([(a + b) / 2, (b + c) / 2, (c + a) / 2])
        total += part.area * (middles**2).sum() / 3.0  # exact for squares
    assert thing.gyration_squared * shapely.Polygon(thing.vertices).area == pytest.approx(total)


def test_compiled_object_has_the_stated_inertia() -> None:
    scene = l_shape().scene()
    body = scene.model.body("object")
    assert body.mass[0] == 1.0
    np.testing.assert_allclose(body.inertia, scene.object.gyration_squared, rtol=1e-12)
    np.testing.assert_allclose(body.ipos, 0.0, atol=1e-15)


def test_solid_cuts_the_plane_in_its_piece() -> None:
    piece = np.array([[0.0, 0.0], [1.0, 0.0], [1.2, 0.7], [0.4, 1.0]])
    solid = bipyramid(piece)
    assert solid.is_watertight
    assert solid.is_convex
    area = shapely.Polygon(piece).area
    assert solid.volume == pytest.approx(2.0 * HALF_HEIGHT * area / 3.0, rel=1e-12)
    np.testing.assert_allclose(solid.bounds[:, 2], [-HALF_HEIGHT, HALF_HEIGHT])
    middle = solid.vertices[solid.vertices[:, 2] == 0.0]
    np.testing.assert_array_equal(middle[:, :2], piece)


def test_the_engine_measures_the_distance_in_the_plane() -> None:
    rng = np.random.default_rng(5)
    scene = shipped("saw").scene()
    data = mujoco.MjData(scene.model)
    outline = shapely.Polygon(scene.object.vertices)
    pieces = [
        g for g in range(scene.model.ngeom) if scene.model.geom(g).name.startswith("object_piece")
    ]
    finger = scene.model.geom("finger_1_tip").id
    found = 0
    for row in rng.uniform([-0.5, -0.4], [0.5, 0.4], (200, 2)):
        data.qpos[:] = 0.0
        data.qpos[3:5] = -row  # the object moves, finger 1 stays at the origin
        mujoco.mj_kinematics(scene.model, data)
        true = outline.distance(shapely.Point(row)) - scene.finger_radius / scene.object.diameter
        if outline.contains(shapely.Point(row)):
            continue
        seen = min(mujoco.mj_geomDistance(scene.model, data, finger, g, 2.0, None) for g in pieces)
        assert seen == pytest.approx(true, abs=3e-7)  # vertices are stored in single precision
        found += 1
    assert found > 50


def test_slivers_thinner_than_the_engine_can_tell_do_not_stop_it() -> None:
    outline = Outline([[0, 0], [1, 1e-13], [2, 0], [2, 1], [1, 1 - 1e-12], [0, 1]])
    scene = Scene(outline, HandShape.from_angles_deg(60, 120), 0.05, SimConfig())
    assert scene.model.nmesh >= 1


placements = st.tuples(
    st.floats(-3, 3), st.floats(-3, 3), st.floats(-7, 7), st.floats(0.01, 5)
).map(lambda row: np.array([row]))


@settings(max_examples=60, deadline=None)
@given(placements)
def test_placements_survive_the_border(row: np.ndarray) -> None:
    scene = _L_SCENE
    np.testing.assert_allclose(scene.placements(scene.start_positions(row)), row, atol=1e-12)


@settings(max_examples=40, deadline=None)
@given(placements)
def test_engine_and_planner_agree_where_the_fingers_stand(row: np.ndarray) -> None:
    scene = _L_SCENE
    data = mujoco.MjData(scene.model)
    data.qpos[:] = scene.start_positions(row)[0]
    mujoco.mj_kinematics(scene.model, data)
    body = data.body("object")
    turn = body.xmat.reshape(3, 3)
    seen = np.array([turn.T @ (data.body(f"finger_{k}").xpos - body.xpos) for k in (1, 2, 3)])
    in_case = seen[:, :2] * scene.object.diameter + scene.object.centre
    np.testing.assert_allclose(in_case, scene.hand.fingers(row[0]), atol=1e-11)
    np.testing.assert_allclose(seen[:, 2], 0.0, atol=1e-15)


_L_SCENE = l_shape().scene()
