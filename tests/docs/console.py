"""Run what a page shows after ``$`` and compare what is printed with what is shown.

``icage`` runs in this process, which has the planner loaded already; anything else in a shell.
What a command prints, on either stream, must be what the page shows, but that numbers may differ in
their fifth digit (libraries differ in the last ones) and that a line ``...`` stands for any lines.

    python -m tests.docs.console docs/tutorial.md     runs a page and writes what is printed into it
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from experiments.cli import main
from experiments.environment import ROOT
from tests.docs.blocks import FENCE, arguments, blocks, examples

NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
NEAR = 2e-4
"""A number as shown, relative: few digits are shown of most."""
TINY = 1e-3
"""Errors of physics (3.7e-07) and the like say that they are small, and no more."""
PROGRESS = re.compile(r"^icage: .*: [\d,]+ of [\d,]+(, .*)?\n", re.MULTILINE)


@contextlib.contextmanager
def checkout(folder: Path) -> Iterator[None]:
    """A folder like the checkout that a reader stands in, but that files may be written into."""
    for name in ("docs", "models", "experiments"):
        (folder / name).symlink_to(ROOT / name)
    with contextlib.chdir(folder):
        yield


def run(command: str) -> tuple[int, str]:
    """Exit code and output of one command, run in the current folder; no progress, no colours."""
    words = arguments(command)
    if words[0] != "icage" or "|" in words or ">" in words:
        search = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
        done = subprocess.run(
            command, shell=True, capture_output=True, text=True, timeout=300, check=False,
            env={**os.environ, "PATH": search, "PYTHONPATH": str(ROOT)},
        )  # fmt: skip
        return done.returncode, done.stdout + done.stderr
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(printed):
        try:
            code = main(words[1:])
        except SystemExit as stop:
            code = int(stop.code or 0)
    return code, PROGRESS.sub("", printed.getvalue())


def same(shown: str, printed: str) -> bool:
    """Whether the page shows what was printed, numbers to within ``NEAR``."""
    wanted = [" ".join(line.split()) for line in shown.strip().splitlines()]
    lines = [" ".join(line.split()) for line in printed.strip().splitlines()]
    return _same_lines(wanted, lines)


def _same_lines(wanted: list[str], lines: list[str]) -> bool:
    if not wanted:
        return not lines
    if wanted[0] == "...":
        return any(_same_lines(wanted[1:], lines[k:]) for k in range(len(lines) + 1))
    if not lines or not _same_line(wanted[0], lines[0]):
        return False
    return _same_lines(wanted[1:], lines[1:])


def _same_line(wanted: str, line: str) -> bool:
    if NUMBER.sub("#", wanted) != NUMBER.sub("#", line):
        return False
    pairs = zip(NUMBER.findall(wanted), NUMBER.findall(line), strict=True)
    return all(_near(float(one), float(other)) for one, other in pairs)


def _near(shown: float, printed: float) -> bool:
    small = max(abs(shown), abs(printed)) < TINY
    return small or abs(shown - printed) <= NEAR * max(abs(shown), abs(printed))


def wrong(page: Path, folder: Path) -> list[str]:
    """What the console blocks of a page show that is not so, run one after the other."""
    faults: list[str] = []
    with checkout(folder):
        for block in blocks(page, "console"):
            for example in examples(block.text):
                code, printed = run(example.command)
                if code != 0 or not same(example.shown, printed):
                    faults.append(f"{block}: {example.command}\nexit {code}, prints\n{printed}")
    return faults


def written(page: Path, folder: Path) -> str:
    """The page with what its commands print now; where it leaves out lines, as it is."""

    def again(found: re.Match[str]) -> str:
        if found[1] != "console":
            return found[0]
        parts: list[str] = []
        for example in examples(found[2]):
            code, printed = run(example.command)
            print(f"exit {code}: {example.command}", flush=True)
            kept = example.shown if same(example.shown, printed) else printed.rstrip("\n")
            parts += [f"$ {example.command}", *([kept] if kept else [])]
        return "\n".join(["```console", *parts, "```"])

    with checkout(folder):
        return FENCE.sub(again, page.read_text(encoding="utf-8"))


if __name__ == "__main__":
    for page in (Path(one).resolve() for one in sys.argv[1:]):
        with tempfile.TemporaryDirectory() as folder:
            page.write_text(written(page, Path(folder)), encoding="utf-8")
