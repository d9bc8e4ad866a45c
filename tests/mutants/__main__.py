"""``python -m tests.mutants --most M --seed S``: are changes of the planner seen by its tests?

First every quick test of the planner runs once, kernels as plain Python, and it is written down
which functions it reaches and how long it takes. Then mutants are drawn: of the kernels, and of the
modules around them. Each runs in a forked process with the tests that reach its function, until one
fails; it survives if none does.

    python -m tests.mutants --reached            only the first, into out/mutants/reached.json
    python -m tests.mutants --most 300 --seed 14    so many mutants of kernels, a third of it others
    python -m tests.mutants --survivors             those that survived last time, once more
"""

from __future__ import annotations

import os

if __name__ == "__main__":  # a changed kernel is plain Python: before anything is loaded
    os.environ["NUMBA_DISABLE_JIT"] = "1"

import argparse
import ast
import json
import multiprocessing
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from random import Random
from typing import Any, Final

import pytest

from experiments.environment import ROOT
from experiments.io.intervals import wilson
from tests.mutants.changes import Change, changed, changes_of
from tests.mutants.place import functions_in
from tests.mutants.reached import Reached
from tests.mutants.trial import Running, start

TESTED: Final = (
    "-q", "-n", "0", "--tb=native", "-m", "not slow", "-p", "no:cacheprovider", "tests/icage",
    "--ignore=tests/icage/formats", "--ignore=tests/icage/test_staging.py",
    *(f"--ignore=tests/icage/kernels/test_{name}.py" for name in (
        "background", "claims", "compiled", "going_over", "interpreted",
    )),
)  # fmt: skip
"""Not those of files, nor of how kernels are compiled."""

NOT_KERNELS: Final = ("background", "claims", "compiled", "compiling", "digest", "machine")
"""What is in ``icage/kernels`` for the sake of compiling."""

AROUND: Final = ("cells", "contact_space", "discs", "friction", "geometry", "grasps", "placing")
"""Rooms of the planner."""

FIRST: Final = 2.0
"""[s] Of tests, drawn among those that reach the function, that run first ..."""
ALL: Final = 8.0
"""[s] ... and of all that run."""

_STRONG: Final = "test_recorded_answers"
"""What sees most runs first, the quickest of it before the others."""

RESULTS: Final = Path(__file__).with_name("results.json")


@dataclass(frozen=True, slots=True)
class Mutant:
    """A change, of which kind of code, and the function as it is."""

    group: str
    path: Path
    change: Change
    function: ast.FunctionDef

    @property
    def key(self) -> str:
        """As in the notes of which tests reach what."""
        return f"{self.path.relative_to(ROOT)}:{self.change.function}"

    @property
    def name(self) -> str:
        """For the results."""
        return f"{self.path.relative_to(ROOT)}: {self.change.name}"


def all_mutants() -> dict[str, list[Mutant]]:
    """By group, in the order of the files."""
    found: dict[str, list[Mutant]] = {"kernels": [], "around": []}
    for path in sorted((ROOT / "icage").rglob("*.py")):
        parts = path.relative_to(ROOT / "icage").parts
        group = "kernels" if "kernels" in parts else "around"
        if parts[-1].removesuffix(".py") in NOT_KERNELS:
            continue
        if group == "around" and parts[0] not in AROUND:
            continue
        for name, function in functions_in(path).items():
            found[group] += [
                Mutant(group, path, one, function) for one in changes_of(function, name)
            ]
    return found


class Tests:
    """Which tests run for a mutant."""

    def __init__(self, reached: dict[str, Any], seed: int) -> None:
        self._seconds = {test: seconds for test, (seconds, _) in reached.items()}
        self._by_function: dict[str, list[str]] = {}
        for test, (_, names) in reached.items():
            for name in names:
                self._by_function.setdefault(name, []).append(test)
        self._seed = seed

    def of(self, key: str, most: float) -> tuple[list[str], float]:
        """Tests that reach a function, and their seconds together."""
        tests = sorted(self._by_function.get(key, []))
        Random(f"{self._seed}/{key}").shuffle(tests)
        tests.sort(key=lambda test: (_STRONG not in test, _STRONG in test and self._seconds[test]))
        chosen: list[str] = []
        total = 0.0
        for test in tests:
            if total + self._seconds[test] <= most:
                chosen.append(test)
                total += self._seconds[test]
        return chosen, total


