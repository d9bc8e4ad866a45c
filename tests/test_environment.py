"""The environment maker: what it would install, and where it finds it."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from experiments.environment import ROOT, _pip, environment, lower_bounds, run_in


def test_lower_bounds_are_those_declared():
    bounds = lower_bounds().splitlines()
    declared = (ROOT / "pyproject.toml").read_text()
    assert len(bounds) >= 12
    for bound in bounds:
        name, version = bound.split("==")
        assert f'"{name}>={version}' in declared


def test_constraints_name_no_host_and_no_path():
    for line in (ROOT / "constraints.txt").read_text().splitlines():
        assert line.startswith("#") or re.fullmatch(r"[\w.-]+==[\w.]+( ; [\w.<>='*\s]+)?", line), (
            line
        )


def test_every_dependency_is_pinned():
    pinned = (ROOT / "constraints.txt").read_text()
    for bound in lower_bounds().splitlines():
        assert f"\n{bound.split('==')[0]}==" in pinned


def test_an_environment_that_is_up_to_date_is_left_alone(tmp_path: Path, monkeypatch):
    calls: list[object] = []
    monkeypatch.setattr("experiments.environment.ROOT", tmp_path)
    monkeypatch.setattr("experiments.environment._create", calls.append)
    monkeypatch.setattr("subprocess.run", lambda *args, **_: calls.append(args))
    monkeypatch.setattr("experiments.environment._pip", lambda python: [str(python)])
    (tmp_path / "pyproject.toml").write_text("a = 1")
    (tmp_path / "constraints.txt").write_text("numpy==2.4.6")
    python = tmp_path / ".venv/bin/python"
    python.parent.mkdir(parents=True)
    python.touch()
    environment(".venv", "[dev]")
    assert len(calls) == 1  # the installation; the folder was there
    environment(".venv", "[dev]")
    environment(".venv")
    assert len(calls) == 1
    (tmp_path / "constraints.txt").write_text("numpy==2.4.7")
    environment(".venv")
    assert len(calls) == 2
    assert "[dev]" in str(calls[-1])  # what was there stays


def test_an_environment_without_pip_is_served_by_this_pip(tmp_path: Path):
    import venv

    venv.create(tmp_path / "bare", with_pip=False)
    python = tmp_path / "bare/bin/python"
    assert _pip(python)[-2:] == ["--python", str(python)]


TIDY = """
import sys, time
try:
    print("started", flush=True)
    time.sleep(60)
except KeyboardInterrupt:
    time.sleep(1.0)  # longer than subprocess.run would wait
    print("tidied", flush=True)
    sys.exit(130)
"""

RUN_IN = f"""
import sys
from pathlib import Path
from experiments.environment import run_in
sys.exit(run_in(Path(sys.executable), "-c", {TIDY!r}))
"""


@pytest.mark.skipif(sys.platform == "win32", reason="needs POSIX signals")
@pytest.mark.parametrize(("interrupts", "words"), [(1, "tidied\n"), (2, "")])
def test_an_interrupted_command_may_tidy_up(interrupts: int, words: str):
    command = subprocess.Popen(
        [sys.executable, "-c", RUN_IN], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
        text=True, cwd=ROOT, start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )  # fmt: skip
    assert command.stdout is not None
    assert command.stdout.readline() == "started\n"
    for _ in range(interrupts):
        os.killpg(command.pid, signal.SIGINT)  # as a terminal does
        time.sleep(0.3)
    out, _ = command.communicate(timeout=30)
    assert (command.returncode, out) == (130, words)


def test_the_exit_code_is_handed_on():
    assert run_in(Path(sys.executable), "-c", "raise SystemExit(2)") == 2
