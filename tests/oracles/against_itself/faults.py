"""Commands on a disk that fails at one system call: old results intact or new ones whole.

Each command runs in this process, again and again, with a fault at another of the calls that it
makes of files: an error of the disk, a full disk, a refusal, once or from then on, or a write that
takes half. Planning and closing are done once and handed out: what is tried is what is written.
After each fault the disk is well again and the command runs once more: its result is whole, and
nothing of the broken run is left.
"""

from __future__ import annotations

import contextlib
import errno
import io
import shutil
import zlib
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from experiments.cli import main
from icage.staging import sweep
from tests.faults import SHORT, Disk

ERRORS: Final = {
    "ENOSPC": errno.ENOSPC, "EIO": errno.EIO, "EACCES": errno.EACCES, "EMFILE": errno.EMFILE,
    "short write": SHORT,
}  # fmt: skip

State = dict[str, bytes]


@dataclass
class Tried:
    """A command and what came of it under faults."""

    command: str
    calls: int = 0
    faults: int = 0
    unfinished: int = 0
    kinds: Counter[str] = field(default_factory=Counter[str])
    codes: Counter[str] = field(default_factory=Counter[str])
    broken: list[str] = field(default_factory=list)

    def document(self) -> dict[str, Any]:
        """JSON-ready."""
        return {
            "command": self.command, "system_calls": self.calls, "faults": self.faults,
            "by_call": dict(sorted(self.kinds.items())), "exit_codes": dict(self.codes),
            "ended_by_the_next_look": self.unfinished, "broken": self.broken,
        }  # fmt: skip


@dataclass
class Command:
    """A command line in a folder.

    Attributes
    ----------
    new, newer:
        Arguments that write one result and another one in its place.
    check:
        Sentences on what is wrong, given what was there before and what is there now.
    """

    name: str
    new: tuple[str, ...]
    newer: tuple[str, ...]
    check: Callable[[State, State, State], Iterator[str]]
    starts: tuple[str, ...] = ("fresh", "over an older one")


