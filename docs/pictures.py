"""The pictures of these pages, made again by the code: ``python -m docs.pictures [NAME ...]``.

Most are what a command draws; ``COMMANDS`` has it, word for word. The four of the theory that no
command draws are drawn here, with the product's own shapes and colours. All go into
``docs/figures``, and are the same bytes every time.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from shutil import copyfile
from typing import Final

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Circle, PathPatch, Polygon

from experiments.cli import main as icage_command
from experiments.environment import ROOT
from experiments.figures.drawing.palette import (
    BAD,
    FINGERS,
    INK,
    OBJECT_EDGE,
    OBJECT_FILL,
    PAPER,
    PURPLE,
    QUIET_INK,
    SKY,
    tint,
)
from experiments.figures.drawing.shapes import as_path, tidied
from experiments.figures.drawing.written import FIGURE_SETTINGS
from icage.cage import Cage
from icage.cells.regions import caging_regions
from icage.discs.offsets import offsets
from icage.formats.load import load
from icage.geometry.exterior import exterior_pieces
from icage.outline import Outline
from icage.planner import plan

FIGURES: Final = ROOT / "docs/figures"
ON_SHELF: Final = "docs/drawings/parallel_hook_on_shelf.json"
HOOK: Final = "docs/drawings/hook.svg"
L: Final = "models/cases/L_best.json"

GRASPS: Final = {
    "HOOK/1.json": f"grasps {HOOK} --finger-radius 3 --top 3 --cases HOOK",
}
"""Searches whose case files the commands below take; HOOK is a folder."""

COMMANDS: Final = {
    "hook_outline": f"outline {HOOK} --figure FILE",
    "hook_grasps": f"grasps {HOOK} --finger-radius 3 --top 3 --figure FILE",
    "hook_cage": "plan HOOK/1.json --figure FILE",
    "hook_place": "place HOOK/1.json --opening-error --figure FILE",
    "shelf": f"plan {ON_SHELF} --friction 0.0001 --friction-figure FILE",
    "friction_pliers": "plan pliers --friction 0.1,0.2 --friction-figure FILE",
    "cage_rest": "plan pliers/4_with_rest --figure FILE",
    "place_pliers": "place pliers --opening-error --figure FILE",
}

PAPER_FIGURES: Final = ("contact_space", "obstacles", "search")
"""Of ``icage figures models/cases/L_best.json``."""


def theory_cells(figure: Figure) -> None:
    """The plane outside the object in convex pieces, and the cell of one hand."""
    cage = _l_cage()
    axes = _frame(figure.add_subplot(), (-1.3, -1.3, 4.3, 4.3))
    pieces, origin = exterior_pieces(cage.outline, cage.hand)
    corners = np.column_stack([pieces.x, pieces.y]) + origin
    rings = [
        corners[pieces.slot_vertex[pieces.ptr[k] : pieces.ptr[k + 1]]] for k in range(pieces.total)
    ]
    hand = cage.contacts + 0.35 * (cage.contacts - cage.contacts.mean(axis=0))
    for ring in rings:
        axes.add_patch(Polygon(ring, fc="none", ec=QUIET_INK, lw=0.7, zorder=3))
    for k, finger in enumerate(hand):
        inside = next(ring for ring in rings if Polygon(ring).contains_point(finger))
        axes.add_patch(Polygon(inside, fc=tint(FINGERS[k], 0.3), ec="none", zorder=1))
    _object(axes, cage.outline)
    _hand(axes, hand, numbers=True)


def theory_levels(figure: Figure) -> None:
    """Where each finger can be below four levels: the target's component grows until it is open."""
    cage = plan(load("pliers/4_with_rest"))
    first, last = cage.sigma_first or 0.0, cage.sigma_max or 0.0
    levels = {
        "just above $\\sigma_0$": 1.03 * cage.sigma_0,
        "$\\sigma_{first}$: it meets another grasp": first,
        "between them": 0.5 * (first + last),
        "$\\sigma_{max}$: it is open": last,
    }
    for number, (words, level) in enumerate(levels.items()):
        axes = _frame(figure.add_subplot(2, 2, number + 1), (25, 35, 205, 150))
        for region in caging_regions(cage, level):
            if region.bound == "inner":
                path = as_path(tidied(region.geometry, 0.2))
                colour = FINGERS[region.finger - 1]
                axes.add_patch(PathPatch(path, fc=tint(colour, 0.35), ec=colour, lw=0.4, zorder=1))
        _object(axes, cage.outline)
        _hand(axes, cage.contacts, radius=cage.finger_radius)
        puncture = next((p for p in cage.punctures if p.sigma == level), None)
        if puncture is not None:
            axes.add_patch(Polygon(puncture.contacts, fc="none", ec=BAD, lw=0.8, ls="--", zorder=4))
        axes.set_title(f"{words}\n{level / cage.sigma_0:.3f} $\\sigma_0$", fontsize=8.0, color=INK)


