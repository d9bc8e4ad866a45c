"""A counterexample to the paper's condition: fingers in their regions, and no cage."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import shapely
from matplotlib.backends.backend_agg import FigureCanvasAgg

from experiments.figures.drawing.palette import INK, QUIET_INK
from experiments.figures.drawing.plan_view import draw_plan_view
from experiments.figures.drawing.sheet import lay_out
from experiments.figures.drawing.written import settings
from icage.arrays import FloatArray
from icage.cage import Cage, Puncture
from icage.cells.regions import caging_regions
from icage.formats.whole_files import whole_file

_STRIP = 44.0
"""[pt]"""

_FINEST = 1e-3
"""[diameter] Regions are drawn this exactly (a fifth of a point): their certified bounds have
thousands of corners that nobody can see."""


def draw_counterexample(cage: Cage, placement: FloatArray, verdict: str, path: Path) -> None:
    """Draw target, regions at sigma_max and a placement (4,) that meets the condition, as SVG."""
    finest = _FINEST * cage.outline.diameter
    regions = [
        replace(r, geometry=shapely.simplify(r.geometry, finest))
        for r in caging_regions(cage)
        if r.bound == "inner"
    ]
    hand = cage.hand.fingers(placement)
    bounds = shapely.total_bounds(
        np.array([cage.outline.polygon, *(r.geometry for r in regions)], dtype=object)
    )
    box = (float(bounds[0]), float(bounds[1]), float(bounds[2]), float(bounds[3]))
    with settings():
        sheet = lay_out(box, box, _STRIP)
        FigureCanvasAgg(sheet.figure)
        shown = Puncture(float(placement[3]), "intermediate", (), hand, ())
        draw_plan_view(sheet.axes, sheet.main, cage, regions, shown)
        ratio = placement[3] / cage.sigma_0
        lines = (
            (INK, "Solid: the target grasp. Dashed: every finger in its own caging region,"),
            (INK, rf"$\sigma$ = {ratio:.3g} $\sigma_0$, and yet the query says: {verdict}."),
            (
                QUIET_INK,
                "The regions are shadows of the cage: to stand in all three is not enough.",
            ),
        )
        for row, (colour, text) in enumerate(lines):
            sheet.axes.text(sheet.left, _STRIP - 4.0 - 13.0 * row, text, color=colour, fontsize=8.5)
        with whole_file(path) as part:
            sheet.figure.savefig(part, format=path.suffix[1:], dpi=160)
