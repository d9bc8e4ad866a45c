"""All benchmarks of speed, each in processes of its own.

    python -m benchmarks --json benchmarks/performance.json     everything, five runs each
    python -m benchmarks --quick --only planner --only peers    once, fewer trials
    python -m benchmarks --compare                              exit 1 if something has slipped

``--compare`` looks at the committed ``benchmarks/*_baseline.json``, which each benchmark writes
itself (``--update-baselines`` here writes those of all that were run). Runs of different benchmarks
take turns, so that a minute in which the machine is busy does not strike one of them alone.
``python -m benchmarks.report`` writes docs/performance.md from the JSON.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from benchmarks.figures import BENCHMARKS, baseline_path, figures_of, measured, slipped, there
from benchmarks.timing import REPEATS
from experiments.environment import ROOT
from experiments.io.versions import versions


def main() -> int:
    """Run, print, compare, write."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", allow_abbrev=False)
    parser.add_argument("--only", action="append", choices=BENCHMARKS, metavar="NAME",
                        help=f"again for more; of {', '.join(BENCHMARKS)}")  # fmt: skip
    parser.add_argument("--quick", action="store_true", help="one run with fewer trials")
    parser.add_argument("--runs", type=int, help=f"of each ({REPEATS}; 1 with --quick)")
    parser.add_argument("--json", type=Path, help="write everything")
    parser.add_argument("--keep", action="store_true", help="what FILE has of other benchmarks")
    parser.add_argument("--compare", action="store_true", help="exit 1 if a figure has slipped")
    parser.add_argument("--update-baselines", action="store_true")
    options = parser.parse_args()
    if options.quick and options.update_baselines:
        parser.error("--update-baselines needs whole runs: leave --quick away")
    runs = options.runs or (1 if options.quick else REPEATS)
    if runs < 1:
        parser.error(f"--runs is {runs}; at least 1 is needed")
    names = [name for name in BENCHMARKS if name in (options.only or BENCHMARKS)]
    load = os.getloadavg()[0]
    ran, failed = run_all([name for name in names if there(name)], runs, options.quick)
    document = {
        "format": "icage-benchmarks/1",
        "quick": options.quick,
        "cores": os.cpu_count(),
        "versions": versions(),
        "load": sorted((load, os.getloadavg()[0])),
        "benchmarks": ran,
    }
    worse = tell(ran)
    for name in (name for name in names if not there(name)):
        print(f"{name}: not in this checkout")
    for name in failed:
        print(f"{name}: FAILED, see above")
    if options.json is not None:
        if options.keep and options.json.exists():
            document = together(json.loads(options.json.read_text(encoding="utf-8")), document)
        options.json.write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
    if options.update_baselines:
        for name, documents in ran.items():
            text = json.dumps(middle(documents), indent=1) + "\n"
            baseline_path(name).write_text(text, encoding="utf-8")
    return int(bool(failed) or (options.compare and worse > 0))


def together(old: dict[str, Any], new: dict[str, Any]) -> dict[str, Any]:
    """Both runs, a benchmark of the newer one where both have it. Only runs of one kind go."""
    for what in ("quick", "versions"):
        if old[what] != new[what]:
            raise SystemExit(
                f"--keep: {what} was {old[what]} and is {new[what]}; measure all again"
            )
    kept = {name: runs for name, runs in old["benchmarks"].items() if name in BENCHMARKS}
    load = [f(old["load"][k], new["load"][k]) for k, f in enumerate((min, max))]
    return new | {"load": load, "benchmarks": kept | new["benchmarks"]}


def run_all(names: list[str], runs: int, quick: bool) -> tuple[dict[str, list[Any]], list[str]]:
    """What each benchmark wrote in each run, and those that failed."""
    ran: dict[str, list[Any]] = {name: [] for name in names}
    failed: list[str] = []
    for run in range(runs):
        for name in names:
            if name in failed or (run > 0 and BENCHMARKS[name].repeats):
                continue
            print(f"--- {name}, run {run + 1} of {runs}", file=sys.stderr, flush=True)
            written = run_one(name, quick)
            if written is None:
                failed.append(name)
            else:
                ran[name].append(written)
    return {name: documents for name, documents in ran.items() if name not in failed}, failed


def run_one(name: str, quick: bool) -> Any:
    """One run in a child; what it wrote, or None if it failed."""
    options = BENCHMARKS[name].quick if quick else ()
    with tempfile.TemporaryDirectory(prefix="icage-") as folder:
        path = Path(folder) / "figures.json"
        call = [sys.executable, "-m", f"benchmarks.{name}", "--json", str(path), *options]
        done = subprocess.run(call, cwd=ROOT, stdout=sys.stderr, check=False)
        if done.returncode != 0 or not path.exists():
            return None
        return json.loads(path.read_text(encoding="utf-8"))


def middle(documents: list[Any]) -> Any:
    """The documents of several runs as one: the median of each number."""
    first = documents[0]
    if isinstance(first, dict):
        return {key: middle([one[key] for one in documents]) for key in first}
    if isinstance(first, list):
        return [middle(list(parts)) for parts in zip(*documents, strict=True)]
    if isinstance(first, int | float) and not isinstance(first, bool):
        return statistics.median(documents)
    return first


def tell(ran: dict[str, list[Any]]) -> int:
    """Print every figure beside its baseline; how many have slipped."""
    worse = 0
    print(f"{'figure':<58} {'median':>9} {'least':>9} {'largest':>9} {'baseline':>9}  unit")
    for name, documents in ran.items():
        path = baseline_path(name)
        base = [json.loads(path.read_text(encoding="utf-8"))] if path.exists() else []
        print(f"{BENCHMARKS[name].title} ({name})")
        for figure in figures_of(name, documents):
            now, was = measured(figure, documents), measured(figure, base)
            if now is None:
                print(f"  {figure.name:<56} {'not measured':>9}")
                continue
            bad = was is not None and slipped(figure, now["median"], was["median"])
            worse += bad
            print(
                f"  {figure.name:<56} {now['median']:9.4g} {now['min']:9.4g} {now['max']:9.4g}"
                f" {'-' if was is None else format(was['median'], '.4g'):>9}  {figure.unit}"
                f"{f'  WORSE (by more than {figure.tolerance:.0%})' if bad else ''}"
            )
    return worse


if __name__ == "__main__":
    sys.exit(main())
