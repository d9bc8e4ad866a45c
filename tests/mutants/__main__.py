"""``python -m tests.mutants --most M --seed S``: are changes of the planner seen by its tests?

First every quick test of the planner runs once, kernels as plain Python, and it is written down
which lines it runs and how long it takes. Then mutants are drawn: of the kernels, and of the
modules around them. Each runs in a forked process with the tests that reach its statement, the
quickest first, until one fails; it survives if none does. Those that can change no answer are
listed in ``equivalent.json``, each with its reason.

    pip install -e ".[test,lines]"
    python -m tests.mutants --reached [TEST ...]    only the first, into out/mutants/reached.json
    python -m tests.mutants --most 200 --seed 27    so many mutants of kernels, a third of it others
    python -m tests.mutants --survivors             those that survived last time, once more
    python -m tests.mutants --file icage/cells/kernels/boxes.py --most 999 --results out/boxes.json
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
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from random import Random
from typing import Any, Final

import pytest

from experiments.environment import ROOT
from experiments.io.intervals import wilson
from tests.mutants.changes import Change, changed, changes_of, statement_lines
from tests.mutants.equivalent import reasons
from tests.mutants.place import functions_in
from tests.mutants.trial import Running, start

QUIET: Final = ("-q", "-n", "0", "--tb=native", "-m", "not slow", "-p", "no:cacheprovider")

TESTED: Final = (
    "tests/icage", "--ignore=tests/icage/formats", "--ignore=tests/icage/test_staging.py",
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
"""[s] Of the quickest tests that reach the statement, which run first ..."""
ALL: Final = 40.0
"""[s] ... and of all that run."""

RESULTS: Final = Path(__file__).with_name("results.json")


@dataclass(frozen=True, slots=True)
class Mutant:
    """A change, of which kind of code, and the function as it is."""

    group: str
    path: Path
    change: Change
    function: ast.FunctionDef
    nth: int
    """Which of the same changes on the same line, from 0."""

    @property
    def file(self) -> str:
        """Its path in the repository."""
        return str(self.path.relative_to(ROOT))

    @property
    def name(self) -> str:
        """For the results."""
        return f"{self.file}: {self.change.name}" + (f" [{self.nth}]" if self.nth else "")

    @property
    def lines(self) -> range:
        """The lines of its statement, of a block only those of its head."""
        return statement_lines(self.function, self.change.line)


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
            seen: Counter[str] = Counter()
            for one in changes_of(function, name):
                found[group].append(Mutant(group, path, one, function, seen[one.name]))
                seen[one.name] += 1
    return found


def equivalents(everything: dict[str, list[Mutant]]) -> dict[str, str]:
    """By name, those that change no answer, with the reason."""
    texts: dict[Path, list[str]] = {}
    named: dict[tuple[str, str, str], list[str]] = {}
    for one in chain.from_iterable(everything.values()):
        lines = texts.setdefault(one.path, one.path.read_text(encoding="utf-8").splitlines())
        change = f"{one.change.before} -> {one.change.after}"
        key = (f"{one.file}: {one.change.function}", lines[one.change.line - 1].strip(), change)
        named.setdefault(key, []).append(one.name)
    return reasons(named)


class Tests:
    """Which tests run for a mutant."""

    def __init__(self, reached: dict[str, Any]) -> None:
        self._seconds = {test: seconds for test, (seconds, _) in reached.items()}
        self._by_line: dict[tuple[str, int], list[str]] = {}
        for test, (_, files) in reached.items():
            for name, lines in files.items():
                for line in lines:
                    self._by_line.setdefault((name, line), []).append(test)

    def of(self, mutant: Mutant, most: float) -> dict[str, float]:
        """Tests that reach a mutant with their seconds, the quickest first."""
        reaching = {t for line in mutant.lines for t in self._by_line.get((mutant.file, line), ())}
        chosen: dict[str, float] = {}
        for test in sorted(reaching, key=lambda test: (self._seconds[test], test)):
            if sum(chosen.values()) + self._seconds[test] > most:
                break
            chosen[test] = self._seconds[test]
        return chosen


def tried(mutants: list[Mutant], tests: Tests, workers: int, most: float) -> dict[str, str]:
    """What became of each: the test that killed it, ``time``, or empty if it survived."""
    found: dict[str, str] = {}
    waiting = list(range(len(mutants)))[::-1]
    running: dict[int, Running] = {}
    while waiting or running:
        while waiting and len(running) < workers:
            k = waiting.pop()
            chosen = tests.of(mutants[k], most)
            if not chosen:
                found[mutants[k].name] = ""
                continue
            one = mutants[k]
            new = changed(one.function, one.change)
            running[k] = start(one.path, one.change.function, new, chosen)
        for k, process in list(running.items()):
            result = process.result()
            if result is not None:
                found[mutants[k].name] = result
                del running[k]
                print(f"{mutants[k].name}: {result or 'SURVIVED'}", flush=True)
        time.sleep(0.02)
    return found


def main() -> int:
    """Draw, try, write the results; 1 if fewer than 85 % of those that are to be are killed."""
    parser = argparse.ArgumentParser(prog="python -m tests.mutants", description="mutants")
    parser.add_argument("--most", type=int, default=300, help="mutants of kernels")
    parser.add_argument("--around", type=int, help="of the others; default: a third of these")
    parser.add_argument("--seed", type=int, default=14)
    parser.add_argument("--seconds", type=float, default=ALL, help="of tests for a survivor")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--file", action="append", help="draw from this file only; may be repeated")
    parser.add_argument("tests", nargs="*", help="with --reached: noted anew are only these")
    parser.add_argument("--reached", action="store_true", help="only which tests reach what")
    parser.add_argument("--survivors", action="store_true", help="those of last time once more")
    parser.add_argument("--notes", type=Path, default=ROOT / "out/mutants/reached.json")
    parser.add_argument("--results", type=Path, default=RESULTS)
    options = parser.parse_args()
    os.chdir(ROOT)
    if options.reached or not options.notes.exists():
        options.notes.parent.mkdir(parents=True, exist_ok=True)
        chosen = options.tests or TESTED
        watching = multiprocessing.Process(target=_watch, args=(options.notes, chosen))
        watching.start()  # here nothing may have been computed before
        watching.join()
        if options.reached:
            return 0
    notes = json.loads(options.notes.read_text())
    tests = Tests(notes)
    everything = all_mutants()
    equal = equivalents(everything)
    counts = {group: len(found) for group, found in everything.items()}
    known: dict[str, str] = {}
    before: dict[str, str] = {}
    if options.survivors:
        old = json.loads(options.results.read_text())
        before = {row["mutant"]: row["killed_by"] for row in old["mutants"]}
        drawn = [one for one in chain.from_iterable(everything.values()) if one.name in before]
        left = [one for one in drawn if not before[one.name] and one.name not in equal]
        options.seed = old["seed"]
    else:
        random = Random(options.seed)
        around = options.most // 3 if options.around is None else options.around
        drawn = _draw(random, everything["kernels"], options.most, options.file)
        drawn += _draw(random, everything["around"], around, options.file)
        left = [one for one in drawn if one.name not in equal]
    pytest.main([*QUIET, *TESTED, "--collect-only", "-qq"])  # loads all of the tests
    for most in (FIRST, options.seconds):
        known |= tried(left, tests, options.workers, most)
        left = [one for one in left if not known[one.name]]
        print(f"{len(left)} of {len(drawn)} left after {most:g} s of tests", flush=True)
        rows = [_row(one, before or known, known, equal) for one in drawn]
        document = _document(options.seed, counts, rows)
        options.results.write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
    print(json.dumps(document["killed"], indent=1))
    return int(document["killed"]["kernels"]["of_the_others"]["rate"] < 0.85)


def _watch(out: Path, tests: Iterable[str]) -> None:
    from tests.mutants.reached import Reached  # only now: coverage is asked for here alone

    pytest.main([*QUIET, *tests], plugins=[Reached(out)])


def _draw(
    random: Random, everything: list[Mutant], most: int, files: list[str] | None
) -> list[Mutant]:
    """So many of them, of some files alone if these are named; all where there are no more."""
    own = [one for one in everything if files is None or one.file in files]
    return random.sample(own, min(most, len(own)))


def _row(
    mutant: Mutant, drawn: dict[str, str], known: dict[str, str], equal: dict[str, str]
) -> dict[str, Any]:
    """What became of a mutant when it was drawn, and, if it survived, since."""
    name, by = mutant.name, drawn.get(mutant.name, "")
    row = {"group": mutant.group, "mutant": name, "kind": mutant.change.kind, "killed_by": by}
    since = known.get(name, "")
    if since and not by:
        row["killed_since_by"] = since
    return row | ({"equivalent": equal[name]} if name in equal else {})


def _document(seed: int, counts: dict[str, int], rows: list[dict[str, Any]]) -> dict[str, Any]:
    killed: dict[str, Any] = {}
    for group in counts:
        here = [row for row in rows if row["group"] == group]
        others = [row for row in here if "equivalent" not in row]
        killed[group] = {
            "of_all": _share(here, "killed_by"),
            "of_the_others": _share(others, "killed_by"),
            "of_the_others_since": _share(others, "killed_by", "killed_since_by"),
        }
    return {"seed": seed, "all": counts, "killed": killed, "mutants": rows}


def _share(rows: list[dict[str, Any]], *by: str) -> dict[str, Any]:
    good = sum(any(row.get(name) for name in by) for row in rows)
    low, high = wilson(good, len(rows)) if rows else (0.0, 1.0)
    return {
        "of": len(rows), "killed": good, "rate": round(good / max(1, len(rows)), 4),
        "interval_95": [round(low, 4), round(high, 4)],
    }  # fmt: skip


if __name__ == "__main__":
    sys.exit(main())
