"""Inputs of one kind after another within a budget; what failed is kept, once a kind of fault."""

from __future__ import annotations

import json
import shlex
import subprocess
import sys
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from tests.fuzz.job import Job, Outcome, fault, kind_of
from tests.fuzz.kinds import job_of
from tests.fuzz.minimize import smaller
from tests.fuzz.worker import Guard

_ALONE: Final = "import sys; from experiments.cli import main; sys.exit(main())"


@dataclass(slots=True)
class Tally:
    """What came of the inputs of one kind."""

    kind: str
    codes: Counter[int | None] = field(default_factory=Counter)
    faults: Counter[str] = field(default_factory=Counter)
    alone: int = 0
    clock: float = 0.0
    slowest: float = 0.0
    largest: int = 0

    @property
    def total(self) -> int:
        """Inputs run."""
        return sum(self.codes.values())

    def row(self) -> str:
        """A row of the log."""
        rate = self.total / self.clock if self.clock else 0.0
        return (
            f"| {self.kind} | {self.total} | {self.codes[0]} | {self.codes[2]} | "
            f"{sum(self.faults.values())} | {rate:.0f} | {self.slowest:.1f} | "
            f"{self.largest / 1e6:.0f} | {self.alone} |"
        )


HEAD: Final = (
    "| kind | inputs | exit 0 | exit 2 | faults | a second | slowest [s] | most memory [MB] | "
    "in a process of their own |\n|---|---|---|---|---|---|---|---|---|"
)


@dataclass(slots=True)
class Campaign:
    """A seed, a place for what fails, and a worker."""

    seed: int
    failures: Path | None
    guard: Guard = field(default_factory=Guard)
    every_alone: int = 0
    """Every so many inputs one runs in a process of its own, too, as a user's does; 0: none."""

    def run(self, kind: str, seconds: float, most: int, first: int = 0) -> Tally:
        """Inputs ``first``, ``first`` + 1, ... of a kind until time or ``most`` is reached."""
        tally, started = Tally(kind), time.monotonic()
        for number in range(first, first + most):
            if time.monotonic() - started >= seconds:
                break
            job = job_of(kind, self.seed, number)
            outcome = self.guard.run(job)
            self._count(tally, job, outcome, number)
            if self.every_alone and number % self.every_alone == 0 and job.call == "main":
                tally.alone += 1
                self._count(tally, job, run_alone(job), number, again=True)
        tally.clock = time.monotonic() - started
        return tally

    def _count(
        self, tally: Tally, job: Job, outcome: Outcome, number: int, again: bool = False
    ) -> None:
        if not again:
            tally.codes[outcome.code] += 1
            tally.slowest = max(tally.slowest, outcome.seconds)
            tally.largest = max(tally.largest, outcome.peak)
        found = fault(outcome)
        if not found:
            return
        same = kind_of(found)
        tally.faults[same] += 1
        name = f"{tally.kind}-{self.seed}-{number}"
        if tally.faults[same] > 1:
            print(f"{name}: the same again", file=sys.stderr, flush=True)
        elif self.failures is not None:
            print(f"{name}: {found}", file=sys.stderr, flush=True)
            # what had to be ended would take as long again with every piece left out
            whole = again or outcome.code is None
            least = (
                job if whole else smaller(job, lambda j: kind_of(fault(self.guard.run(j))) == same)
            )
            keep(least, found, self.failures / name)


def keep(job: Job, found: str, folder: Path) -> None:
    """Write the files of a failing job, its command and its fault into a folder."""
    for name, content in job.files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    words = {"call": job.call, "arguments": job.arguments, "fault": found}
    text = json.dumps(words, indent=1)
    (folder / "JOB.txt").write_text(
        f"icage {shlex.join(job.arguments)}\n{text}\n", "utf-8", "replace"
    )


def run_alone(job: Job) -> Outcome:
    """A job as a user's command, in a process of its own; its memory and time are not measured."""
    import tempfile

    with tempfile.TemporaryDirectory(prefix="icage-fuzz-") as place:
        for name, content in job.files.items():
            path = Path(place) / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
        root = str(Path(__file__).parents[2])
        try:
            done = subprocess.run(
                [sys.executable, "-c", f"import sys; sys.path.insert(0, {root!r}); {_ALONE}",
                 *job.arguments],
                cwd=place, capture_output=True, timeout=60.0, check=False,
                stdin=subprocess.DEVNULL,
            )  # fmt: skip
        except subprocess.TimeoutExpired:
            return Outcome(None, "still at work after 60 s, alone", 60.0, 0)
    return Outcome(done.returncode, done.stderr.decode("utf-8", "replace"), 0.0, 0)
