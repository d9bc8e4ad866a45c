"""What a job may call: the command line, and doors of Python that it has not."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

import pytest

from icage.errors import InputError
from tests.fuzz.geometry import agree_or_refuse
from tests.fuzz.laws import broken


def command(arguments: tuple[str, ...]) -> int:
    """The command line in this process."""
    from experiments.cli import main

    try:
        return main(arguments)
    except SystemExit as stop:  # --help and --version
        return int(stop.code or 0)


def checked_only(arguments: tuple[str, ...]) -> int:
    """The command line up to its first trial: how long a study is, is the user's wish."""
    from experiments.study.run import session

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(session, "run_session", _told)
        return command(arguments)


def _told(session: Any, *options: Any) -> list[str]:
    return [f"{session.study.design.total} trials"]


def parsed_only(arguments: tuple[str, ...]) -> int:
    """The options of a command that takes long, without the command."""
    from experiments.cli import parser

    try:
        parser().parse_args(arguments)
    except InputError as error:
        return refused(error)
    except SystemExit as stop:
        return int(stop.code or 0)
    return 0


def cage_read(arguments: tuple[str, ...]) -> int:
    """``icage.read_cage``."""
    import icage

    try:
        icage.read_cage(Path(arguments[0]))
    except InputError as error:
        return refused(error)
    return 0


def law_holds(arguments: tuple[str, ...]) -> int:
    """A law of ``tests.fuzz.laws``, 1 if it does not hold."""
    try:
        found = broken(Path(arguments[0]), arguments[1], int(arguments[2]))
    except InputError as error:
        return refused(error)
    if found:
        print(f"icage: law {arguments[1]}: {found}", file=sys.stderr)
    return int(bool(found))


def hang(arguments: tuple[str, ...]) -> int:
    """Never come back: to try the guard."""
    import threading

    threading.Event().wait()
    return 0


def die(arguments: tuple[str, ...]) -> int:
    """Take the process along, as a fault in compiled code does: to try the guard."""
    import os
    import signal

    os.kill(os.getpid(), signal.SIGKILL)
    return 0


def refused(error: InputError) -> int:
    """Say it as the command line does."""
    from experiments.io.one_line import one_line

    print(f"icage: error: {one_line(str(error))}", file=sys.stderr)
    return 2


CALLS: Final[dict[str, Callable[[tuple[str, ...]], int]]] = {
    "main": command,
    "checked only": checked_only,
    "parsed only": parsed_only,
    "read_cage": cage_read,
    "law": law_holds,
    "geometry": agree_or_refuse,
    "hang": hang,
    "die": die,
}
