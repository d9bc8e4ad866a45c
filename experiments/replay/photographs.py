"""MuJoCo's photographs of a clip, taken ahead of the page that they are pasted into.

A camera is a process of its own (``sim.camera.renderer``) and draws while this one does something
else; who is about to need the next camera starts it while the last one is still being read.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import replace
from queue import Empty, Queue
from threading import Event, Thread
from typing import Final

import numpy as np
from numpy.typing import NDArray

from experiments.figures.drawing.shapes import tidied
from icage.arrays import FloatArray
from icage.cage import Cage
from icage.cells.regions import FingerRegion
from icage.errors import LibraryError
from sim.camera.renderer import RenderingUnavailable, render_frames
from sim.camera.stage import Decor, View
from sim.world.scene import Scene

Photograph = NDArray[np.uint8]

_AHEAD: Final = 16
"""Frames that a camera may be ahead: 1.6 MB each in the film of a replay."""

_LOOK: Final = 0.1
"""[s] Between two looks of a camera that is far enough ahead."""


class Photographs:
    """Frames of MuJoCo's camera, asked for one after another."""

    def __init__(self, frames: _Ahead) -> None:
        self._frames, self._number, self._last = frames, -1, np.empty((0, 0, 3), np.uint8)

    @classmethod
    def begun(
        cls, scene: Scene, qpos: FloatArray, window: View, regions: Sequence[FingerRegion],
        cage: Cage, stack: ExitStack, scale: float,
    ) -> Photographs:  # fmt: skip
        """Of positions (F, 6) through a window of units of ``scale`` pixels, with the regions on
        the floor. The target is drawn over them: in the scene its line would throw a shadow. The
        camera is at work from now on, and ends with ``stack`` at the latest.
        """
        detail = 2e-3 * cage.outline.diameter
        decor = Decor(
            [(r.finger, tidied(r.geometry, detail)) for r in regions
             if r.level_name != "sigma_first"]
        )  # fmt: skip
        sized = replace(
            window, width=round(scale * window.width), height=round(scale * window.height)
        )
        return cls(stack.enter_context(_Ahead(render_frames(scene, qpos, sized, decor))))

    def taken(self) -> bool:
        """Whether there is a first frame; waits for it."""
        try:
            self._until(0)
        except RenderingUnavailable:
            return False
        return True

    def at(self, number: int) -> Photograph:
        """Frame ``number``, never before the last that was asked for.

        Raises
        ------
        LibraryError:
            The camera has ended half way: killed, or its driver gave up.
        """
        try:
            self._until(number)
        except RenderingUnavailable as error:
            raise LibraryError(f"MuJoCo's camera has ended before its film: {error}") from error
        return self._last

    def _until(self, number: int) -> None:
        while self._number < number:
            self._last = next(self._frames)
            self._number += 1


class _Ahead(Iterator[Photograph]):
    """What an iterator yields, a few at most before they are asked for, by a thread of its own."""

    def __init__(self, frames: Iterator[Photograph]) -> None:
        self._room: Queue[None] = Queue()
        for _ in range(_AHEAD):
            self._room.put(None)
        self._done: Queue[Photograph | BaseException] = Queue()
        self._given_up = Event()
        self._thread = Thread(target=self._take, args=(frames,), daemon=True)

    def __enter__(self) -> _Ahead:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._given_up.set()
        self._thread.join()

    def __next__(self) -> Photograph:
        found = self._done.get()
        self._room.put(None)
        if isinstance(found, BaseException):
            self._done.put(found)  # whoever asks again gets the same answer
            raise found
        return found

    def _take(self, frames: Iterator[Photograph]) -> None:
        try:
            while self._wait_for_room():
                self._done.put(next(frames))
        except BaseException as error:  # StopIteration, too: it is the reader's
            self._done.put(error)
        finally:
            close = getattr(frames, "close", None)
            if close is not None:
                close()  # here: a generator is closed by the thread that runs it

    def _wait_for_room(self) -> bool:
        while not self._given_up.is_set():
            try:
                self._room.get(timeout=_LOOK)
            except Empty:
                continue
            return True
        return False
