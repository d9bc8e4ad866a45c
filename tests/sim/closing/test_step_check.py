"""Distances: ours against shapely, and the engine's contacts against both."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
import shapely

from icage.arrays import FloatArray
from icage.outline import Outline
from sim.closing.approach import LEAD, approached, first_touch
from sim.closing.step_check import RUNNING, TOUCHING, StepCheck
from sim.world.hand_in_object import depths, fingers_seen
from sim.world.scene import Scene
from tests.sim.grasps import KnownGrasp, case_outline, l_shape, starts_near, t_shape, triangle

GRASPS = [t_shape(), l_shape(), triangle()]


def signed_distance(polygon: shapely.Polygon, points: FloatArray) -> FloatArray:
    """Positive outside."""
    dots = shapely.points(points)
    away = shapely.distance(polygon.exterior, dots)
    return np.where(shapely.contains(polygon, dots), -away, away)


@pytest.mark.parametrize("name", ["handsaw_best", "pliers_best", "hook_deep_multi", "cross_multi"])
def test_depths_are_shapelys_distances(name: str) -> None:
    outline, _, _ = case_outline(name)
    rng = np.random.default_rng(3)
    x0, y0, x1, y1 = outline.polygon.bounds
    points = rng.uniform([x0 - 1, y0 - 1], [x1 + 1, y1 + 1], (600, 2))
    heights = np.repeat(outline.vertices[:, 1], 2)[:60]  # level with vertices, on purpose
    points[: len(heights), 1] = heights
    radius = 0.1
    found = np.empty(len(points))
    depths(outline.vertices, points, radius, found)
    wanted = radius - signed_distance(outline.polygon, points)
    np.testing.assert_allclose(found, wanted, atol=1e-12 * outline.diameter)


def test_engine_contacts_are_exact_on_edges_vertices_and_in_corners() -> None:
    """Discs 1e-4 to 1e-6 deep all round three outlines, convex and concave corners included."""
    rng = np.random.default_rng(5)
    seen = 0
    for grasp in GRASPS:
        scene = grasp.scene()
        unit, radius = scene.object.diameter, grasp.radius
        ring = grasp.outline.polygon.buffer(radius, quad_segs=400).exterior
        along = [ring.interpolate(s, normalized=True) for s in rng.uniform(0, 1, 200)]
        corners = grasp.outline.polygon.buffer(radius, join_style="mitre").exterior.coords
        for spot in [*along, *map(shapely.Point, corners)]:
            depth = 10.0 ** rng.uniform(-6, -4) * unit
            centre = _sunk(grasp.outline, np.array([spot.x, spot.y]), radius - depth)
            if centre is None:
                continue
            deep = radius - grasp.outline.polygon.exterior.distance(shapely.Point(centre))
            dist = _engine_distance(scene, centre)
            assert dist is not None
            assert dist == pytest.approx(-deep / unit, abs=2e-7)
            seen += 1
    assert seen > 500


def _sunk(outline: Outline, near: FloatArray, distance: float) -> FloatArray | None:
    """The point towards the outline from ``near`` at this distance from it."""
    ring = outline.polygon.exterior
    foot = ring.interpolate(ring.project(shapely.Point(near)))
    way = near - [foot.x, foot.y]
    away = float(np.hypot(*way))
    if away > 2.0 * distance or outline.polygon.contains(shapely.Point(near)):
        return None
    return np.array([foot.x, foot.y]) + way / away * distance


def _engine_distance(scene: Scene, centre: FloatArray) -> float | None:
    """Smallest contact distance of finger 1 with its centre at a point of B."""
    sigma = 3.0 * scene.object.diameter
    data = mujoco.MjData(scene.model)
    placement = np.array([centre[0], centre[1], 0.4, sigma])
    data.qpos[:] = scene.start_positions(placement)[0]
    mujoco.mj_forward(scene.model, data)
    tip = scene.model.geom("finger_1_tip").id
    found = [float(c.dist) for c in data.contact if tip in c.geom]
    return min(found, default=None)


@pytest.mark.parametrize("grasp", GRASPS)
def test_first_touch_is_the_first(grasp: KnownGrasp) -> None:
    scene = grasp.scene()
    starts = starts_near(grasp, 60, seed=1, opening=1.6, shift=0.1, turn=0.4)
    qpos = scene.start_positions(starts)
    touch = first_touch(scene, qpos)
    kinematics, radius = scene.kinematics, grasp.radius / scene.object.diameter
    body = shapely.Polygon(scene.object.vertices)
    for row, sigma in zip(qpos, touch.tolist(), strict=True):
        start = float(scene.sigma(row[None, :])[0])
        assert 0.0 < sigma <= start
        shares = np.linspace(0.0, 1.0, 200)
        for share in (*shares, 1.0):
            now = start + share * (sigma - start)
            fingers = kinematics.directions * (kinematics.lengths * now)[:, None] - row[3:5]
            turn = np.array([[np.cos(row[5]), -np.sin(row[5])], [np.sin(row[5]), np.cos(row[5])]])
            clear = shapely.distance(body, shapely.points(fingers @ turn)).min() - radius
            assert clear > -1e-12
        assert clear == pytest.approx(0.0, abs=1e-12)


def test_approach_leaves_a_gap_and_never_opens() -> None:
    grasp = t_shape()
    scene = grasp.scene()
    qpos = scene.start_positions(starts_near(grasp, 40, seed=2, opening=1.5))
    nearer = approached(scene, qpos)
    assert (scene.sigma(nearer) <= scene.sigma(qpos)).all()
    np.testing.assert_array_equal(nearer[:, 3:], qpos[:, 3:])
    gap = (scene.sigma(nearer) - first_touch(scene, qpos)) * scene.kinematics.lengths.max()
    assert gap.max() <= LEAD * (1 + 1e-9)
    touching = scene.start_positions(grasp.target.as_array())
    np.testing.assert_allclose(approached(scene, touching), touching, atol=1e-12)


def test_a_hand_that_misses_the_object_touches_nothing() -> None:
    scene = t_shape().scene()
    far = scene.start_positions(np.array([[50.0, 0.0, 0.3, 1.0]]))
    assert first_touch(scene, far)[0] == 0.0


def test_watch_counts_shape_depth_and_rise() -> None:
    grasp = t_shape()
    scene = grasp.scene()
    qpos = scene.start_positions(grasp.target.as_array())
    check = StepCheck.over(scene, qpos)
    moved = np.array(qpos)
    moved[0, 0] *= 1.01
    check.observe(np.array([0]), moved, np.ones((1, 6)))
    sigma = float(scene.sigma(moved)[0])
    lengths = scene.kinematics.lengths
    assert check.shape_error_max[0] == pytest.approx(np.abs(moved[0, :3] - lengths * sigma).max())
    assert check.sigma_rise_max[0] == pytest.approx(sigma / scene.sigma(qpos)[0])
    assert check.ending[0] == RUNNING
    shut = moved.copy()
    shut[0, :3] = lengths * (0.9 * float(scene.sigma(qpos)[0]))
    check.observe(np.array([0]), shut, np.ones((1, 6)))
    assert check.penetration_max[0] > 0.01
    check.observe(np.array([0]), qpos, np.ones((1, 6)))
    assert check.penetration_rest[0] < 1e-12 < check.penetration_max[0]


@pytest.mark.parametrize("step", [1e-6, 1e-3, 0.1])
def test_a_finger_that_is_not_measured_touches_nothing(step: float) -> None:
    """Hands that wander about, in small steps and large, against a measurement at every look."""
    rng = np.random.default_rng(9)
    touched = 0
    for grasp in GRASPS:
        scene = grasp.scene()
        qpos = scene.start_positions(starts_near(grasp, 40, 9))
        qpos[:, :3] = first_touch(scene, qpos)[:, None] * scene.kinematics.lengths
        radius, check = scene.finger_radius / scene.object.diameter, StepCheck.over(scene, qpos)
        deepest, found = np.zeros(len(qpos)), np.empty((len(qpos), 3))
        for _ in range(60):
            qpos = qpos + step * rng.normal(size=qpos.shape)
            qpos[:, :3] *= 1.0 - step
            check.observe(np.arange(len(qpos)), qpos, np.ones_like(qpos))
            for row, one in enumerate(qpos):
                fingers = np.empty((3, 2))
                fingers_seen(scene.kinematics.directions, one, fingers)
                depths(scene.object.vertices, fingers, radius, found[row])
            now = np.maximum(found.max(axis=1), 0.0)
            deepest = np.maximum(deepest, now)
            touches = (found > -TOUCHING).sum(axis=1)
            touched += int(touches.sum())
            np.testing.assert_array_equal(check.touches, touches)
            np.testing.assert_array_equal(check.penetration_rest, now)
            np.testing.assert_array_equal(check.penetration_max, deepest)
    assert touched > 50
