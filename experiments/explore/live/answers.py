"""What the live page may ask, each question checked and handed to who answers it."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any, Final

import numpy as np
import shapely

from experiments.explore.live.keeping import Keeper
from experiments.explore.live.lane import Lane
from experiments.explore.live.thing import Thing, asked_contacts, asked_radius
from icage.arrays import FloatArray
from icage.checks import a_count
from icage.contacts import LARGEST_RADIUS, check_radius
from icage.errors import InputError
from icage.formats.json_out import json_text
from icage.formats.json_text import a_number, required
from icage.geometry.near_frame import NearFrame
from icage.outline import Outline

SOON: Final = 60.0
"""[s] For what is milliseconds, and a second for the largest outlines."""

LATER: Final = 300.0
"""[s] For a plan of the largest outlines."""

MOST_SECONDS: Final = 600.0
"""[s] A search longer than this is one for `icage grasps`."""

MOST_PROPOSALS: Final = 24

_OFF: Final = 1e-4
"""[diameter] The way of a finger may lie off the true curve by this; contacts are put onto it."""

Answer = Callable[[dict[str, Any]], str]


class Answers:
    """The questions by their paths, and the processes behind them.

    Parameters
    ----------
    thing:
        The object.
    keeper:
        Where cases are saved.
    friction:
        [1] Coefficients for the slider of the page.
    """

    def __init__(self, thing: Thing, keeper: Keeper, friction: tuple[float, ...] = ()) -> None:
        self.thing, self._keeper, self._friction = thing, keeper, friction
        room = "experiments.explore.live"
        self._standing = Lane(f"{room}.standing", thing)
        self._planning = Lane(f"{room}.planning", thing)
        self._proposing = Lane(f"{room}.proposing", thing)
        self._closing = Lane(f"{room}.closing", thing)
        self.paths: dict[str, Answer] = {
            "/api/standing": self._stand,
            "/api/levels": lambda body: self._plan("levels", body),
            "/api/document": lambda body: self._plan("document", body),
            "/api/fingers": self._fingers,
            "/api/propose": self._propose,
            "/api/stop": self._stop,
            "/api/close": self._close,
            "/api/save": self._save,
        }

    def warm(self, radius: float) -> None:
        """Start what will be asked first, for fingers of this radius."""
        self._standing.warm({"radius": radius})
        self._planning.warm({})

    def end(self) -> None:
        """End all processes."""
        for lane in (self._standing, self._planning, self._proposing, self._closing):
            lane.close()

    def _stand(self, body: dict[str, Any]) -> str:
        return self._standing.ask("standing", _asked(body), SOON)

    def _plan(self, kind: str, body: dict[str, Any]) -> str:
        return self._planning.ask(kind, {**_asked(body), "friction": self._friction}, LATER)

    def _fingers(self, body: dict[str, Any]) -> str:
        """Fingers of another radius: the way of their centres, and the same grasp if there is."""
        radius = check_radius(asked_radius(body, "to"))
        most = LARGEST_RADIUS * self.thing.outline.diameter
        if radius > most:
            raise InputError(
                f"the finger radius is {radius:g} {self.thing.unit}; up to {most:g} is allowed"
            )
        track = track_of(self.thing.outline, radius)
        contacts, why = None, None
        if body.get("contacts") is not None:
            try:
                asked = {**_asked(body), "to": radius}
                contacts = json.loads(self._planning.ask("regrasp", asked, LATER))["contacts"]
            except InputError as error:
                why = str(error)
        document = {"radius": radius, "track": track, "contacts": contacts, "why": why}
        return json_text(document)

    def _propose(self, body: dict[str, Any]) -> str:
        seconds = a_number(required(body, "seconds", "the question"), "seconds")
        if not 0.0 < seconds <= MOST_SECONDS:
            raise InputError(f"seconds is {seconds:g}; up to {MOST_SECONDS:g} are searched here")
        top = a_count(body.get("top", 6), "top")
        if top > MOST_PROPOSALS:
            raise InputError(f"top is {top}; up to {MOST_PROPOSALS} are listed here")
        question = {"radius": asked_radius(body), "seconds": seconds, "top": top}
        return self._proposing.ask("propose", question, seconds + LATER)

    def _stop(self, _body: dict[str, Any]) -> str:
        self._proposing.stop()
        return "{}"

    def _close(self, body: dict[str, Any]) -> str:
        at = required(body, "placement", "the question")
        if not isinstance(at, list) or len(at) != 4:
            raise InputError("placement is not [x, y, theta, sigma]")
        row = [a_number(value, f"placement[{k}]") for k, value in enumerate(at)]
        friction = a_number(body.get("friction", 0.0), "friction")
        if not 0.0 <= friction <= 10.0:
            raise InputError(f"friction is {friction:g}; 0 to 10 is needed")
        question: dict[str, Any] = {**_asked(body), "placement": row, "friction": friction}
        if not question["radius"] > 0.0:
            raise InputError(
                "these fingers are points, and simulated fingers need a radius: give them one"
            )
        return self._closing.ask("close", question, LATER)

    def _save(self, body: dict[str, Any]) -> str:
        question = _asked(body)
        case = self.thing.case_asked(question)
        return self._keeper.keep(replace(case, target=np.array(question["contacts"])))


def _asked(body: dict[str, Any]) -> dict[str, Any]:
    return {"radius": asked_radius(body), "contacts": asked_contacts(body)}


def track_of(outline: Outline, radius: float) -> FloatArray:
    """(n, 2) ring on which finger centres can be, counterclockwise: the outline, or what is a
    radius away from it outside, but for pockets that it closes off.
    """
    if radius == 0.0:
        return outline.vertices
    frame = NearFrame.of(outline)
    polygon = frame.outline_into(outline).polygon
    # a quarter of an arc in so many chords lies within _OFF of it
    half = math.acos(max(0.0, 1.0 - _OFF * outline.diameter / radius))
    chords = min(256, max(4, math.ceil(0.25 * math.pi / half)))
    grown = polygon.buffer(radius, quad_segs=chords)
    ring = shapely.get_coordinates(shapely.get_exterior_ring(grown))[:-1]
    if not shapely.LinearRing(ring).is_ccw:
        ring = ring[::-1]
    return frame.back(ring)
