"""Closings in worlds of their own: the same bits in any company."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest

from sim.closing import varied_shapes as varied_closing
from sim.closing.batch import close_many
from sim.closing.varied import Worlds, expand, own_model, settings
from sim.closing.varied_shapes import close_varied
from tests.sim.closing.worlds import assert_identical, close, endings, picked, scene_of
from tests.sim.grasps import KnownGrasp, l_shape, starts_near, t_shape, triangle


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
