r"""How often the paper's condition is right, on the tools and the solved cases.

    python -m benchmarks.paper_condition --json benchmarks/paper_condition.json \
        --figures docs/figures

"Each finger in its region and sigma < sigma_max", sampled (10,000 placements a case where the
condition is met often enough) and compared with the joint query.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import binomtest

from experiments.figures.paper_condition import draw_counterexample
from icage.formats.case_json import read_case
from icage.paper_condition import ConditionReport, sample_condition
from icage.planner import plan

ROOT = Path(__file__).parents[1]
FILES = [
    *sorted((ROOT / "models" / "cases").glob("*.json")),
    *sorted((ROOT / "models" / "objects").glob("*/cases/*.json")),
]


def main() -> None:
    """Print a table and write it."""
    parser = argparse.ArgumentParser(description=__doc__, allow_abbrev=False)
    parser.add_argument("--count", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=2018)
    parser.add_argument("--json", type=Path)
    parser.add_argument("--figures", type=Path, help="draw counterexamples into this folder (.svg)")
    chosen = parser.parse_args()
    rows: list[dict[str, Any]] = []
    for number, path in enumerate(FILES):
        case = read_case(path)
        cage = plan(case.outline, case.contacts, case.finger_radius)
        if cage.status == "not_a_cage":
            continue
        rng = np.random.default_rng([chosen.seed, number])
        report = sample_condition(cage, chosen.count, rng)
        rows.append(row(case.name, cage.status, report))
        print(json.dumps(rows[-1]))
        if chosen.figures and report.counterexample is not None:
            verdict = "/".join(report.outside)
            file = chosen.figures / f"condition_{case.name.replace('/', '_')}.svg"
            draw_counterexample(cage, report.counterexample, verdict, file)
    if chosen.json:
        document = {"format": "icage-condition/1", "count": chosen.count, "seed": chosen.seed}
        chosen.json.write_text(json.dumps({**document, "cases": rows}, indent=1) + "\n")


def row(name: str, verdict: str, report: ConditionReport) -> dict[str, Any]:
    """One line of the table, with a 95 % Wilson interval."""
    low, high = (0.0, 1.0)
    if report.tested:
        interval = binomtest(report.in_cage, report.tested).proportion_ci(method="wilson")
        low, high = float(interval.low), float(interval.high)
    example = report.counterexample
    return {
        "case": name,
        "verdict": verdict,
        "tested": report.tested,
        "tried": report.tried,
        "right": report.in_cage,
        "share_right": round(report.share_right, 5),
        "interval_95": [round(low, 5), round(high, 5)],
        "tested_from_sigma_0": report.tested_open,
        "right_from_sigma_0": report.in_cage_open,
        "wrong": report.outside,
        "counterexample": None if example is None else example.tolist(),
    }


if __name__ == "__main__":
    main()
