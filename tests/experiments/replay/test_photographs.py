"""Photographs that are taken ahead: the same frames in order, and a camera that is let go ends."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from experiments.replay import photographs
from experiments.replay.photographs import Photographs
from icage.errors import LibraryError
from icage.planner import plan
from sim.camera.renderer import RenderingUnavailable
from sim.camera.stage import View
from sim.world.config import SimConfig
from sim.world.scene import Scene
from tests.experiments.small import t_case


class Camera:
    """Stands for the renderer: frame k is filled with k, and the last may fail."""

    def __init__(self, frames: int, fails: bool = False) -> None:
        self.frames, self.fails, self.drawn, self.closed = frames, fails, 0, False

    def __call__(self, *_: Any) -> Iterator[NDArray[np.uint8]]:
        try:
            for k in range(self.frames):
                self.drawn += 1
                yield np.full((2, 2, 3), k, np.uint8)
            if self.fails:
                raise RenderingUnavailable("its driver gave up")
        finally:
            self.closed = True


def begun(camera: Camera, stack: ExitStack, monkeypatch: pytest.MonkeyPatch) -> Photographs:
    monkeypatch.setattr(photographs, "render_frames", camera)
    case = t_case()
    cage = plan(case)
    scene = Scene(case.outline, cage.hand, case.finger_radius, SimConfig())
    view = View((0.0, 0.0), 1.0, 2, 2)
    return Photographs.begun(scene, np.zeros((1, 6)), view, (), cage, stack, 1.0)


def test_frames_come_in_order_and_may_be_left_out(monkeypatch: pytest.MonkeyPatch):
    with ExitStack() as stack:
        taken = begun(Camera(60), stack, monkeypatch)
        assert taken.taken()
        for number in (0, 0, 1, 5, 40, 59, 59):
            assert (taken.at(number) == number).all()


def test_a_camera_goes_only_so_far_ahead_and_ends_when_it_is_let_go(
    monkeypatch: pytest.MonkeyPatch,
):
    camera = Camera(10_000)
    with ExitStack() as stack:
        taken = begun(camera, stack, monkeypatch)
        assert (taken.at(3) == 3).all()
    assert camera.closed
    assert camera.drawn <= 4 + photographs._AHEAD


def test_a_camera_that_never_draws_is_told_from_one_that_ends_half_way(
    monkeypatch: pytest.MonkeyPatch,
):
    with ExitStack() as stack:
        assert not begun(Camera(0, fails=True), stack, monkeypatch).taken()
    with ExitStack() as stack:
        taken = begun(Camera(3, fails=True), stack, monkeypatch)
        assert taken.taken()
        assert (taken.at(2) == 2).all()
        for _ in range(2):
            with pytest.raises(LibraryError, match="its driver gave up"):
                taken.at(3)
