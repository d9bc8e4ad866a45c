"""Physics judges sigma_first(mu): closings from both sides, attacks on the jams that limit it.

    python -m experiments.jams [CASE ...] [--trials N] [--attacks N] [--settings]

For the shipped cases, or those named. Exit code 1 if anything did not hold.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from experiments.io.options import add_json, count, file_name, seed
from experiments.io.progress import stage_bar
from experiments.jams.document import jams_document, page
from experiments.jams.many import judge_many, with_settings
from icage.case import Case
from icage.formats.case_json import read_case
from icage.formats.json_out import write_json
from icage.formats.load import load
from icage.formats.whole_files import whole_file
from icage.kernels.compiled import long_job
from models import CASES, FRICTION, HARD, grasp_cases


def main() -> int:
    """Command line."""
    parser = argparse.ArgumentParser(prog="python -m experiments.jams", description=__doc__)
    parser.add_argument("cases", metavar="CASE", nargs="*", help="case files (all that ship)")
    parser.add_argument(
        "--trials", metavar="N", type=count, default=60, help="closings from each side of a level"
    )
    parser.add_argument(
        "--attacks", metavar="N", type=count, default=20, help="attacks beside a jam, each"
    )
    parser.add_argument("--seed", metavar="S", type=seed, default=0, help="of all random numbers")
    parser.add_argument(
        "--settings", action="store_true", help="repeat with other settings of the engine"
    )
    parser.add_argument("--markdown", metavar="FILE", type=file_name, help="the result as a page")
    add_json(parser)
    asked = parser.parse_args()
    long_job()
    named = {name: load(name) for name in asked.cases} if asked.cases else shipped()
    with stage_bar() as report:
        rows, skipped = judge_many(named, asked.trials, asked.attacks, asked.seed, report)
        changed = with_settings(rows, report) if asked.settings else []
    document = jams_document(rows, changed, skipped)
    if asked.json is not None:
        write_json(document, asked.json)
    lines = list(page(document, f"python -m experiments.jams {' '.join(sys.argv[1:])}".rstrip()))
    if asked.markdown is not None:
        with whole_file(Path(asked.markdown)) as part:
            part.write_text("\n".join(lines) + "\n", encoding="utf-8")
    if asked.json != "-":
        print("\n".join(lines))
    return 1 if document["failures"] else 0


def shipped() -> dict[str, Case]:
    """The solved problems, grasps made for friction, the hard ones, the tools' own grasps."""
    paths = {path.stem: path for path in sorted(CASES.glob("*.json"))}
    paths |= {f"friction/{path.stem}": path for path in sorted(FRICTION.glob("*.json"))}
    paths |= {f"hard/{path.stem}": path for path in sorted(HARD.glob("*.json"))}
    return {name: read_case(path) for name, path in (paths | grasp_cases()).items()}


if __name__ == "__main__":
    sys.exit(main())
