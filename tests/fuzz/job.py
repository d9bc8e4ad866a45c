"""One input: files, what is asked about them, and what came of it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final


@dataclass(frozen=True, slots=True)
class Job:
    """Files in an empty folder, and the arguments of the command that runs there.

    ``call`` is ``main`` for the command line, or a name in ``tests.fuzz.calls.CALLS``.
    """

    files: dict[str, bytes]
    arguments: tuple[str, ...]
    call: str = "main"
    spoiled: str = ""
    """The file that was mutated; empty if it was something else."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """How a job ended.

    Attributes
    ----------
    code:
        Exit code, or what stands for it; None if the process had to be ended, or died.
    err:
        Standard error.
    seconds:
        [s] Of processor time, all threads.
    peak:
        [byte] Most memory the process held, its libraries among it.
    new:
        Files that were not there before.
    """

    code: int | None
    err: str
    seconds: float
    peak: int
    new: tuple[str, ...] = field(default=())


MOST_SECONDS: Final = 10.0
"""[s] Of processor time."""

PATIENCE: Final = 40.0
"""[s] By the clock: whoever has hardly had any processor time by then waits for something, and is
ended; others when they have had so much of it. On a machine that does other things the clock says
little."""

MOST_MEMORY: Final = 1_000_000_000
"""[byte]"""


CHECK_FAILED: Final = "icage: replay-trial failed: "
"""A record that is no more what was recorded is found out: exit 1 is meant for that."""


def fault(outcome: Outcome) -> str:
    """What is wrong with an outcome, one word and the reason; empty if nothing is."""
    lines = outcome.err.splitlines()
    if outcome.code is None:
        return f"ended: {outcome.err[-300:]}"
    if "Traceback (most recent" in outcome.err:
        return f"traceback: {lines[-1]}"
    if outcome.code == 1 and len(lines) == 1 and lines[0].startswith(CHECK_FAILED):
        return ""
    if outcome.code not in (0, 2):
        return f"exit {outcome.code}: {outcome.err[-400:]}"
    noise = [line for line in lines if not line.startswith("icage: ")]
    if noise:
        return f"noise: {noise[0]}"
    errors = [line for line in lines if line.startswith("icage: error: ")]
    told = lines[-1:] or ["none"]
    if errors != (told if outcome.code else []):
        return f"lines: exit {outcome.code} and {lines}"
    if errors and not (errors[0].isprintable() and len(errors[0]) > len("icage: error: ") + 8):
        return f"lines: {errors[0]!r}"
    if outcome.code == 2 and outcome.new:
        return f"files: exit 2 and {', '.join(outcome.new)} written"
    if outcome.seconds > MOST_SECONDS:
        return f"time: {outcome.seconds:.1f} s"
    if outcome.peak > MOST_MEMORY:
        return f"memory: {outcome.peak / 1e6:.0f} MB"
    return ""


def kind_of(fault: str) -> str:
    """What faults of one kind have in common: digits and names are left out.

    >>> kind_of("exit 1: row 3 of 'a.svg'")
    "exit N: row N of '...'"
    """
    import re

    plain = re.sub(r"'[^']*'|\"[^\"]*\"", "'...'", fault)
    return re.sub(r"[-+]?[\d.]+(e[-+]?\d+)?", "N", plain)[:160]