def tried(mutants: list[Mutant], tests: Tests, workers: int, most: float) -> dict[int, str]:
    """What became of each: the test that killed it, ``time``, or empty if it survived."""
    found: dict[int, str] = {}
    waiting = list(range(len(mutants)))[::-1]
    running: dict[int, Running] = {}
    while waiting or running:
        while waiting and len(running) < workers:
            k = waiting.pop()
            chosen, seconds = tests.of(mutants[k].key, most)
            if not chosen:
                found[k] = ""
                continue
            one = mutants[k]
            new = changed(one.function, one.change)
            running[k] = start(one.path, one.change.function, new, chosen, seconds)
        for k, process in list(running.items()):
            result = process.result()
            if result is not None:
                found[k] = result
                del running[k]
                print(f"{mutants[k].name}: {result or 'SURVIVED'}", flush=True)
        time.sleep(0.02)
    return found


def main() -> int:
    """Draw, try, write the results; 1 if fewer than 85 % of the kernels' mutants are killed."""
    parser = argparse.ArgumentParser(prog="python -m tests.mutants", description="mutants")
    parser.add_argument("--most", type=int, default=300, help="mutants of kernels")
    parser.add_argument("--seed", type=int, default=14)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--reached", action="store_true", help="only which tests reach what")
    parser.add_argument("--survivors", action="store_true", help="those of last time once more")
    parser.add_argument("--notes", type=Path, default=ROOT / "out/mutants/reached.json")
    parser.add_argument("--results", type=Path, default=RESULTS)
    options = parser.parse_args()
    os.chdir(ROOT)
    if options.reached or not options.notes.exists():
        options.notes.parent.mkdir(parents=True, exist_ok=True)
        watching = multiprocessing.Process(target=_watch, args=(options.notes,))
        watching.start()  # here nothing may have been computed before
        watching.join()
        if options.reached:
            return 0
    notes = json.loads(options.notes.read_text())
    tests = Tests(notes, options.seed)
    everything = all_mutants()
    if options.survivors:
        old = json.loads(options.results.read_text())
        alive = {row["mutant"] for row in old["mutants"] if not row["killed_by"]}
        drawn = [one for group in everything.values() for one in group if one.name in alive]
    else:
        random = Random(options.seed)
        drawn = random.sample(everything["kernels"], options.most)
        drawn += random.sample(everything["around"], options.most // 3)
    pytest.main([*TESTED, "--collect-only", "-qq"])  # loads all of the tests
    found = tried(drawn, tests, options.workers, 0.0 if options.survivors else FIRST)
    left = [k for k in range(len(drawn)) if not found[k]]
    print(f"{len(left)} of {len(drawn)} left after the first tests", flush=True)
    again = tried([drawn[k] for k in left], tests, options.workers, ALL)
    found |= {left[k]: result for k, result in again.items()}
    if options.survivors:
        known = {drawn[k].name: result for k, result in found.items()}
        rows = [row | {"killed_by": known.get(row["mutant"], row["killed_by"])}
                for row in old["mutants"]]  # fmt: skip
        counts = old["all"]
    else:
        rows = [_row(drawn[k], found[k]) for k in range(len(drawn))]
        counts = {group: len(found) for group, found in everything.items()}
    document = _document(options.seed, counts, rows)
    options.results.write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
    print(json.dumps(document["killed"], indent=1))
    return int(document["killed"]["kernels"]["rate"] < 0.85)


def _watch(out: Path) -> None:
    pytest.main(list(TESTED), plugins=[Reached(out)])


def _row(mutant: Mutant, killed_by: str) -> dict[str, Any]:
    return {
        "group": mutant.group,
        "mutant": mutant.name,
        "kind": mutant.change.kind,
        "tie": mutant.change.is_tie,
        "killed_by": killed_by,
    }


def _document(seed: int, counts: dict[str, int], rows: list[dict[str, Any]]) -> dict[str, Any]:
    killed: dict[str, Any] = {}
    for group in counts:
        here = [row for row in rows if row["group"] == group]
        good = sum(bool(row["killed_by"]) for row in here)
        low, high = wilson(good, len(here))
        killed[group] = {
            "of": len(here), "killed": good, "rate": round(good / max(1, len(here)), 4),
            "interval_95": [round(low, 4), round(high, 4)],
            "survivors_that_are_ties": sum(not r["killed_by"] and r["tie"] for r in here),
        }  # fmt: skip
    return {"seed": seed, "all": counts, "killed": killed, "mutants": rows}


if __name__ == "__main__":
    sys.exit(main())
