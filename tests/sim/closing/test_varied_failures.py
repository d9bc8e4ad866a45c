"""What no closing can be made of is told, and its neighbours never notice."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from icage.errors import InputError
from sim.closing import varied_shapes as varied_closing
from sim.closing.varied import Worlds
from tests.sim.closing.worlds import assert_identical, close, endings, picked, scene_of
from tests.sim.grasps import starts_near, t_shape


def test_friction_in_a_scene_compiled_without_is_an_error():
    worlds = Worlds.usual(2)
    worlds.friction[1] = 0.3
    with pytest.raises(InputError, match="compiled without"):
        close(scene_of(t_shape()), starts_near(t_shape(), 2, seed=1), worlds)


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