def theory_discs(figure: Figure) -> None:
    """The curve of the finger centres between two polygons that enclose it, coarse on purpose."""
    outline = Outline(np.array([[0, 0], [3, 0], [3, 1], [1.2, 1], [1.2, 2.6], [0, 2.6]], float))
    radius, segments = 0.6, 2
    true = outline.polygon.buffer(radius, quad_segs=256)
    grown = offsets(outline, radius, segments)
    axes = _frame(figure.add_subplot(), (-0.9, -0.9, 3.9, 4.2))
    _object(axes, outline)
    for polygon, colour, words in (
        (grown.inner.polygon, SKY, "inner polygon: more room, sigma_max from above"),
        (grown.outer.polygon, PURPLE, "outer polygon: less room, sigma_max from below"),
    ):
        axes.plot(*polygon.exterior.xy, color=colour, lw=1.2, label=words, zorder=4)
        axes.plot(*polygon.exterior.xy, color=colour, ls="", marker="o", ms=2.2, zorder=5)
    axes.plot(*true.exterior.xy, color=INK, lw=0.8, ls="--", label="true curve", zorder=6)
    axes.add_patch(Circle((1.8, 1.6), radius, fc=tint(FINGERS[0], 0.4), ec=FINGERS[0], lw=0.8))
    axes.plot([1.8], [1.6], marker="o", ms=3, color=FINGERS[0], zorder=7)
    axes.legend(loc="upper left", fontsize=7.0, frameon=False)


def theory_shelf(figure: Figure) -> None:
    """Three fingers on parallel edges: the hand slides, and its size does not change."""
    outline = Outline(np.array([[0, 0], [4, 0], [4, 1], [2.2, 1], [2.2, 2], [0, 2]], float))
    axes = _frame(figure.add_subplot(), (-0.5, -0.8, 4.6, 2.7))
    _object(axes, outline)
    hand = np.array([[2.75, 1.0], [0.7, 2.0], [1.6, 0.0]])
    for shift, weight in ((0.45, 0.35), (0.9, 0.35), (0.0, 1.0)):
        moved = hand + [shift, 0.0]
        if weight < 1.0:
            axes.add_patch(Polygon(moved, fc="none", ec=QUIET_INK, lw=0.7, ls="--", zorder=3))
            axes.plot(*moved.T, ls="", marker="o", ms=3.0, mfc=PAPER, mec=QUIET_INK, zorder=4)
    _hand(axes, hand, numbers=True)
    axes.annotate(
        "", (3.75, 1.45), (2.85, 1.45), arrowprops={"arrowstyle": "<->", "color": INK, "lw": 0.8}
    )
    axes.text(3.3, 1.52, "no force either way", fontsize=7.0, ha="center", color=INK)


DRAWN: Final[dict[str, tuple[Callable[[Figure], None], tuple[float, float]]]] = {
    "theory_cells": (theory_cells, (3.6, 3.6)),
    "theory_levels": (theory_levels, (6.4, 4.9)),
    "theory_discs": (theory_discs, (4.4, 4.6)),
    "theory_shelf": (theory_shelf, (4.4, 3.0)),
}
"""What is drawn here, with the size [inch]."""


def _l_cage() -> Cage:
    return plan(load(L))


def _frame(axes: Axes, view: tuple[float, float, float, float]) -> Axes:
    axes.set_xlim(view[0], view[2])
    axes.set_ylim(view[1], view[3])
    axes.set_aspect("equal")
    axes.set_axis_off()
    return axes


def _object(axes: Axes, outline: Outline) -> None:
    path = as_path(outline.polygon)
    axes.add_patch(PathPatch(path, fc=OBJECT_FILL, ec=OBJECT_EDGE, lw=0.9, zorder=2))


def _hand(axes: Axes, fingers: np.ndarray, radius: float = 0.0, numbers: bool = False) -> None:
    axes.add_patch(Polygon(fingers, fc="none", ec=INK, lw=0.9, joinstyle="round", zorder=5))
    for k, (x, y) in enumerate(fingers.tolist()):
        if radius:
            axes.add_patch(Circle((x, y), radius, fc=FINGERS[k], ec=PAPER, lw=0.4, zorder=6))
        else:
            axes.plot([x], [y], marker="o", ms=7, color=FINGERS[k], mec=PAPER, zorder=6)
        if numbers:
            axes.annotate(
                str(k + 1), (x, y), fontsize=5.5, fontweight="bold", color=PAPER,
                ha="center", va="center_baseline", zorder=7,
            )  # fmt: skip


def draw(name: str, path: Path) -> None:
    """One of the pictures that are drawn here."""
    drawing, size = DRAWN[name]
    with matplotlib.rc_context({**FIGURE_SETTINGS, "font.size": 8.0}):
        figure = Figure(figsize=size, facecolor="white", layout="tight")
        FigureCanvasAgg(figure)
        drawing(figure)
        figure.savefig(path, format="svg", metadata={"Date": None})


def run(words: str, folders: dict[str, Path]) -> None:
    """One command, with its folders and files put in."""
    for name, folder in folders.items():
        words = words.replace(name, str(folder))
    code = icage_command(words.split())
    if code:
        raise SystemExit(f"icage {words}: exit {code}")


def main(names: list[str]) -> None:
    """Draw these, or all of them."""
    wanted = names or [*COMMANDS, *PAPER_FIGURES, *DRAWN]
    with tempfile.TemporaryDirectory() as place:
        folders = {name: Path(place) / name for name in ("HOOK",)}
        for made, words in GRASPS.items():
            needed = any(made in COMMANDS.get(name, "") for name in wanted)
            if needed:
                run(words, folders)
        for name in wanted:
            path = FIGURES / f"{name}.svg"
            if name in DRAWN:
                draw(name, path)
            elif name in COMMANDS:
                run(COMMANDS[name], {**folders, "FILE": path})
            else:
                run(f"figures {L} --out PAPER --only {name}", {"PAPER": Path(place) / "paper"})
                copyfile(Path(place) / "paper" / f"{name}.svg", FIGURES / f"{name}_L.svg")


if __name__ == "__main__":
    main(sys.argv[1:])
