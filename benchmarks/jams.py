r"""Physics judges sigma_first(mu) of random disc grasps, drawn and not chosen.

    python -m benchmarks.jams --count 60 --json benchmarks/jams.json

The same closings, attacks and thresholds as ``python -m experiments.jams`` for the shipped cases;
targets of seven families of polygons, discs of 1 to 8 % of the diameter. Exit code 1 if anything
did not hold.
"""

from __future__ import annotations

import argparse
import sys

import numpy as np

from experiments.io.progress import stage_bar
from experiments.jams.document import jams_document, page
from experiments.jams.many import judge_many
from icage.case import Case
from icage.errors import InputError
from icage.formats.json_out import write_json
from icage.outline import Outline
from tests.oracles.targets import random_target

RADII = (0.01, 0.08)
"""[diameter]"""


def drawn(count: int, seed: int) -> dict[str, Case]:
    """So many random targets; those whose discs overlap or that are no case are drawn again."""
    found: dict[str, Case] = {}
    for number in range(10 * count):
        rng = np.random.default_rng([seed, number])
        target = random_target(rng, radius=float(rng.uniform(*RADII)))
        name = f"{target.family} {number}"
        try:
            outline = Outline(target.vertices)
            found[name] = Case(name, "mm", outline, target.radius, target.contacts)
        except InputError:
            continue
        if len(found) == count:
            break
    return found


def main() -> int:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=60)
    parser.add_argument("--trials", type=int, default=30)
    parser.add_argument("--attacks", type=int, default=10)
    parser.add_argument("--seed", type=int, default=2018)
    parser.add_argument("--json", help="write the document here")
    asked = parser.parse_args()
    cases = drawn(asked.count, asked.seed)
    with stage_bar() as report:
        rows, skipped = judge_many(cases, asked.trials, asked.attacks, asked.seed, report)
    document = jams_document(rows, [], skipped)
    if asked.json is not None:
        write_json(document, asked.json)
    print("\n".join(page(document, f"python -m benchmarks.jams --count {asked.count}")))
    return 1 if document["failures"] else 0


if __name__ == "__main__":
    sys.exit(main())
