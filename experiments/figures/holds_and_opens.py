"""The README's two pictures: a cage that holds, and the way out once the hand has opened too far.

    python -m experiments.figures.holds_and_opens docs/figures

writes ``holds.svg`` and ``opens.svg`` of the pliers with the hand of the paper.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Final

from icage.formats.load import load
from icage.formats.picture import cage_picture, way_out_picture
from icage.formats.whole_files import whole_file
from icage.planner import plan

SHOWN: Final = "pliers/2_paper_shape"
WIDTH: Final = 400.0


def main(folder: str) -> None:
    """Plan, draw, write."""
    cage = plan(load(SHOWN))
    pictures = {"holds": cage_picture(cage, WIDTH), "opens": way_out_picture(cage, WIDTH)}
    for name, text in pictures.items():
        with whole_file(Path(folder) / f"{name}.svg") as part:
            part.write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1])
