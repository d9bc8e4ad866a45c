"""Folders that icage wrote: a study's and a replay's."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from functools import cache
from pathlib import Path

from tests.fuzz.seeds.documents import t_json


@cache
def _made_by(*command: str) -> dict[str, bytes]:
    """What a command leaves in its folder ``out``."""
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        case = place / "t.json"
        case.write_bytes(t_json())
        program = "import sys; from experiments.cli import main; sys.exit(main())"
        subprocess.run(
            [sys.executable, "-c", program, command[0], str(case), *command[1:],
             "--out", str(place / "out")],
            check=True, cwd=Path(__file__).parents[3], capture_output=True,
        )  # fmt: skip
        return {
            str(path.relative_to(place)): path.read_bytes()
            for path in (place / "out").iterdir()
            if path.is_file()
        }


def _studied() -> dict[str, bytes]:
    varied = ("--vary", "place_xy=-2%:2%", "--vary", "friction=grid:0,0.1")
    return _made_by("study", *varied, "--trials", "2", "--no-figures")


def _replayed() -> dict[str, bytes]:
    return _made_by("replay", "--trials", "1", "--no-video")


def study_documents() -> tuple[bytes, ...]:
    return (_studied()["out/study.json"],)


def replay_documents() -> tuple[bytes, ...]:
    return (_replayed()["out/replay.json"],)


def beside_replay_documents() -> dict[str, bytes]:
    return {"out/trials.parquet": _replayed()["out/trials.parquet"]}


def replay_tables() -> tuple[bytes, ...]:
    return (_replayed()["out/trials.parquet"],)


def beside_replay_tables() -> dict[str, bytes]:
    return {"out/replay.json": _replayed()["out/replay.json"]}
