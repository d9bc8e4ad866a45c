"""All grasps of a list in one picture, side by side, as SVG text. Our own."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from typing import Final

from icage.cage import Cage
from icage.formats.picture import EDGE, grasp_picture

_WIDTH: Final = 320.0
"""[px] Longer side of each drawing."""

_GAP: Final = 12.0

_SIZE = re.compile(r'^<svg xmlns="[^"]*" width="(\d+)" height="(\d+)"')


def contact_sheet(cages: Sequence[Cage], captions: Sequence[str]) -> str:
    """Each cage with its target hand, and its widest hand on the way out (dashed), in rows.

    Examples
    --------
    >>> import icage
    >>> cage = icage.plan(icage.load("pliers"))
    >>> contact_sheet([cage, cage], ["1", "2"]).count("<svg")
    3
    """
    columns = max(1, math.ceil(math.sqrt(len(cages))))
    pictures = [grasp_picture(c, text, _WIDTH) for c, text in zip(cages, captions, strict=True)]
    sizes = [_size_of(picture) for picture in pictures]
    width = max((w for w, _ in sizes), default=0) + _GAP
    height = max((h for _, h in sizes), default=0) + _GAP
    rows = math.ceil(len(cages) / columns)
    placed: list[str] = []
    for k, picture in enumerate(pictures):
        x, y = _GAP + width * (k % columns), _GAP + height * (k // columns)
        placed.append(picture.replace("<svg ", f'<svg x="{x:.0f}" y="{y:.0f}" ', 1))
    wide, high = width * columns + _GAP, height * rows + _GAP
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{wide:.0f}" height="{high:.0f}" '
        f'viewBox="0 0 {wide:.0f} {high:.0f}" fill="{EDGE}">'
        f'<rect width="100%" height="100%" fill="white"/>{"".join(placed)}</svg>'
    )


def _size_of(picture: str) -> tuple[int, int]:
    found = _SIZE.match(picture)
    assert found is not None, "every picture of ours begins so"
    return int(found[1]), int(found[2])
