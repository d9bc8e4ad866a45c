"""Studies and their bare loops of two checkouts, in turns.

    python -m benchmarks.study_against CHECKOUT [--case pliers saw] [--trials 4000] [--passes 9]

Each checkout has a process of its own, which is told when its turn is: so a busy neighbour strikes
both, and what a share is divided by is measured right after the study. Processor seconds.
"""

from __future__ import annotations

import argparse
import json
import statistics
import subprocess
import sys
from pathlib import Path
from typing import Any

from benchmarks.timing import spread

_WORKER = """
import json, sys
sys.path.insert(0, "")
from benchmarks import study
from benchmarks.timing import timed
from icage.kernels.compiled import machine_code_at_once
machine_code_at_once()
case, trials = sys.argv[1], int(sys.argv[2])
with study._session(case, 20, {}) as session:
    study._study(session)  # compiles what is compiled once
shards = None
for line in sys.stdin:
    with study._session(case, trials, {}) as session:
        seconds, _ = timed(lambda: study._study(session))
        shards = shards or study._steps_of(session.study)
    print(json.dumps([seconds, study._bare(shards)]), flush=True)
"""


def main() -> None:
    """Print least, median and largest of both, case by case."""
    parser = argparse.ArgumentParser(description=__doc__, allow_abbrev=False)
    parser.add_argument("checkout", type=Path)
    parser.add_argument("--case", nargs="+", default=["pliers"])
    parser.add_argument("--trials", type=int, default=4000)
    parser.add_argument("--passes", type=int, default=9)
    options = parser.parse_args()
    for case in options.case:
        places = {"older": options.checkout, "this": Path.cwd()}
        processes = {name: _worker(case, options.trials, at) for name, at in places.items()}
        found: dict[str, list[tuple[float, float]]] = {name: [] for name in places}
        for turn in range(options.passes + 1):
            for name, process in processes.items():
                times = _turn(process)
                if turn:  # the first one warms up
                    found[name].append(times)
        for process in processes.values():
            process.communicate()
        for name, times in found.items():
            _tell(f"{case}, {name}", times)
        older, this = (statistics.median(s for s, _ in found[name]) for name in places)
        print(f"{case}: a study takes {this / older:.3f} of its time, median with median")


def _worker(case: str, trials: int, checkout: Path) -> subprocess.Popen[str]:
    call = [sys.executable, "-c", _WORKER, case, str(trials)]
    pipe = subprocess.PIPE
    return subprocess.Popen(call, cwd=checkout, stdin=pipe, stdout=pipe, text=True)


def _turn(process: Any) -> tuple[float, float]:
    """[s] One study and its bare loop."""
    process.stdin.write("\n")
    process.stdin.flush()
    study, bare = json.loads(process.stdout.readline())
    return study, bare


def _tell(name: str, times: list[tuple[float, float]]) -> None:
    studies, bares = (list(column) for column in zip(*times, strict=True))
    shares = spread(bare / study for study, bare in times)
    print(
        f"{name}: study {min(studies):.3f} s, median {statistics.median(studies):.3f}; "
        f"bare {min(bares):.3f} s, median {statistics.median(bares):.3f}; share "
        f"{shares['min']:.3f}, {shares['median']:.3f}, {shares['max']:.3f}, "
        f"least with least {min(bares) / min(studies):.3f}",
        flush=True,
    )


if __name__ == "__main__":
    main()
