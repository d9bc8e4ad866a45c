"""``replay.mp4``: random starts closing one after another, with everything that tells how it went.

Left the hand's view (MuJoCo's camera where the machine can draw, else the same states in two
dimensions), right sigma, the finger forces and the object's view, below the counts.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, closing
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
from icage.cells.regions import FingerRegion
from sim.camera.renderer import RenderingUnavailable, find_backend, render_frames
from sim.camera.stage import Decor, View

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
        for number, frame in enumerate(_frames(chosen, name, regions, use_camera)):
            report("video", number, total)
            yield frame
        report("video", total, total)

    write_mp4(counted(), path, SIZE, FPS)


def _frames(
    chosen: Sequence[Clip], name: str, regions: RegionsByGrasp, use_camera: bool
) -> Iterator[Pixels]:
    """All frames, the canvas itself each time."""
    canvas = Canvas(WIDTH, HEIGHT)
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
                    main = _photographed(hand, clip, window, shown, stack) or main
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
    hand: HandView, clip: Clip, window: View, regions: Sequence[FingerRegion], stack: ExitStack
) -> Painter | None:
    """MuJoCo's frames; those without motion are drawn once. None if the renderer fails."""
    filmed = clip.filmed
    first, last = clip.moving
    detail = 2e-3 * filmed.cage.outline.diameter
    decor = Decor(
        [(r.finger, tidied(r.geometry, detail)) for r in regions if r.level_name != "sigma_first"],
        filmed.cage.target_placement,
    )
    frames = render_frames(filmed.scene, clip.qpos[first : last + 1], window, decor)
    stack.enter_context(closing(frames))
    taken: list[NDArray[np.uint8]] = []
    try:
        taken.append(next(frames))
    except RenderingUnavailable:
        return None

    def paint(canvas: Canvas, frame: int) -> None:
        wanted = min(max(frame - first, 0), last - first)
        while len(taken) <= wanted:
            taken.append(next(frames))
        canvas.paste(taken[wanted], 0, 0)
        hand.draw_numbers(canvas, clip.qpos[frame])

    return paint
