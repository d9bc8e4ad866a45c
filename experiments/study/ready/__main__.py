"""Run every ready study for the three tools.

    python -m experiments.study.ready                    into docs/studies, what is there goes on
    python -m experiments.study.ready --only friction    those whose name begins so
    python -m experiments.study.ready --out DIR --list

Friction is also run for a grasp on three straight edges, and with half the time step and twice the
time: rates must not hang on the engine's settings. [docs/studies.md]
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from experiments.study.run.session import held, run_session, session_of
from models import CASES, object_names

HERE = Path(__file__).parent
OUT = HERE.parents[2] / "docs" / "studies"

THREE_EDGES = os.path.relpath(CASES / "disc_hammer.json")
"""From here: what is written names no place of this machine."""


@dataclass(frozen=True, slots=True)
class Ready:
    """A study of one case; ``over`` replaces fields of its file."""

    name: str
    file: str
    case: str
    over: dict[str, Any] = field(default_factory=dict)


def ready() -> Iterator[Ready]:
    """All of them, the cheap ones first."""
    for study in ("placement", "radius", "shape", "speed", "tilt", "friction"):
        for tool in object_names():
            yield Ready(f"{study}-{tool}", study, tool)
    yield Ready("friction-three-edges", "friction", THREE_EDGES)
    slower = {"time_step": 5e-4, "max_time": 10.0}
    for tool in ("pliers", "wrench"):
        yield Ready(f"friction-{tool}-half-step", "friction", tool, slower)
    yield Ready("matters-pliers", "matters", "pliers")


def main() -> None:
    """Run what is asked for, one after another."""
    parser = argparse.ArgumentParser(description=__doc__, allow_abbrev=False)
    parser.add_argument("--only", default="", help="beginning of a study's name")
    parser.add_argument("--out", type=Path, default=OUT)
    parser.add_argument("--threads", type=int, default=None)
    parser.add_argument("--list", action="store_true", help="name them and stop")
    options = parser.parse_args()
    for one in ready():
        if not one.name.startswith(options.only):
            continue
        if options.list:
            print(one.name)
            continue
        given = {"case": str(HERE / f"{one.file}.toml"), "instead": one.case, **one.over}
        folder = options.out / one.name
        there = (folder / "study.json").exists()
        with held(str(folder)):
            session = session_of(given, str(folder), there)
            lines = run_session(session, options.threads, None, True)
        print("\n".join(lines), flush=True)


if __name__ == "__main__":
    main()
