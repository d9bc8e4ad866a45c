"""A scene of a case into files, each whole or not at all."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, closing
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from experiments.figures.drawing.canvas import Canvas, Pixels
from experiments.replay.film_page import HEIGHT, WIDTH
from experiments.replay.mp4 import write_mp4
from experiments.video.attack_scene import attack_scene
from experiments.video.closings_scene import closings_scene
from experiments.video.nothing_to_film import NothingToFilmError
from experiments.video.pictures import Gif, Sheet
from experiments.video.placements_scene import placements_scene
from experiments.video.plan_scene import plan_scene
from experiments.video.shake_scene import shake_scene
from experiments.video.subject import Subject
from icage.formats.whole_files import whole_file

Scene = Callable[[Subject, Canvas], Iterator[None]]
Report = Callable[[str, int, int], None]

SCENES: Final[Mapping[str, Scene]] = {
    "plan": plan_scene,
    "placements": placements_scene,
    "closings": closings_scene,
    "attack": attack_scene,
    "shake": shake_scene,
}

SIZES: Final = {"360p": 0.5, "540p": 0.75, "720p": 1.0, "1080p": 1.5, "1440p": 2.0}
"""Height of the picture, and pixels of a unit of the page."""


@dataclass(frozen=True, slots=True)
class Outputs:
    """Files to write, None for one that is not wanted."""

    film: Path | None = None
    sheet: Path | None = None
    gif: Path | None = None


def write_film(
    name: str, subject: Subject, outputs: Outputs, size: str, fps: int, report: Report
) -> int:
    """Draw a scene of ``SCENES`` and write what is wanted of it; returns how many frames.

    Raises
    ------
    NothingToFilmError:
        What it shows did not happen.
    InputError:
        The scene is not one of this cage.
    OutputError:
        A file cannot be written.
    """
    canvas = Canvas(WIDTH, HEIGHT, SIZES[size])
    sheet = Sheet(f"{subject.name}: {name}, seed {subject.seed}", subject.frames, fps)
    gif = Gif(subject.frames, fps)
    count = 0
    with ExitStack() as stack:
        steps = SCENES[name](subject, canvas)
        if hasattr(steps, "close"):
            stack.enter_context(closing(steps))  # pyright: ignore[reportArgumentType]

        def frames() -> Iterator[Pixels]:
            nonlocal count
            for _ in steps:
                report("frames", count, subject.frames)
                if outputs.sheet is not None:
                    sheet.see(count, canvas.pixels)
                if outputs.gif is not None:
                    gif.see(count, canvas.pixels)
                count += 1
                yield canvas.pixels

        parts = {
            path: stack.enter_context(whole_file(path))
            for path in (outputs.sheet, outputs.gif, outputs.film)
            if path is not None
        }
        if outputs.film is None:
            for _ in frames():
                pass
        else:
            high, wide = canvas.pixels.shape[:2]
            write_mp4(frames(), parts[outputs.film], (wide, high), fps)
        report("frames", count, subject.frames)
        if outputs.sheet is not None:
            sheet.save(parts[outputs.sheet])
        if outputs.gif is not None:
            gif.save(parts[outputs.gif])
    return count


__all__ = ["SCENES", "SIZES", "NothingToFilmError", "Outputs", "Subject", "write_film"]
