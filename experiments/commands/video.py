"""``icage video CASE --scene SCENE --out FILE.mp4``: a short film for a lecture."""

from __future__ import annotations

import argparse
from typing import Any, Final

from experiments.cases.asked import add_case, case_of
from experiments.io.options import check_output, count, file_name, positive, seed

SCENES: Final = ("plan", "placements", "closings", "attack", "shake")
SIZES: Final = ("360p", "540p", "720p", "1080p", "1440p")

_FASTEST, _LONGEST = 60, 60.0
"""[1 / s], [s] Bounds of a film."""


def add_parser(subparsers: Any) -> None:
    """Options of the command."""
    parser = subparsers.add_parser(
        "video",
        help="a short film of the plan, placements, closings, an attack that escapes, or a shake",
        description="Write an MP4, a sheet of frames or a GIF: the plan's way out past its levels; "
        "placements from which closing ends in the target; closings; an attack above sigma_max "
        "that escapes; the closed hand, shaken. Point fingers become discs. The layout is the same "
        "with and without OpenGL.",
    )
    add_case(parser)
    parser.add_argument("--scene", choices=SCENES, required=True, help="what is filmed")
    parser.add_argument("--out", metavar="FILE.mp4", type=file_name, help="the film")
    parser.add_argument(
        "--sheet", metavar="FILE.png", type=file_name, help="nine frames of it side by side"
    )
    parser.add_argument("--gif", metavar="FILE.gif", type=file_name, help="a small one, for pages")
    parser.add_argument("--size", choices=SIZES, default="720p", help="of the picture (720p)")
    parser.add_argument("--fps", metavar="N", type=count, default=30, help="frames a second (30)")
    parser.add_argument(
        "--seconds", metavar="T", type=positive, default=8.0, help="length of the film (8)"
    )
    parser.add_argument(
        "--seed", metavar="S", type=seed, default=0, help="seed of all random numbers (0)"
    )
    parser.add_argument(
        "--camera", action=argparse.BooleanOptionalAction, default=None,
        help="whether MuJoCo's camera films what the engine does (where it works)",
    )  # fmt: skip


def run(args: argparse.Namespace) -> int:
    """Plan, act, draw, write; 1 if what was to be shown did not happen."""
    import sys
    from pathlib import Path

    frames = _checked(args)
    case = case_of(args)
    for option in ("out", "sheet", "gif"):
        check_output(f"--{option}", getattr(args, option), *case.sources)
    from sim.camera.renderer import check_graphics

    check_graphics()
    from experiments.cases.chosen import chosen, say_how_to_keep
    from experiments.io.progress import stage_bar
    from experiments.video.run import (  # only now: engine and planner take a second to load
        NothingToFilmError,
        Outputs,
        Subject,
        write_film,
    )
    from icage.kernels.compiled import long_job
    from icage.sampling import SamplingError

    long_job()
    found = chosen(case, args)
    say_how_to_keep(found)
    (case,) = found.cases
    files = {name: getattr(args, name) for name in ("out", "sheet", "gif")}
    paths = [None if name is None else Path(name) for name in files.values()]
    try:
        subject = Subject.of(case, args.seed, frames, _camera(args))
        with stage_bar() as report:
            write_film(args.scene, subject, Outputs(*paths), args.size, args.fps, report)
    except (NothingToFilmError, SamplingError) as error:
        print(f"icage: video failed: {error}", file=sys.stderr)
        return 1
    for name in filter(None, files.values()):
        print(f"{name}: {args.scene} of {case.name}, {frames} frames")
    return 0


def _checked(args: argparse.Namespace) -> int:
    """How many frames; all options in order."""
    from pathlib import Path

    from icage.errors import InputError

    wanted = {"out": ".mp4", "sheet": ".png", "gif": ".gif"}
    given = {name: getattr(args, name) for name in wanted if getattr(args, name) is not None}
    if not given:
        raise InputError("video needs --out FILE.mp4, --sheet FILE.png or --gif FILE.gif")
    for name, value in given.items():
        if Path(value).suffix.lower() != wanted[name]:
            raise InputError(f"--{name} {value!r}: a name ending in {wanted[name]} is needed")
    if args.fps > _FASTEST:
        raise InputError(f"--fps {args.fps}: at most {_FASTEST}")
    if args.seconds > _LONGEST:
        raise InputError(f"--seconds {args.seconds:g}: at most {_LONGEST:g}")
    frames = round(args.fps * args.seconds)
    if frames < 2:
        raise InputError(f"--seconds {args.seconds:g} at {args.fps} fps: two frames are needed")
    return frames


def _camera(args: argparse.Namespace) -> bool:
    """Whether MuJoCo's camera is used; scenes of the planner alone need none."""
    from sim.camera.renderer import find_backend

    if args.scene in ("plan", "placements") or args.camera is False:
        return False
    found = find_backend() is not None
    if args.camera and not found:
        from icage.errors import InputError
        from sim.camera.renderer import INSTALL_HINT

        raise InputError(f"--camera: no offscreen OpenGL on this machine (try: {INSTALL_HINT})")
    return found
