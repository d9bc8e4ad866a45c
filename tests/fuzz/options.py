"""Command lines: options of every command, some of them wrong."""

from __future__ import annotations

import argparse
from functools import cache
from random import Random
from typing import Final

from tests.fuzz.job import Job
from tests.fuzz.mutations.values import WORDS, scalar
from tests.fuzz.seeds.documents import cases, placements, plans
from tests.fuzz.seeds.drawings import dxf, svg

_QUICK: Final = ("plan", "query", "outline")
"""Commands that are run; of the others only the options are read."""

_FILES: Final = (
    "a.json", "a.svg", "a.dxf", "plan.json", "p.csv", "none.json", ".", "sub", "wrench", "a.txt",
    "pliers/1_best", "pliers/9", "new.json", "new.svg", "sub/new.png", "-", "", "no/new.json",
    "/dev/null", "/dev/full", "/proc/none", "a.dwg",
)  # fmt: skip


@cache
def _actions(command: str) -> tuple[argparse.Action, ...]:
    from experiments.cli import parser

    found = next(a for a in parser()._actions if isinstance(a, argparse._SubParsersAction))
    return tuple(a for a in found.choices[command]._actions if a.dest != "help")


@cache
def _commands() -> tuple[str, ...]:
    from experiments.cli import parser

    found = next(a for a in parser()._actions if isinstance(a, argparse._SubParsersAction))
    return tuple(found.choices)


@cache
def _files() -> dict[str, bytes]:
    return {
        "a.json": cases()[0], "a.svg": svg()[0], "a.dxf": dxf()[0], "plan.json": plans()[1],
        "p.csv": placements()[1], "a.txt": b"words", "sub/x": b"", "a.dwg": b"AC1027",
    }  # fmt: skip


def option_job(random: Random) -> Job:
    """A command with a few options; most of them with values that fit."""
    quick = random.random() < 0.5
    command = random.choice(_QUICK if quick else _commands())
    words: list[str] = [command]
    places = [action for action in _actions(command) if not action.option_strings]
    names = [action for action in _actions(command) if action.option_strings]
    for action in places:
        if random.random() < 0.95:
            words += _values(action, random)
    for action in random.sample(names, min(len(names), random.choice((0, 1, 1, 2, 3, 6)))):
        at = random.choice((len(words), 1))
        words[at:at] = [random.choice(action.option_strings), *_values(action, random)]
    if random.random() < 0.15:
        words.insert(random.randrange(len(words) + 1), random.choice(("--", "--no", "-x", *WORDS)))
    if random.random() < 0.1:
        words[random.randrange(len(words))] += random.choice(("=", "=1", "s", "\udc80", "é"))
    if random.random() < 0.05:
        del words[random.randrange(len(words))]
    words = [word.replace("\0", "") for word in words]
    call = "main" if words and words[0] in _QUICK else "parsed only"
    return Job(_files(), tuple(words), call)


def _values(action: argparse.Action, random: Random) -> list[str]:
    if action.nargs == 0:
        return []
    count = action.nargs if isinstance(action.nargs, int) else random.choice((1, 1, 1, 2))
    return [_value(action, random) for _ in range(count if action.option_strings else 1)]


def _value(action: argparse.Action, random: Random) -> str:
    way = random.random()
    if action.choices is not None and way < 0.8:
        return str(random.choice(list(action.choices)))
    if way < 0.1:
        return random.choice(WORDS)
    if action.type is not None and getattr(action.type, "__name__", "") not in ("file_name", "str"):
        return scalar(random) if way < 0.5 else random.choice(("1", "2", "0.5", "10", "40"))
    return random.choice(_FILES)
