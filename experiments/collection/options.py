"""What is asked of every object of a folder, and the record of it that goes with the table."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from math import inf
from typing import Any, Final

from experiments.io.versions import versions
from icage.errors import InputError
from icage.formats.drawings.reading import Reading
from icage.grasps.wanted import HandLimits, Wanted

FORMAT: Final = "icage-grasp-table/1"

_NO_MATTER: Final = ("mujoco", "closings")
"""Versions that are recorded elsewhere: a grasp hangs on no engine."""


@dataclass(frozen=True, slots=True)
class SearchOptions:
    """One search, for objects of many sizes: lengths are in each object's own unit.

    Attributes
    ----------
    wanted:
        Which grasps are looked for.
    top:
        Rows of an object, at most.
    seed:
        The seed of each object's own seed.
    finger_radius:
        [unit] Of the disc fingers; None: what each file says, else 0.
    reading:
        Of drawings, as ``icage.load`` has them; case files have their own.
    seconds:
        [s] For each search; None: it ends by itself, and the table can be made again.
    """

    wanted: Wanted
    top: int = 1
    seed: int = 0
    finger_radius: float | None = None
    reading: Reading = field(default_factory=Reading)
    seconds: float | None = None

    def document(self) -> dict[str, Any]:
        """Everything that decides the rows, as JSON reads it."""
        options = asdict(self)
        wanted = options.pop("wanted")
        options.pop("reading")
        given = self.reading.given()
        options |= {"width": given.get("width"), "unit": given.get("unit"), "reading": given}
        options |= {**wanted.pop("limits"), **wanted}
        if options["sigma_most"] == inf:
            options["sigma_most"] = None
        mine = {name: one for name, one in versions().items() if name not in _NO_MATTER}
        document = {"format": FORMAT, "options": options, "versions": mine}
        return dict(json.loads(json.dumps(document, allow_nan=False)))


def options_of(document: Mapping[str, Any]) -> SearchOptions:
    """The options of a document.

    Raises
    ------
    InputError:
        It is no document of a table of grasps.
    """
    if document.get("format") != FORMAT:
        raise InputError(f"format {document.get('format')!r}; {FORMAT!r} is needed")
    plain = dict(document["options"])
    names = ("least_angle", "least_gap", "sigma_least", "sigma_most")
    limits = {name: plain.pop(name) for name in names}
    if limits["sigma_most"] is None:
        limits["sigma_most"] = inf
    near = plain.pop("near")
    wanted = Wanted(
        plain.pop("aim"), plain.pop("corners"), None if near is None else tuple(near),
        HandLimits(**limits), tuple(tuple(one) for one in plain.pop("avoid")),
        plain.pop("tolerance"), plain.pop("mu"),
    )  # fmt: skip
    reading = dict(plain.pop("reading"))
    if "layers" in reading:
        reading["layers"] = tuple(reading["layers"])
    for name in ("width", "unit"):
        plain.pop(name)  # they stand in the reading, too
    return SearchOptions(wanted, reading=Reading(**reading), **plain)
