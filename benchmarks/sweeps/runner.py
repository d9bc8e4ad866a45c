"""Run a seeded sweep over numbered targets in at most two processes and write its report."""

from __future__ import annotations

import argparse
import json
import multiprocessing
import platform
import time
from collections import Counter
from contextlib import ExitStack
from dataclasses import asdict
from importlib.metadata import version
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from tqdm import tqdm

from tests.oracles.against_itself.outcome import TOLERANCE, Judge, Outcome


def options(description: str, count: int) -> argparse.ArgumentParser:
    """The options that all sweeps share."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--count", type=int, default=count, help="targets (default %(default)s)")
    parser.add_argument("--first", type=int, default=0, help="number of the first target")
    parser.add_argument("--seed", type=int, default=2018)
    parser.add_argument("--processes", type=int, default=2, choices=(1, 2))
    parser.add_argument("--json", type=Path, help="write the report here")
    parser.add_argument(
        "--log", type=Path, help="a line for each target that is done; if it exists, go on there"
    )
    return parser


def run(judge: Judge, chosen: argparse.Namespace) -> list[Outcome]:
    """Outcomes of all targets, in order."""
    wanted = range(chosen.first, chosen.first + chosen.count)
    done = {o.number: o for o in _logged(chosen.log) if o.number in wanted}
    jobs = [(judge, chosen.seed, n) for n in wanted if n not in done]
    with ExitStack() as stack:
        log = stack.enter_context(chosen.log.open("w")) if chosen.log else None
        if chosen.processes == 1:
            found = map(_call, jobs)
        else:
            pool = multiprocessing.get_context("spawn").Pool(chosen.processes)
            found = stack.enter_context(pool).imap(_call, jobs, chunksize=4)
        again = list(done.values())
        for outcome in chain(again, tqdm(found, total=len(jobs), mininterval=5.0)):
            done[outcome.number] = outcome
            if log is not None:
                log.write(json.dumps(asdict(outcome)) + "\n")
                log.flush()
    return [done[n] for n in wanted]


def _logged(log: Path | None) -> list[Outcome]:
    """What an earlier run left; a line cut short by a kill is no outcome."""
    if log is None or not log.exists():
        return []
    return [Outcome(**json.loads(x)) for x in log.read_text().splitlines(True) if x[-1:] == "\n"]


def _call(job: tuple[Judge, int, int]) -> Outcome:
    judge, seed, number = job
    return judge(seed, number)


def report(
    name: str,
    outcomes: list[Outcome],
    chosen: argparse.Namespace,
    began: float,
    tolerance: float | dict[str, float] = TOLERANCE,
) -> int:
    """Print and write what was found; the exit code is 1 if anything disagreed or failed."""
    openings = [o.opening for o in outcomes if o.opening is not None]
    wide = sum(x > 1.05 for x in openings) + sum(o.verdict == "never_escapes" for o in outcomes)
    bad = [o for o in outcomes if o.disagreements]
    failed = [o for o in outcomes if o.exceptions]
    worst_of: dict[str, float] = {}
    for key, worst in (pair for o in outcomes for pair in o.worst_of.items()):
        worst_of[key] = max(worst_of.get(key, 0.0), worst)
    summary: dict[str, Any] = {
        "format": "icage-sweep/1",
        "sweep": name,
        "command": f"python -m benchmarks.sweeps.{name} --count {chosen.count} "
        f"--first {chosen.first} --seed {chosen.seed}"
        + (" --every-resolution" if getattr(chosen, "every_resolution", False) else ""),
        "targets": len(outcomes),
        "runs": sum(o.runs for o in outcomes),
        "tolerance": tolerance,
        "targets_that_disagree": len(bad),
        "exceptions": len(failed),
        "worst_difference_below_tolerance": max((o.worst for o in outcomes), default=0.0),
        **({"worst_difference_below_each": worst_of} if worst_of else {}),
        "opening_above_1.05": wide,
        "share_above_1.05": round(wide / max(1, len(outcomes)), 4),
        "median_opening": round(float(np.median(openings)), 4) if openings else None,
        "verdicts": dict(Counter(o.verdict for o in outcomes)),
        "families": dict(sorted(Counter(o.family for o in outcomes).items())),
        "seconds": round(time.perf_counter() - began, 1),
        "processes": chosen.processes,
        "versions": {
            "python": platform.python_version(),
            **{p: version(p) for p in ("numpy", "shapely", "numba")},
        },
        "details": [asdict(o) for o in (*bad, *failed)],
    }
    text = json.dumps(summary, indent=1)
    if chosen.json:
        chosen.json.write_text(text + "\n")
    print(text)
    return 1 if bad or failed else 0
