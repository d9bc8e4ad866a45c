"""Commands that are killed, asked to end and interrupted at random moments: what is left."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

SIGNALS: Final = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT)

_MARK: Final = "ICAGE_TEST_MARK"
"""Variable of the environment by which processes that a command has started are known."""

_PATIENCE: Final = 60.0
"""[s] For a command to end that was asked to."""

_GRACE: Final = 10.0
"""[s] For processes to notice that whom they work for is gone."""


@dataclass(frozen=True)
class Ended:
    """A command; ``{}`` in its arguments is the folder that it writes to.

    Attributes
    ----------
    kept:
        Files whose content has to be that of an undisturbed run, in the end.
    together:
        Whether, at any moment, either none of these is there or all are.
    """

    name: str
    arguments: tuple[str, ...]
    kept: tuple[str, ...]
    together: bool = False


def survived(command: Ended, folder: Path, kills: int, seed: int) -> dict[str, Any]:
    """End the command so many times, let it run to its end, and say what became of all."""
    rng = np.random.default_rng(seed)
    temporary = folder / "tmp"
    temporary.mkdir(parents=True)
    alone, place = folder / "alone", folder / "place"
    for folder_of in (alone, place):
        folder_of.mkdir()
        (folder_of / "thesis.txt").write_text("mine")
    begun = time.monotonic()
    code, words = _run(command, alone, temporary)
    took = time.monotonic() - begun
    assert code == 0, words
    whole = {name: (alone / name).read_bytes() for name in command.kept}
    told: list[dict[str, Any]] = []
    faults: list[str] = []
    for number in range(kills):
        sent = SIGNALS[number % len(SIGNALS)]
        mark = f"{folder}-{number}"
        before = _kept(command, place)
        begun = time.monotonic()
        child = _start(command, place, temporary, mark)
        time.sleep(rng.uniform(0.0, took))
        after = time.monotonic() - begun
        child.send_signal(sent)
        asked = time.monotonic()
        try:
            _, words = child.communicate(timeout=_PATIENCE)
        except subprocess.TimeoutExpired:
            faults.append(f"kill {number}: {sent.name}: goes on, or somebody holds its output")
            child.kill()
            _, words = child.communicate()
        ended = time.monotonic() - asked
        left = _processes(mark)
        while left and time.monotonic() < asked + ended + _GRACE:
            time.sleep(0.1)
            left = _processes(mark)
        if left:
            faults.append(f"kill {number}: {sent.name}: processes left: {left}")
        code = child.returncode
        if code not in (0, *_codes(sent)):
            faults.append(f"kill {number}: {sent.name}: exit code {code}: {words.strip()[-300:]}")
        now = _kept(command, place)
        if command.together and len(now) not in (0, len(command.kept)):
            faults.append(f"kill {number}: only {sorted(now)} there")
        if lost := sorted(set(before) - set(now)):
            faults.append(f"kill {number}: lost {lost}")
        hidden = len(list(place.rglob(".icage-*"))) + len(list(temporary.iterdir()))
        told.append(
            {
                "signal": sent.name, "after": round(after, 2), "code": code,
                "ended_within": round(ended, 2), "left_for_the_next_run": hidden,
            }
        )  # fmt: skip
    code, words = _run(command, place, temporary)
    if code:
        faults.append(f"the last run: {code}: {words}")
    differ = [name for name in command.kept if (place / name).read_bytes() != whole[name]]
    faults += [f"{name} is not as an undisturbed run writes it" for name in differ]
    others = _names(place) ^ _names(alone)
    faults += [f"left or missing: {name}" for name in sorted(others)]
    faults += [f"left in the folder for temporary files: {p.name}" for p in temporary.iterdir()]
    shutil.rmtree(folder)
    return {
        "command": command.name, "seconds_alone": round(took, 1), "kills": told, "faults": faults,
    }  # fmt: skip


def _codes(sent: signal.Signals) -> tuple[int, ...]:
    """A command that has not begun yet is ended by the system itself."""
    return (-sent,) if sent == signal.SIGKILL else (128 + sent, -sent)


def _names(folder: Path) -> set[str]:
    return {str(path.relative_to(folder)) for path in folder.rglob("*")}


def _kept(command: Ended, place: Path) -> dict[str, bytes]:
    return {n: (place / n).read_bytes() for n in command.kept if (place / n).exists()}


def _start(command: Ended, place: Path, temporary: Path, mark: str) -> subprocess.Popen[str]:
    words = [word.replace("{}", str(place)) for word in command.arguments]
    return subprocess.Popen(
        [sys.executable, "-m", "experiments.cli", *words],
        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        env={**os.environ, _MARK: mark, "TMPDIR": str(temporary)}, start_new_session=True,
        # whoever starts this in the background of a shell has interrupts ignored by inheritance
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )  # fmt: skip


def _run(command: Ended, place: Path, temporary: Path) -> tuple[int, str]:
    child = _start(command, place, temporary, "")
    _, words = child.communicate()
    return child.returncode, words


def _processes(mark: str) -> list[str]:
    """Command lines of living processes with this mark in their environment."""
    found: list[str] = []
    wanted = f"{_MARK}={mark}".encode()
    for place in Path("/proc").glob("[0-9]*"):
        try:
            if wanted in (place / "environ").read_bytes().split(b"\0"):
                words = (place / "cmdline").read_bytes().replace(b"\0", b" ").decode()
                found.append(f"{place.name} {words[:200]}")
        except OSError:
            continue
    return found


def commands(inputs: Path) -> Sequence[Ended]:
    """Small ones that write in every way there is; ``inputs`` is a folder for what they read.

    The replay that a report is of is made here, by the command itself.
    """
    from experiments.cli import main
    from tests.experiments.small import t_case, write_case

    inputs.mkdir(parents=True)
    case = str(write_case(t_case(), inputs / "t.json"))
    for folder, count in (("objects", 4), ("cases", 2)):
        (inputs / folder).mkdir()
        for k in range(count):
            shutil.copy(case, inputs / folder / f"t{k}.json")
    assert (
        main(("replay", case, "--trials", "6", "--no-video", "--out", str(inputs / "replay"))) == 0
    )
    study = ("study", "pliers", "--vary", "place_xy=normal:5mm", "--vary", "friction=0:0.1")
    study += ("--trials", "200", "--shard", "8", "--resume", "--out", "{}")
    return (
        Ended("study", study, ("trials.parquet", "map.svg", "rates.svg")),
        Ended(
            "replay with video", ("replay", case, "--trials", "6", "--out", "{}"),
            ("trials.parquet", "replay.json", "regions.svg", "replay.mp4"), together=True,
        ),
        Ended(
            "grasps",
            ("grasps", str(inputs / "objects"), "--out", "{}/table.parquet", "--workers", "2"),
            ("table.parquet",),
        ),
        Ended(
            "regress",
            ("regress", "--fast", "--cases", str(inputs / "cases"), "--out", "{}", "--workers", "2",
             "--json", "{}/regress.json"),
            ("trials.parquet", "replay.json"), together=True,
        ),
        Ended(
            "report", ("report", str(inputs / "replay"), "--out", "{}/page.html"), ("page.html",)
        ),
        Ended(
            "video",
            ("video", case, "--scene", "closings", "--seconds", "2", "--size", "360p",
             "--out", "{}/film.mp4", "--sheet", "{}/sheet.png", "--gif", "{}/film.gif"),
            ("film.mp4", "sheet.png", "film.gif"),
        ),
        Ended("figures", ("figures", case, "--out", "{}"), ("search.svg", "tunnel.svg")),
    )  # fmt: skip
