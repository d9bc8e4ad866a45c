"""Serve the live page until somebody has had enough of it."""

from __future__ import annotations

import secrets
import sys
import threading
import webbrowser
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from experiments.explore.live.answers import Answers, track_of
from experiments.explore.live.guards import HOST
from experiments.explore.live.keeping import Keeper
from experiments.explore.live.page import live_page
from experiments.explore.live.server import LiveServer
from experiments.explore.live.thing import Thing
from icage.case import Case
from icage.errors import InputError
from icage.hand import HandShape

ANY_HAND: Final = HandShape.from_angles_deg(60.0, 120.0)
"""Of an object without a grasp, before one is proposed: it says how many fingers there are."""


@dataclass(frozen=True, slots=True)
class Asked:
    """How the page is to be served.

    Attributes
    ----------
    port:
        0 for any that is free.
    browser:
        Whether to open the user's browser.
    save:
        Where a saved case goes besides the browser; None for nowhere.
    seconds:
        [s] How long grasps are searched unless the page says otherwise.
    friction:
        [1] Coefficients for the page's slider.
    tolerance:
        [unit] Of the drawing, for the search of grasps.
    """

    port: int = 0
    browser: bool = False
    save: Path | None = None
    seconds: float = 20.0
    friction: tuple[float, ...] = ()
    tolerance: float = 0.0


def server_of(case: Case, asked: Asked) -> LiveServer:
    """A server that listens and has not begun to answer; end its ``answers`` after it.

    Raises
    ------
    InputError:
        The port is taken, or ``--save`` names what is there.
    """
    keeper = Keeper(asked.save, case.sources)
    thing = Thing(case.name, case.unit, case.outline.vertices, asked.tolerance)
    token = secrets.token_urlsafe(24)
    data = {
        "format": "icage-live/1",
        "name": case.name,
        "unit": case.unit,
        "diameter": case.outline.diameter,
        "outline": {"vertices": case.outline.vertices},
        "radius": case.finger_radius,
        "contacts": case.target,
        "fingers": len(ANY_HAND.z),
        "track": track_of(case.outline, case.finger_radius),
        "seconds": asked.seconds,
        "save": None if asked.save is None else str(asked.save),
        "notes": case.notes,
        "token": token,
    }
    page, policy = live_page(data)
    answers = Answers(thing, keeper, asked.friction)
    try:
        return LiveServer(asked.port, token, page, policy, answers)
    except (OSError, OverflowError) as error:
        answers.end()
        why = getattr(error, "strerror", None) or str(error)
        raise InputError(
            f"--port {asked.port}: {HOST} does not let us listen there: {why}"
        ) from error


def serve(case: Case, asked: Asked) -> None:
    """Print the address, answer until the page says that it is over, or Ctrl-C does.

    Raises
    ------
    InputError:
        As ``server_of``.
    """
    server = server_of(case, asked)
    try:
        server.answers.warm(case.finger_radius)
        print("icage: the page is at this address until Ctrl-C:", file=sys.stderr, flush=True)
        print(server.address, flush=True)
        if asked.browser:
            threading.Thread(target=_open, args=(server.address,), daemon=True).start()
        server.serve_forever(poll_interval=0.1)
    finally:
        server.server_close()
        server.answers.end()


def _open(address: str) -> None:
    with suppress(webbrowser.Error):
        webbrowser.open(address)
