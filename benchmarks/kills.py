"""Kill commands at random moments, and compare what comes of them with ones left alone.

    python -m benchmarks.kills --kills 20 --json benchmarks/kills.json
    python -m benchmarks.kills --ends 12 --json benchmarks/ends.json

With ``--ends`` study, replay with video, grasps of a folder, regress, report, video and figures are
each ended so many times, by SIGKILL, SIGTERM and Ctrl-C in turn, at any moment of their work.
Nothing that was there may be lost, no process may be left ten seconds later, and one run more has
to give what an undisturbed one gives, and to leave nothing else in its folder or among temporary
files.

Without it a study is killed with SIGKILL until it is done.

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
from typing import Any

from tests.oracles.against_itself.ends import commands, survived
from tests.oracles.against_itself.kills import survive


def main() -> None:
    """Kill, resume, compare, print; exit code 1 if anything is lost, doubled or different."""
    parser = argparse.ArgumentParser(description=__doc__, allow_abbrev=False)
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--seed", type=int, default=20)
    parser.add_argument("--trials", type=int, default=1000)
    parser.add_argument("--shard", type=int, default=5)
    parser.add_argument("--ends", type=int, help="end each command so many times instead")
    parser.add_argument("--only", default="", help="of these, the one whose name begins so")
    parser.add_argument("--json", type=Path, help="write what was done")
    chosen = parser.parse_args()
    if chosen.ends is not None:
        sys.exit(_ends(chosen.ends, chosen.seed, chosen.only, chosen.json))
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


def _ends(kills: int, seed: int, only: str, file: Path | None) -> int:
    """Exit code: 1 if anything was lost or left."""
    told: list[dict[str, Any]] = []
    with tempfile.TemporaryDirectory(prefix="icage-ends-") as folder:
        for command in commands(Path(folder) / "inputs"):
            if not command.name.startswith(only):
                continue
            one = survived(command, Path(folder) / "runs", kills, seed)
            told.append(one)
            ended = [kill["ended_within"] for kill in one["kills"]]
            print(
                f"{one['command']:<18} {len(one['kills'])} times, {one['seconds_alone']} s alone, "
                f"ended within {max(ended)} s; {len(one['faults'])} faults",
                flush=True,
            )
            for sentence in one["faults"]:
                print(f"    {sentence}", flush=True)
            if file is not None:
                document = {"format": "icage-ends/1", "seed": seed, "commands": told}
                file.write_text(json.dumps(document, indent=1) + "\n")
    return 1 if any(one["faults"] for one in told) else 0


if __name__ == "__main__":
    main()
