"""The pages of the committed studies, written again from what is there; nothing is run.

    python -m experiments.study.ready.pages                           every results.md
    python -m experiments.study.ready.pages placement-pliers MAP.png  the map of one study, small

Pages are made from study.json. A map needs the table of all trials, which is not committed:
``python -m experiments.study.ready --only placement-pliers`` makes it first.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any, Final

from PIL import Image

from experiments.figures.plan import figure_regions
from experiments.study.ready.__main__ import OUT
from experiments.study.report.map import draw_map
from experiments.study.report.results_md import results_page
from experiments.study.run.command import command_line
from experiments.study.run.document import fingerprint, study_of
from experiments.study.run.finished import read_finished
from experiments.study.run.folder import JSON, PAGE, StudyFolder
from icage.errors import InputError
from icage.formats.whole_files import whole_file

COLOURS: Final = 128
"""Of a small picture: enough for the scale of rates, lines and the edges of letters."""

WIDE: Final = 1000
"""[pixel] Of a small picture."""


def page_of(document: dict[str, Any]) -> str:
    """``results.md`` of a finished study, as today's code writes it."""
    return results_page(document, command_line(document))


def write_pages(folder: Path) -> list[str]:
    """Write the page of every study in a folder of studies; the names of those that changed."""
    changed: list[str] = []
    for path in sorted(folder.glob(f"*/{JSON}")):
        page, text = path.with_name(PAGE), page_of(read_finished(path.parent))
        if not page.exists() or page.read_text(encoding="utf-8") != text:
            with whole_file(page) as part:
                part.write_text(text, encoding="utf-8")
            changed.append(path.parent.name)
    return changed


def draw_small_map(folder: Path, path: Path) -> None:
    """The map of a study that has its table, as a PNG of few colours."""
    document = read_finished(folder)
    cage = study_of(document).cage
    trials = StudyFolder(folder, fingerprint(document)).finished()
    if trials is None:
        raise InputError(f"{str(folder)!r} has no table of its trials")
    draw_map(document, trials, cage, figure_regions(cage), path)
    with Image.open(path) as picture:
        height = round(picture.height * WIDE / picture.width)
        small = picture.convert("RGB").resize((WIDE, height), Image.Resampling.LANCZOS)
        # by coverage: the median cut gives all its colours to the hexagons and none to their scale
        small = small.quantize(COLOURS, method=Image.Quantize.MAXCOVERAGE)
    with whole_file(path) as part:
        small.save(part, format="PNG", optimize=True)


def main() -> None:
    """Write the pages, or one map."""
    parser = argparse.ArgumentParser(
        description=__doc__, allow_abbrev=False, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("study", nargs="?", help="name of the study whose map is drawn")
    parser.add_argument("file", nargs="?", type=Path, help="the PNG to write")
    parser.add_argument("--studies", type=Path, default=OUT, help="folder of the studies")
    chosen = parser.parse_args()
    if chosen.study is None:
        print("\n".join(write_pages(chosen.studies)) or "all pages are as they should be")
    elif chosen.file is None or chosen.file.suffix != ".png":
        parser.error("the map of a study goes into a file whose name ends in .png")
    else:
        draw_small_map(chosen.studies / chosen.study, chosen.file)


if __name__ == "__main__":
    main()
