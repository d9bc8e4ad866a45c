"""Files of every format, written by the programs that own it, and what icage reads from them."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from icage.formats.drawings.read import trace_file
from icage.formats.drawings.reading import Reading
from icage.formats.drawings.trace import Traced


def traced_bytes(folder: Path, name: str, content: bytes | str, **reading: Any) -> Traced:
    """What is read from a file of this content."""
    path = folder / name
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return trace_file(path, Reading(**reading))


def at_origin(shape: shapely.Polygon) -> shapely.Polygon:
    """Moved so that its bounding box begins at (0, 0), as outlines are."""
    low = np.array(shape.bounds[:2])
    return shapely.transform(shape, lambda points: points - low)


def off_by(found: Traced, exact: shapely.Polygon) -> float:
    """Hausdorff distance of the outline's boundary from an exact one, as a share of its width.

    Both are sampled finely: the distance of vertices alone may be too small.
    """
    exact = at_origin(exact)
    x_low, y_low, x_high, y_high = exact.bounds
    width = max(x_high - x_low, y_high - y_low)
    own, true = found.outline.polygon.exterior, exact.exterior
    shapely.prepare([own, true])
    there, back = (
        shapely.distance(ring, shapely.points(shapely.get_coordinates(fine))).max()
        for ring, fine in (
            (own, shapely.segmentize(true, width / 2_000)),
            (true, shapely.segmentize(own, width / 2_000)),
        )
    )
    return float(max(there, back)) / width


def refused(path: Path, *options: str, seconds: float = 60.0) -> str:
    """The one line with which the command line refuses a file, in a process with 1 GB of heap.

    Time is no assertion here beyond a bound against hanging; the least that a process needs
    (libraries alone map some GB) is left out of the limit by limiting data, not addresses.
    """
    program = (
        "import resource, sys; resource.setrlimit(resource.RLIMIT_DATA, (2**30, 2**30));"
        "from experiments.cli import main; sys.exit(main())"
    )
    done = subprocess.run(
        [sys.executable, "-c", program, "outline", str(path), *options],
        capture_output=True, text=True, timeout=seconds, check=False,
    )  # fmt: skip
    assert done.returncode == 2, (done.returncode, done.stderr[-2000:])
    assert done.stdout == ""
    lines = done.stderr.splitlines()
    assert len(lines) == 1, done.stderr[-2000:]
    return lines[0]
