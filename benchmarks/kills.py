"""Kill a study with SIGKILL at random moments until it is done, and compare with one left alone.

    python -m benchmarks.kills --kills 20 --json benchmarks/kills.json

Every start but the last is killed: one in five while it is still starting, the others while trials
are run and shards are written. After every kill, what was on the disk before must still be there.
In the end every trial must be there once, in rows that are those of an undisturbed run to the last
bit. A shard is small, so that files are being written a good part of the time.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from pathlib import Path

from tests.oracles.against_itself.kills import survive


def main() -> None:
    """Kill, resume, compare, print; exit code 1 if anything is lost, doubled or different."""
    parser = argparse.ArgumentParser(description=__doc__, allow_abbrev=False)
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--seed", type=int, default=20)
    parser.add_argument("--trials", type=int, default=1000)
    parser.add_argument("--shard", type=int, default=5)
    parser.add_argument("--json", type=Path, help="write what was done")
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="icage-kills-") as folder:
        told = survive(Path(folder), chosen.kills, chosen.seed, chosen.trials, chosen.shard)
    for number, kill in enumerate(told["kills"], 1):
        half = f", {kill['half_written']} file half written" if kill["half_written"] else ""
        print(
            f"kill {number:2d}  {kill['after']:6.2f} s after its start, {kill['stage']:<8}  "
            f"{kill['kept']:5d} trials kept{half}"
        )
    print(
        f"{len(told['kills'])} kills, {told['trials']} trials: {told['lost']} lost, "
        f"{told['twice']} twice, {told['left_over']} files left over, "
        f"table {'the same to the last bit' if told['same'] else 'DIFFERENT'}"
    )
    if chosen.json:
        chosen.json.write_text(json.dumps(told, indent=1) + "\n")
    bad = told["lost"] or told["twice"] or told["left_over"] or not told["same"]
    sys.exit(1 if bad else 0)


if __name__ == "__main__":
    main()
