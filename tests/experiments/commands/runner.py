"""Run the command line as a user does, in its own process, or quicker in this one."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

from experiments.cli import main


@dataclass(frozen=True)
class Result:
    code: int
    out: str
    err: str

    def error_line(self) -> str:
        """The one line that an input error must be, and nothing else."""
        assert self.code == 2, self
        assert self.out == "", self
        assert self.err.startswith("icage: error: "), self
        assert self.err.count("\n") == 1, self
        assert self.err.endswith("\n"), self
        assert self.err[:-1].isprintable(), self
        return self.err[len("icage: error: ") : -1]


def process(*arguments: str, stdin: bytes = b"", cwd: Path | None = None) -> Result:
    command = [sys.executable, "-m", "experiments.cli", *arguments]
    done = subprocess.run(command, input=stdin, capture_output=True, cwd=cwd, timeout=120)
    return Result(done.returncode, done.stdout.decode(), done.stderr.decode())


def here(capsys: pytest.CaptureFixture[str], *arguments: str) -> Result:
    capsys.readouterr()
    try:
        code = main(arguments)
    except SystemExit as stop:
        code = int(stop.code or 0)
    out, err = capsys.readouterr()
    return Result(code, out, err)
