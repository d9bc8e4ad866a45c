"""Trajectories and frames."""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np
import pytest
import shapely

from icage.errors import InputError
from icage.hand import Placement
from sim.camera.renderer import BACKENDS, RenderingUnavailable, find_backend, render_frames
from sim.camera.stage import Decor, View, dressed
from sim.closing.one import close
from sim.closing.recording import record
from sim.world.config import SimConfig
from sim.world.hand_model import FINGER_COLOURS
from sim.world.object_model import OBJECT_COLOUR
from tests.sim.grasps import starts_near, t_shape

GRASP = t_shape()
START = Placement(*starts_near(GRASP, 1, seed=20, opening=1.6)[0].tolist())


def test_recording_begins_at_the_start_and_ends_in_the_grasp() -> None:
    scene = GRASP.scene()
    film = record(scene, START, frame_time=0.02)
    assert film.ending == "settled"
    np.testing.assert_allclose(film.placements[0], START.as_array(), atol=1e-12)
    end = close(scene, START).end.as_array()
    np.testing.assert_allclose(film.placements[-1], end, atol=1e-5)
    np.testing.assert_allclose(np.diff(film.time)[:-1], 0.02, rtol=1e-9)
    assert (np.diff(film.sigma)[:3] < 0).all()
    assert film.finger_forces[0].max() == 0.0
    assert (film.finger_forces[-1] > 0.05).all()
    assert len(film.qpos) == len(film) == len(film.sigma)


def test_pressing_fingers_balance_on_the_object() -> None:
    """At rest the contact forces on the object sum to zero, so those on the fingers do too."""
    from sim.closing.one import data_at
    from sim.world.contact_forces import finger_forces
    from sim.world.engine import mj

    scene = GRASP.scene()
    data = data_at(scene, scene.start_positions(START.as_array())[0])
    mj.mj_step(scene.model, data, 2000)
    forces, contacts = finger_forces(scene.model, data)
    assert contacts >= 4
    np.testing.assert_allclose(forces.sum(axis=0), 0.0, atol=1e-5 * np.abs(forces).max())
    along = (forces * -scene.kinematics.directions).sum(axis=1)
    work = float((along * scene.kinematics.lengths).sum())  # of the object against closing
    assert work == pytest.approx(scene.closing_force, rel=1e-6)


def test_recording_can_be_cut_off() -> None:
    film = record(GRASP.scene(), START, frame_time=0.01, max_frames=5)
    assert len(film) == 5
    assert film.ending == "running"
    with pytest.raises(InputError, match="frame_time"):
        record(GRASP.scene(), START, frame_time=0.0)


def test_view_holds_everything_and_knows_its_pixels() -> None:
    scene = GRASP.scene()
    qpos = record(scene, START, frame_time=0.05).qpos
    view = View.around(scene, qpos, 640, 360)
    for row in qpos:
        tips = scene.kinematics.directions * row[:3, None]
        pixels = view.pixels(tips)
        assert (pixels >= 0).all()
        assert (pixels <= [640, 360]).all()
    centre = view.pixels(np.array(view.centre))
    np.testing.assert_allclose(centre, [320, 180])


def test_staged_scene_only_adds_looks() -> None:
    scene = GRASP.scene(SimConfig())
    view = View((0.0, 0.0), 1.5, 320, 180)
    ring = shapely.Point(0.0, 5.0).buffer(0.5).difference(shapely.Point(0.0, 5.0).buffer(0.2))
    staged = dressed(scene, view, Decor([(1, ring), (3, shapely.MultiPolygon([ring]))], START))
    model = staged.compile()
    assert model.nv == scene.model.nv
    touching = {model.geom(k).name for k in range(model.ngeom) if model.geom_contype[k]}
    plain = scene.model
    assert touching == {plain.geom(k).name for k in range(plain.ngeom) if plain.geom_contype[k]}
    np.testing.assert_allclose(model.body_mass.sum(), plain.body_mass.sum())


def test_importing_the_simulation_leaves_the_graphics_alone() -> None:
    code = (
        "import os, sim.camera.renderer, sim.closing.batch, sim.closing.recording; "
        "assert 'MUJOCO_GL' not in os.environ; print('ok')"
    )
    environment = {k: v for k, v in os.environ.items() if k != "MUJOCO_GL"}
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, env=environment, check=False
    )
    assert done.stdout.strip() == "ok", done.stderr


def test_frames_or_a_plain_refusal() -> None:
    """Frames where the machine can draw them; elsewhere one clear error and no crash."""
    scene = GRASP.scene()
    qpos = scene.start_positions(np.stack([START.as_array(), GRASP.target.as_array()]))
    view = View.around(scene, qpos, 192, 108)
    backend = find_backend()
    if backend is None:
        with pytest.raises(RenderingUnavailable, match="apt-get install"):
            next(render_frames(scene, qpos, view))
        return
    assert backend in BACKENDS
    frames = list(render_frames(scene, qpos, view, Decor(target=GRASP.target)))
    assert [frame.shape for frame in frames] == [(108, 192, 3)] * 2
    palette = np.array([*FINGER_COLOURS, OBJECT_COLOUR[:3]])
    for row, frame in zip(qpos, frames, strict=True):
        for k in range(3):
            x, y = view.pixels(scene.kinematics.directions[k] * row[k]).round().astype(int)
            alike = palette @ frame[y, x] / np.linalg.norm(palette, axis=1)  # whatever the light
            assert alike.argmax() == k, f"finger {k + 1} is drawn in {frame[y, x]}"
    assert (frames[0] != frames[1]).any()


def test_regions_with_dust_and_touching_rings_can_be_staged() -> None:
    """Unions of many cells leave pinholes and rings that touch; a film must not fail on them."""
    scene = GRASP.scene()
    rng = np.random.default_rng(2)
    dust = [shapely.Point(x, y).buffer(1e-7) for x, y in rng.uniform(5.0, 6.0, (30, 2))]
    square = shapely.box(5.0, 5.0, 6.0, 6.0).difference(shapely.union_all(dust))
    diamond = shapely.Polygon([(5, 5.5), (5.3, 5.4), (5.6, 5.5), (5.3, 5.6)])
    geometry = shapely.MultiPolygon([square.difference(diamond), shapely.box(6.0, 6.0, 7.0, 7.0)])
    model = dressed(scene, View((0.0, 0.0), 2.0, 64, 64), Decor([(2, geometry)])).compile()
    drawn = [model.mesh(k).name for k in range(model.nmesh) if "region" in model.mesh(k).name]
    assert len(drawn) == 2