def files(folder: Path) -> State:
    """Content of every file below a folder."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def run(arguments: tuple[str, ...], disk: Disk | None) -> tuple[int, str]:
    """Exit code and what was said on standard error."""
    words = io.StringIO()
    with (
        contextlib.redirect_stdout(io.StringIO()),
        contextlib.redirect_stderr(words),
        pytest.MonkeyPatch.context() as patch,
    ):
        if disk is not None:
            disk.install(patch)
        code = main(list(arguments))
    return code, words.getvalue()


def all_or_nothing(before: State, now: State, whole: State) -> Iterator[str]:
    """The results are those from before, or all of them are the new ones; files of others stay."""
    mine = _results(now)
    if mine not in (before, whole):
        changed = [n for n in {*before, *mine} if before.get(n) != mine.get(n)]
        yield f"neither old nor new: {sorted(changed)}"


def no_trial_lost(before: State, now: State, whole: State) -> Iterator[str]:
    """Of a study each trial stays that was there, in a table or in a shard; tables are whole."""
    lost = _trials(before) - _trials(now)
    if lost:
        yield f"trials lost: {sorted(lost)}"
    table = now.get("trials.parquet")
    if table not in (None, before.get("trials.parquet"), whole["trials.parquet"]):
        yield "a table that is neither the old nor the new one"


def _trials(state: State) -> set[int]:
    found: set[int] = set()
    for name, content in state.items():
        if name.endswith(".parquet") and ".icage-" not in name:
            table = pq.read_table(pa.BufferReader(content), columns=["trial"])
            found |= set(table["trial"].to_pylist())
    return found


def tried(command: Command, folder: Path, most: int, seed: int) -> Tried:
    """The command under at most ``most`` faults, spread over its calls."""
    told = Tried(command.name)
    plans: list[tuple[str, int, str, bool]] = []
    for start in command.starts:
        place = _prepared(command, folder, start)
        disk = Disk(place)
        code, words = run(_at(command.newer, place), disk)
        assert code == 0, words
        told.calls += len(disk.calls)
        for at, call in enumerate(disk.calls):
            for name in ERRORS:
                if (name == "short write") == (call == "write"):
                    plans += [(start, at, name, False)]
                if name != "short write":
                    plans += [(start, at, name, False), (start, at, name, True)]
    plans = list(dict.fromkeys(plans))
    rng = np.random.default_rng([seed, zlib.crc32(command.name.encode())])
    chosen = rng.permutation(len(plans))[:most]
    wholes = {start: _whole(command, folder, start) for start in command.starts}
    for k in sorted(chosen.tolist()):
        start, at, name, _for_good = plans[k]
        _one(command, folder, plans[k], wholes[start], told)
    return told


def _one(
    command: Command, folder: Path, plan: tuple[str, int, str, bool], whole: State, told: Tried
) -> None:
    start, at, name, for_good = plan
    place = _prepared(command, folder, start)
    before = files(place)
    disk = Disk(place, at, ERRORS[name], for_good)
    code, words = run(_at(command.newer, place), disk)
    if any(place.glob(".icage-*/moves")):  # moves that the disk let neither end nor be undone
        told.unfinished += 1
        sweep(place)  # as whoever looks at them next does
    now = files(place)
    call = disk.calls[at] if at < len(disk.calls) else "none"
    what = f"{start}, call {at} ({call}), {name}{', for good' if for_good else ''}"
    told.faults += 1
    told.kinds[call] += 1
    told.codes[str(code)] += 1
    if code not in (0, 2):
        told.broken.append(f"{what}: exit code {code}: {words.strip()}")
    errors = [line for line in words.splitlines() if line.startswith("icage: error")]
    if code == 2 and len(errors) != 1:
        told.broken.append(f"{what}: {len(errors)} lines of error: {words.strip()}")
    told.broken += [f"{what}: {one}" for one in command.check(before, now, whole)]
    if code == 0:
        told.broken += [f"{what}: {one}" for one in _differs(_results(now), whole)]
    code, words = run(_at(command.newer, place), None)
    if code:
        told.broken.append(f"{what}: then, on a disk that is well: {code}: {words.strip()}")
    else:
        told.broken += [f"{what}: then, {one}" for one in _differs(files(place), whole)]


def _results(now: State) -> State:
    """Without what a disk that removes nothing has kept: the next run removes it."""
    return {n: content for n, content in now.items() if ".icage-" not in n and "shards/" not in n}


def _differs(now: State, whole: State) -> Iterator[str]:
    now = {name: content for name, content in now.items() if not name.startswith("set-aside/")}
    if now != whole:
        names = {*now, *whole}
        yield f"not the result: {sorted(n for n in names if now.get(n) != whole.get(n))}"


def _prepared(command: Command, folder: Path, start: str) -> Path:
    """The folder as it is before the command, from a copy made once."""
    place, kept = folder / "place", folder / f"kept {command.name} {start}"
    if not kept.exists():
        shutil.rmtree(place, ignore_errors=True)
        place.mkdir(parents=True)
        (place / "thesis.txt").write_text("mine")
        if start != "fresh":
            code, words = run(_at(command.new, place), None)
            assert code == 0, words
        shutil.copytree(place, kept)
    shutil.rmtree(place, ignore_errors=True)
    shutil.copytree(kept, place)
    return place


def _whole(command: Command, folder: Path, start: str) -> State:
    place = _prepared(command, folder, start)
    code, words = run(_at(command.newer, place), None)
    assert code == 0, words
    return files(place)


def _at(arguments: tuple[str, ...], place: Path) -> tuple[str, ...]:
    return tuple(word.replace("{}", str(place)) for word in arguments)


def commands(case: Path) -> list[Command]:
    """What is tried; ``case`` is a case file with disc fingers."""
    study = ("study", str(case), "--vary", "place_xy=normal:0.2", "--no-figures", "--shard", "3")
    study += ("--threads", "1", "--out", "{}", "--resume")
    replay = ("replay", str(case), "--no-video", "--threads", "1", "--out", "{}")
    return [
        Command(
            "study", (*study, "--trials", "6"), (*study, "--trials", "12"), no_trial_lost,
        ),
        Command(
            "replay", (*replay, "--trials", "3"), (*replay, "--trials", "4"), all_or_nothing
        ),
        Command(
            "plan --json", ("plan", str(case), "--json", "{}/plan.json", "--method", "cells"),
            ("plan", str(case), "--json", "{}/plan.json", "--method", "both"), all_or_nothing,
        ),
    ]  # fmt: skip


@contextlib.contextmanager
def work_done_once() -> Iterator[None]:
    """Planning, closing and drawing of the same thing are done once and handed out."""
    from experiments.commands import replay as replay_command  # noqa: F401
    from experiments.replay import files as replay_files
    from experiments.replay import run as replay_run
    from experiments.study.run import document, session, shards

    known: dict[str, Any] = {}

    def once(real: Callable[..., Any], key: Callable[..., str]) -> Callable[..., Any]:
        def call(*given: Any, **named: Any) -> Any:
            name = f"{real.__name__} {key(*given, **named)}"
            if name not in known:
                known[name] = real(*given, **named)
            return known[name]

        return call

    def drawn(cage: Any, regions: Any, name: str, unit: str, path: Path) -> None:
        from icage.formats.whole_files import whole_file

        with whole_file(path) as part:
            part.write_text("a picture")

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            replay_run, "replay",
            once(replay_run.replay, lambda cases, trials, seed, *_: f"{trials} {seed}"),
        )  # fmt: skip
        patch.setattr(replay_files, "draw_plan", drawn)
        patch.setattr(
            replay_files, "figure_regions", once(replay_files.figure_regions, lambda _: "")
        )
        patch.setattr(
            shards, "shard_table", once(shards.shard_table, lambda study, span: str(span))
        )
        patch.setattr(session, "physical_case", once(session.physical_case, lambda case: case.name))
        patch.setattr(document, "physical_case", session.physical_case)
        yield
