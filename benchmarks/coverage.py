"""How often a study's printed intervals hold the true rate: fixed lengths, and early stopping.

    python -m benchmarks.coverage --json benchmarks/coverage.json

Every run counts successes at a known rate and prints Wilson's 95 % interval; the coverage is the
share of runs whose interval holds that rate. Beside what was simulated stands the exact coverage:
a binomial sum for a fixed number of trials, and for runs that stop by themselves the distribution
of the count carried from look to look. Stopped runs look as the study does.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np

from experiments.io.intervals import (
    AT_LEAST,
    CONFIDENCE,
    LOOK_EVERY,
    exact_coverage,
    wilson_bounds,
)
from tests.oracles.against_itself.stopping import exact_stops, simulated_stops

FIXED = ((0.9, 200), (0.99, 1000), (0.5, 200), (0.9, 20), (0.97, 500), (0.999, 500),
         (0.999, 1000), (0.999, 10_000))  # fmt: skip
RATES = (0.5, 0.9, 0.97, 0.99, 0.999)
HALF_WIDTHS = (0.005, 0.01, 0.02)


def main() -> None:
    """Print two tables and write them."""
    parser = argparse.ArgumentParser(description=__doc__, allow_abbrev=False)
    parser.add_argument("--runs", type=int, default=20_000)
    parser.add_argument("--seed", type=int, default=95)
    parser.add_argument("--json", type=Path, help="write the figures")
    chosen = parser.parse_args()
    rng = np.random.default_rng(chosen.seed)
    print(f"coverage of Wilson's 95 % interval in {chosen.runs} runs each, seed {chosen.seed}")
    print("  rate  trials  simulated   exact")
    fixed = []
    for rate, trials in FIXED:
        row = fixed_row(rate, trials, chosen.runs, rng)
        print(f"{rate:6g}  {trials:6d}  {row['simulated']:9.4f}  {row['exact']:6.4f}")
        fixed.append(row)
    print(f"stopped at a half width, looking every {LOOK_EVERY} trials from {AT_LEAST} on")
    print("  rate  half width  simulated   exact  mean trials   exact")
    stopped = []
    for rate in RATES:
        for wanted in HALF_WIDTHS:
            row = stopped_row(rate, wanted, chosen.runs, rng)
            print(
                f"{rate:6g}  {wanted:10g}  {row['simulated']:9.4f}  {row['exact']:6.4f}"
                f"  {row['mean_trials']:11.0f}  {row['mean_trials_exact']:6.0f}"
            )
            stopped.append(row)
    if chosen.json:
        document = {
            "format": "icage-coverage/1", "runs": chosen.runs, "seed": chosen.seed,
            "confidence": CONFIDENCE, "look_every": LOOK_EVERY, "at_least": AT_LEAST,
            "fixed": fixed, "stopped": stopped,
        }  # fmt: skip
        chosen.json.write_text(json.dumps(document, indent=1) + "\n")


def fixed_row(rate: float, trials: int, runs: int, rng: np.random.Generator) -> dict[str, Any]:
    """Coverage after a fixed number of trials."""
    low, high = wilson_bounds(rng.binomial(trials, rate, runs), trials)
    return {
        "rate": rate,
        "trials": trials,
        "simulated": float(((low <= rate) & (rate <= high)).mean()),
        "exact": round(exact_coverage(rate, trials), 6),
    }


def stopped_row(rate: float, wanted: float, runs: int, rng: np.random.Generator) -> dict[str, Any]:
    """Coverage of runs that stop at a half width, and how long they are."""
    simulated, trials = simulated_stops(rate, wanted, runs, rng)
    exact, trials_exact = exact_stops(rate, wanted)
    return {
        "rate": rate,
        "half_width": wanted,
        "simulated": simulated,
        "exact": round(exact, 6),
        "mean_trials": round(trials, 1),
        "mean_trials_exact": round(trials_exact, 1),
    }


if __name__ == "__main__":
    main()
