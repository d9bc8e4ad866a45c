"""Run one study on other cores, threads, shards and workers, and compare its tables byte for byte.

    python -m benchmarks.cores --trials 400 --json benchmarks/cores.json

Every variable that gives a trial a target of its own varies. The first way is what all others have
to give: ``taskset -c 0``, 1, 2 and 4 threads of linear algebra and of our own, shards of 7 and of
1,000, resumed, and on a dask cluster whose nannies set the threads of their workers.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from pathlib import Path

from tests.oracles.against_itself.cores import CASES, VARIED, tables


def main() -> None:
    """Run, compare, print; exit code 1 if a table differs."""
    parser = argparse.ArgumentParser(description=__doc__, allow_abbrev=False)
    parser.add_argument("--trials", type=int, default=400)
    parser.add_argument("--case", action="append", choices=CASES, help="default: all of them")
    parser.add_argument("--json", type=Path, help="write what was done")
    chosen = parser.parse_args()
    told: dict[str, dict[str, bool]] = {}
    with tempfile.TemporaryDirectory(prefix="icage-cores-") as folder:
        for case in chosen.case or CASES:
            told[case], first = {}, None
            for way, digest in tables(Path(folder), case, chosen.trials):
                first = first or digest
                told[case][way.name] = digest == first
                same = "the same bytes" if digest == first else "DIFFERENT"
                print(f"{case:<8} {way.name:<32} {same}", flush=True)
    whole = {"format": "icage-cores/1", "trials": chosen.trials, "vary": list(VARIED), "same": told}
    if chosen.json:
        chosen.json.write_text(json.dumps(whole, indent=1) + "\n")
    sys.exit(0 if all(all(one.values()) for one in told.values()) else 1)


if __name__ == "__main__":
    main()
