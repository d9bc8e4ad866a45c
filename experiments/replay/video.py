"""``replay.mp4``: random starts closing one after another, with everything that tells how it went.

Left the hand's view (MuJoCo's camera where the machine can draw, else the same states in two
dimensions), right sigma, the finger forces and the object's view, below the counts.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from experiments.figures.drawing.canvas import Canvas, Pixels
from experiments.figures.drawing.hand_view import HandView, window_on
from experiments.replay.clips import FPS, Clip, clip_alone, clips
from experiments.replay.film_page import HEIGHT, MAIN, WIDTH, Page
from experiments.replay.mp4 import write_mp4
from experiments.replay.photographs import Photographs
from experiments.replay.run import Replay, Report
from experiments.replay.what_is_filmed import Filmed
from icage.cells.regions import FingerRegion
from sim.camera.renderer import find_backend
from sim.camera.stage import View

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
    shots = _shots(chosen, name, regions)
    with ExitStack() as cameras:
        # the next one is at work while this one is read
        coming = [_camera(one, cameras, canvas.scale) for one in shots[: 2 * use_camera]]
        for number, shot in enumerate(shots):
            shot.page.draw_still(canvas, shot.number)
            still = canvas.pixels.copy()
            main = _drawn(shot)
            if use_camera:
                taken = coming[number]
                main = _photographed(shot, taken) if taken.taken() else main
            for frame in range(len(shot.clip)):
                canvas.pixels[:] = still
                main(canvas, frame)
                shot.page.draw_now(canvas, shot.number, frame)
                yield canvas.pixels
            if use_camera and number + 2 < len(shots):
                coming.append(_camera(shots[number + 2], cameras, canvas.scale))


@dataclass(frozen=True, slots=True)
class _Shot:
    """A clip, and where it is seen: ``number`` is its place on the page of its group."""

    clip: Clip
    number: int
    page: Page
    hand: HandView
    window: View
    regions: Sequence[FingerRegion]


def _shots(chosen: Sequence[Clip], name: str, regions: RegionsByGrasp) -> list[_Shot]:
    shots: list[_Shot] = []
    for group in dict.fromkeys(clip.filmed.group for clip in chosen):
        mine = [clip for clip in chosen if clip.filmed.group == group]
        first = mine[0].filmed
        shown = _inner(regions[first.grasp])
        qpos = np.concatenate([clip.qpos for clip in mine])
        window = window_on(first.scene, qpos, *MAIN, whole=first.whole)
        hand = HandView(first.scene, window, shown, first.cage.target_placement)
        page = Page(name, mine, shown)
        shots += [_Shot(clip, k, page, hand, window, shown) for k, clip in enumerate(mine)]
    return shots


def _inner(regions: Sequence[FingerRegion]) -> list[FingerRegion]:
    return [region for region in regions if region.bound == "inner"]


Painter = Callable[[Canvas, int], None]


def _drawn(shot: _Shot) -> Painter:
    clip = shot.clip

    def paint(canvas: Canvas, frame: int) -> None:
        shot.hand.draw(canvas, clip.qpos[frame], clip.qpos[0])

    return paint


def _camera(shot: _Shot, stack: ExitStack, scale: float) -> Photographs:
    """MuJoCo's frames of the motion: those without motion are drawn once."""
    filmed = shot.clip.filmed
    first, last = shot.clip.moving
    moving = shot.clip.qpos[first : last + 1]
    return Photographs.begun(
        filmed.scene, moving, shot.window, shot.regions, filmed.cage, stack, scale
    )


def _photographed(shot: _Shot, taken: Photographs) -> Painter:
    first, last = shot.clip.moving

    def paint(canvas: Canvas, frame: int) -> None:
        canvas.paste(taken.at(min(max(frame - first, 0), last - first)), 0, 0)
        shot.hand.draw_goal(canvas)
        shot.hand.draw_numbers(canvas, shot.clip.qpos[frame])

    return paint
