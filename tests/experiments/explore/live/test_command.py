"""``icage explore CASE`` as a user starts and ends it: no process stays, whatever ends it."""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Generator
from contextlib import contextmanager
from http.client import HTTPConnection
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, urlsplit

import pytest

from models import CASES
from tests.experiments.commands.runner import here

T = str(CASES / "T_best.json")

ASK_FOR = "import sys; from experiments.cli import main; sys.exit(main())"


@contextmanager
def started(*arguments: str) -> Generator[tuple[subprocess.Popen[str], str]]:
    """The command in a process group of its own, and the address that it prints."""
    command = [sys.executable, "-c", ASK_FOR, "explore", *arguments, "--no-open"]
    pipe = subprocess.PIPE
    process = subprocess.Popen(
        command, stdout=pipe, stderr=pipe, text=True, start_new_session=True,
        # a shell has what runs behind it ignore Ctrl-C
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )  # fmt: skip
    try:
        assert process.stdout is not None
        address = process.stdout.readline().strip()
        assert address.startswith("http://127.0.0.1:"), process.communicate()
        yield process, address
    finally:
        process.kill()
        process.communicate()


def ask(address: str, path: str, question: Any) -> dict[str, Any]:
    parts = urlsplit(address)
    headers = {
        "Origin": f"http://{parts.netloc}",
        "X-Icage-Token": parse_qs(parts.query)["token"][0],
        "Content-Type": "application/json",
    }
    connection = HTTPConnection(parts.netloc, timeout=60)
    connection.request("POST", path, json.dumps(question), headers)
    found = json.loads(connection.getresponse().read())
    connection.close()
    return found


def nobody_left(group: int) -> bool:
    """Soon; what the processes of a library tidy up takes a moment."""
    for _ in range(200):
        try:
            os.killpg(group, 0)
        except ProcessLookupError:
            return True
        time.sleep(0.05)
    return False


def ends(process: subprocess.Popen[str], code: int) -> str:
    _, err = process.communicate(timeout=60)
    assert process.returncode == code, err
    assert "Traceback" not in err
    assert nobody_left(process.pid)
    return err


@pytest.mark.skipif(os.name == "nt", reason="signals")
@pytest.mark.parametrize(
    ("number", "code", "word"),
    [(signal.SIGINT, 130, "interrupted"), (signal.SIGTERM, 143, "terminated")],
)
def test_a_signal_ends_all_of_it(number: int, code: int, word: str) -> None:
    case = json.loads(Path(T).read_text())
    contacts = case["grasp"]["contacts"]
    with started(T) as (process, address):
        found = ask(address, "/api/standing", {"radius": 0, "contacts": contacts})
        assert found["holds"]
        os.killpg(process.pid, number)  # a terminal sends it to all processes
        assert word in ends(process, code)


def test_it_ends_when_it_is_asked_to() -> None:
    with started(T) as (process, address):
        assert ask(address, "/api/quit", {}) == {}
        ends(process, 0)


def test_nobody_outlives_a_server_that_is_killed() -> None:
    with started(T) as (process, address):
        ask(address, "/api/levels", {"radius": 0, "contacts": [[0, 0], [1, 0], [0, 1]]})
        process.kill()
        process.communicate()
        assert nobody_left(process.pid)


def test_what_the_command_refuses(tmp_path: Path, capsys: Any) -> None:
    for option in (["--port", "1"], ["--open"], ["--no-open"], ["--save", "a"], ["--seconds", "1"]):
        line = here(capsys, "explore", T, "--out", str(tmp_path / "a.html"), *option).error_line()
        assert "is for the live page" in line
    there = tmp_path / "there.json"
    there.write_text("mine")
    assert "there already" in here(capsys, "explore", T, "--save", str(there)).error_line()
    for wrong in ("-1", "65536", "x", "8.5"):
        assert "--port" in here(capsys, "explore", T, "--port", wrong).error_line()
    assert "600" in here(capsys, "explore", T, "--seconds", "1e6").error_line()
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = str(taken.getsockname()[1])
        assert "in use" in here(capsys, "explore", T, "--port", port).error_line()
    assert [one.name for one in tmp_path.iterdir()] == ["there.json"]
