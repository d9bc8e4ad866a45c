"""``python -m tests.fuzz --minutes M --seed S``: mutated inputs, and what became of them.

Each input is named by its kind, the seed and its number. What fails is written to a folder, made
smaller, once a kind of fault; the exit code is 1 if anything did.

    python -m tests.fuzz --minutes 10                    all kinds, the time divided among them
    python -m tests.fuzz --formats svg,dxf --most 20000  so many inputs of each, however long
    python -m tests.fuzz --formats svg --from 1234 --most 1   one input again
"""

from __future__ import annotations

import argparse
import sys
from math import inf
from pathlib import Path

from tests.fuzz.campaign import HEAD, Campaign
from tests.fuzz.kinds import KINDS


def main() -> int:
    """Run, print the table, 1 if anything failed."""
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz", description="mutated inputs")
    parser.add_argument("--minutes", type=float, help="in all (no limit with --most, else 10)")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--formats", default=",".join(KINDS), help="kinds, with commas")
    parser.add_argument("--most", type=int, help="inputs of each kind")
    parser.add_argument("--from", type=int, default=0, dest="first", help="number of the first")
    parser.add_argument("--failures", type=Path, default=Path("out/fuzz"), help="folder")
    parser.add_argument("--alone", type=int, default=500, help="every so many runs alone, too")
    options = parser.parse_args()
    kinds = options.formats.split(",")
    unknown = [kind for kind in kinds if kind not in KINDS]
    if unknown:
        parser.error(f"no such kind {', '.join(unknown)}; there are {', '.join(KINDS)}")
    minutes = options.minutes or (inf if options.most else 10.0)
    campaign = Campaign(options.seed, options.failures, every_alone=options.alone)
    print(HEAD, flush=True)
    failed = 0
    try:
        for kind in kinds:
            most = options.most or sys.maxsize
            tally = campaign.run(kind, 60.0 * minutes / len(kinds), most, options.first)
            failed += sum(tally.faults.values())
            print(tally.row(), flush=True)
    finally:
        campaign.guard.close()
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main())
