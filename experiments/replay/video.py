"""``replay.mp4``: random starts closing one after another, with everything that tells how it went.

Left the hand's view (MuJoCo's camera where the machine can draw, else the same states in two
dimensions), right sigma, the finger forces and the object's view, below the counts.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, closing
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from experiments.figures.drawing.canvas import Canvas, Pixels
from experiments.figures.drawing.hand_view import HandView, window_on
from experiments.figures.drawing.shapes import tidied
from experiments.replay.clips import FPS, Clip, clip_alone, clips
from experiments.replay.film_page import HEIGHT, MAIN, WIDTH, Page
from experiments.replay.mp4 import write_mp4
from experiments.replay.run import Replay, Report
from experiments.replay.what_is_filmed import Filmed
from icage.arrays import FloatArray
from icage.cage import Cage
from icage.cells.regions import FingerRegion
from icage.errors import LibraryError
from sim.camera.renderer import RenderingUnavailable, find_backend, render_frames
from sim.camera.stage import Decor, View
from sim.world.scene import Scene

SIZE: Final = (WIDTH, HEIGHT)

RegionsByGrasp = dict[str, tuple[FingerRegion, ...]]


def film(
    done: Replay, name: str, regions: RegionsByGrasp, path: Path, report: Report,
    camera: bool | None = None,
) -> None:  # fmt: skip
    """Write the film of a replay.

    Parameters
    ----------
    regions:
        Caging regions to shade, by name of the grasp.
    camera:
        Whether to use MuJoCo's renderer; None for "if it works here".
    """
    _write(clips(done), name, regions, path, report, camera)


def film_alone(
    one: Filmed, regions: Sequence[FingerRegion], path: Path, report: Report,
    camera: bool | None = None,
) -> None:  # fmt: skip
    """Write the film of one closing; ``regions`` are those to shade."""
    _write([clip_alone(one)], one.grasp, {one.grasp: tuple(regions)}, path, report, camera)


def _write(
    chosen: Sequence[Clip], name: str, regions: RegionsByGrasp, path: Path, report: Report,
    camera: bool | None,
) -> None:  # fmt: skip
    total = sum(len(clip) for clip in chosen)
    use_camera = find_backend() is not None if camera is None else camera

    def counted() -> Iterator[Pixels]:
        canvas = Canvas(WIDTH, HEIGHT)
        for number, frame in enumerate(closing_frames(canvas, chosen, name, regions, use_camera)):
            report("video", number, total)
            yield frame
        report("video", total, total)

    write_mp4(counted(), path, SIZE, FPS)


def closing_frames(
    canvas: Canvas, chosen: Sequence[Clip], name: str, regions: RegionsByGrasp, use_camera: bool
) -> Iterator[Pixels]:
    """All frames, the canvas itself each time."""
    for group in dict.fromkeys(clip.filmed.group for clip in chosen):
        mine = [clip for clip in chosen if clip.filmed.group == group]
        first = mine[0].filmed
        shown = _inner(regions[first.grasp])
        qpos = np.concatenate([clip.qpos for clip in mine])
        window = window_on(first.scene, qpos, *MAIN, whole=first.whole)
        hand = HandView(first.scene, window, shown, first.cage.target_placement)
        page = Page(name, mine, shown)
        for number, clip in enumerate(mine):
            page.draw_still(canvas, number)
            still = canvas.pixels.copy()
            with ExitStack() as stack:
                main = _drawn(hand, clip)
                if use_camera:
                    main = _photographed(hand, clip, window, shown, stack, canvas.scale) or main
                for frame in range(len(clip)):
                    canvas.pixels[:] = still
                    main(canvas, frame)
                    page.draw_now(canvas, number, frame)
                    yield canvas.pixels


def _inner(regions: Sequence[FingerRegion]) -> list[FingerRegion]:
    return [region for region in regions if region.bound == "inner"]


Painter = Callable[[Canvas, int], None]


def _drawn(hand: HandView, clip: Clip) -> Painter:
    def paint(canvas: Canvas, frame: int) -> None:
        hand.draw(canvas, clip.qpos[frame], clip.qpos[0])

    return paint


def _photographed(
    hand: HandView, clip: Clip, window: View, regions: Sequence[FingerRegion], stack: ExitStack,
    scale: float,
) -> Painter | None:  # fmt: skip
    """MuJoCo's frames; those without motion are drawn once. None if the renderer fails."""
    filmed = clip.filmed
    first, last = clip.moving
    taken = Photographs.of(
        filmed.scene, clip.qpos[first : last + 1], window, regions, filmed.cage, stack, scale
    )
    if taken is None:
        return None

    def paint(canvas: Canvas, frame: int) -> None:
        canvas.paste(taken.at(min(max(frame - first, 0), last - first)), 0, 0)
        hand.draw_goal(canvas)
        hand.draw_numbers(canvas, clip.qpos[frame])

    return paint


class Photographs:
    """Frames of MuJoCo's camera, taken one after another as they are asked for."""

    def __init__(self, frames: Iterator[NDArray[np.uint8]], first: NDArray[np.uint8]) -> None:
        self._frames, self._number, self._last = frames, 0, first

    @classmethod
    def of(
        cls, scene: Scene, qpos: FloatArray, window: View, regions: Sequence[FingerRegion],
        cage: Cage, stack: ExitStack, scale: float,
    ) -> Photographs | None:  # fmt: skip
        """Of positions (F, 6) through a window of units of ``scale`` pixels, with the regions on
        the floor; None if the renderer fails. The target is drawn over them: in the scene its line
        would throw a shadow.
        """
        detail = 2e-3 * cage.outline.diameter
        decor = Decor(
            [(r.finger, tidied(r.geometry, detail)) for r in regions
             if r.level_name != "sigma_first"]
        )  # fmt: skip
        sized = replace(
            window, width=round(scale * window.width), height=round(scale * window.height)
        )
        frames = render_frames(scene, qpos, sized, decor)
        stack.enter_context(closing(frames))
        try:
            return cls(frames, next(frames))
        except RenderingUnavailable:
            return None

    def at(self, number: int) -> NDArray[np.uint8]:
        """Frame ``number``, never before the last that was asked for.

        Raises
        ------
        LibraryError:
            The camera has ended half way: killed, or its driver gave up.
        """
        while self._number < number:
            try:
                self._last = next(self._frames)
            except RenderingUnavailable as error:
                raise LibraryError(f"MuJoCo's camera has ended before its film: {error}") from error
            self._number += 1
        return self._last
