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
from tests.newer_python import newer_pythons


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


def test_an_environment_of_another_python_takes_wheels_only(tmp_path: Path, monkeypatch):
    calls: list[list[str]] = []
    monkeypatch.setattr("experiments.environment.ROOT", tmp_path)
    monkeypatch.setattr("subprocess.run", lambda command, **_: calls.append(command))
    monkeypatch.setattr("experiments.environment._pip", lambda python: [str(python), "-m", "pip"])
    (tmp_path / "pyproject.toml").write_text("a = 1")
    (tmp_path / "constraints.txt").write_text("numpy==2.4.6")
    other = Path("python3.19")
    made = tmp_path / ".venv-newest/bin"
    made.mkdir(parents=True)
    environment(".venv-newest", "[test]", by=other)
    assert calls[0][:3] == [str(other), "-m", "venv"]
    assert "--only-binary=:all:" in calls[1]
    (made / "python").touch()
    environment(".venv-newest", "[test]", by=other)
    assert len(calls) == 2
    environment(".venv-newest", "[test]", by=Path("python3.20"))
    assert len(calls) == 4


@pytest.mark.skipif(os.name == "nt", reason="programs are shell scripts here")
def test_newer_pythons_are_those_that_run_and_are_released(tmp_path: Path, monkeypatch):
    """On PATH: one that is released, one that is not, one that only complains, and pyenv's."""
    minor = sys.version_info.minor
    for name, answer in {
        f"python3.{minor + 1}": f"echo 3 {minor + 1} final",
        f"python3.{minor + 2}": "echo no such version >&2; exit 127",
        f"python3.{minor + 3}": f"echo 3 {minor + 3} candidate",
        "pyenv": f'[ "$1" = prefix ] && echo {tmp_path}/own || echo 3.{minor + 2}.4',
        "own/bin/python": f"echo 3 {minor + 2} final",
    }.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(f"#!/bin/sh\n{answer}\n")
        path.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}/bin")
    found = [path.relative_to(tmp_path).as_posix() for path in newer_pythons()]
    assert found == ["own/bin/python", f"python3.{minor + 1}"]


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
