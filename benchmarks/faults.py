"""Commands on a disk that fails at one system call, a thousand times over.

    python -m benchmarks.faults --json benchmarks/faults.json

Study, replay and ``plan --json``, into an empty folder and over an older result, each time with a
fault at another call: open, read, write, fsync, rename, unlink, mkdir, rmdir, stat, scandir; no
room, an input error, a refusal, too many open files, once or from then on, or a write that takes
half. Old results have to be intact or new ones whole, the exit code 0 or 2 with one line, and the
next run, on a disk that is well, has to give the whole result and leave nothing of the broken one.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
from pathlib import Path

from tests.experiments.small import t_case, write_case
from tests.oracles.against_itself.faults import commands, tried, work_done_once


def main() -> None:
    """Try, print, and exit with 1 if anything was lost, half written or left."""
    parser = argparse.ArgumentParser(description=__doc__, allow_abbrev=False)
    parser.add_argument("--faults", type=int, default=1000, help="in all (default 1000)")
    parser.add_argument("--seed", type=int, default=14)
    parser.add_argument("--json", type=Path, help="write what was done")
    chosen = parser.parse_args()
    os.environ["ICAGE_COMPILE_BEHIND"] = "0"
    os.environ.pop("ICAGE_DEBUG", None)
    done = []
    with tempfile.TemporaryDirectory(prefix="icage-faults-") as folder, work_done_once():
        case = write_case(t_case(), Path(folder) / "t.json")
        for command in commands(case):
            share = -(-chosen.faults // 3)
            one = tried(command, Path(folder) / "runs", share, chosen.seed)
            done.append(one)
            print(
                f"{one.command:<12} {one.faults:5d} faults at {one.calls} system calls, exit codes "
                f"{dict(one.codes)}, {len(one.broken)} broken",
                flush=True,
            )
            for sentence in one.broken[:20]:
                print(f"    {sentence}", flush=True)
    document = {
        "format": "icage-faults/1",
        "seed": chosen.seed,
        "faults": sum(one.faults for one in done),
        "commands": [one.document() for one in done],
    }
    if chosen.json:
        chosen.json.write_text(json.dumps(document, indent=1) + "\n")
    sys.exit(1 if any(one.broken for one in done) else 0)


if __name__ == "__main__":
    main()
