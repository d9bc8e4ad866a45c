"""The case file: an outline, a finger radius, a target grasp. Format ``icage-case/1``."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

from icage.case import MAX_NAME, Case
from icage.errors import CaseError, FormatError, InputError
from icage.formats.files import read_bytes
from icage.formats.json_text import a_number, an_object, describe, parse_json, points, required
from icage.formats.svg.outline import read_svg
from icage.outline import MAX_VERTICES, Outline
from icage.units import UNITS, Unit

FORMAT: Final = "icage-case/1"

MAX_BYTES: Final = 10_000_000
"""Largest case file read."""


def read_case(path: Path) -> Case:
    """The case in a JSON file.

    Raises
    ------
    InputError:
        Whatever is wrong with the file, in one line that begins with its path.
    """
    with _told_with(str(path)):
        return parse_case(read_json(path), path.parent, (path,))


def parse_case(data: object, folder: Path, sources: tuple[Path, ...] = ()) -> Case:
    """The case in parsed JSON; an outline given as a file is looked for in ``folder``.

    ``sources`` are the files that the JSON was read from.
    """
    case = an_object(data, "the case")
    found = parse_object(case, folder, sources)
    grasp = an_object(required(case, "grasp", "the case"), "grasp")
    contacts = points(required(grasp, "contacts", "grasp"), "grasp.contacts", least=3, most=3)
    with _told_with("grasp.contacts"):
        return found.with_grasp(contacts)


def read_object(path: Path) -> Case:
    """The object in a case file, as a case without a grasp: one that it has is not looked at."""
    with _told_with(str(path)):
        return parse_object(an_object(read_json(path), "the case"), path.parent, (path,))


def read_json(path: Path) -> object:
    """The JSON of a case file, not looked at yet."""
    content = read_bytes(path, MAX_BYTES, "a case file")
    if content.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"<"):
        raise CaseError(
            "this is a drawing (or other XML); a case file is needed, whose outline "
            "`icage outline DRAWING --json FILE` makes and for which `icage grasps` finds grasps"
        )
    return parse_json(content, "the file")


def parse_object(case: dict[str, Any], folder: Path, sources: tuple[Path, ...] = ()) -> Case:
    """Everything of a case but the grasp."""
    if required(case, "format", "the case") != FORMAT:
        raise CaseError(f"format is {describe(case['format'])}; {FORMAT!r} is needed")
    name = required(case, "name", "the case")
    if not isinstance(name, str) or not 0 < len(name) <= MAX_NAME or not name.isprintable():
        raise CaseError(
            f"name is {describe(name)}; a printable string of 1 to {MAX_NAME} characters is needed"
        )
    unit = parse_unit(case.get("unit", "m"))
    outline, drawings = _parse_outline(
        an_object(required(case, "outline", "the case"), "outline"), folder, unit
    )
    finger_radius = a_number(case.get("finger_radius", 0.0), "finger_radius")
    if finger_radius < 0.0:
        raise CaseError(f"finger_radius is {finger_radius:g}; 0 or more is needed")
    return Case(name, unit, outline, finger_radius, None, sources + drawings)


def parse_unit(value: object) -> Unit:
    """One of the units a case may have."""
    if value not in UNITS:
        raise CaseError(f"unit is {describe(value)}; one of {', '.join(UNITS)} is needed")
    return value


def _parse_outline(
    data: dict[str, Any], folder: Path, unit: Unit
) -> tuple[Outline, tuple[Path, ...]]:
    """The outline, and the drawing it was read from if there is one."""
    if ("vertices" in data) == ("file" in data):
        have = "both" if "vertices" in data else "neither"
        raise CaseError(f"outline has {have} of the keys 'vertices' and 'file'; one is needed")
    if "vertices" in data:
        vertices = points(data["vertices"], "outline.vertices", most=MAX_VERTICES)
        with _told_with("outline.vertices"):
            return Outline(vertices), ()
    file = data["file"]
    if not isinstance(file, str) or not file or not file.isprintable():
        raise CaseError(f"outline.file is {describe(file)}; the path of an SVG file is needed")
    if not file.lower().endswith(".svg"):
        raise CaseError(f"outline.file is {describe(file)}; a drawing *.svg is needed")
    width, tolerance = (
        a_number(data[key], f"outline.{key}") if key in data else None
        for key in ("width", "tolerance")
    )
    with _told_with("outline"):
        return read_svg(folder / file, width, tolerance, unit), (folder / file,)


@contextmanager
def _told_with(place: str) -> Generator[None]:
    """Errors of the block say where they arose, unless they do."""
    try:
        yield
    except InputError as error:
        message = str(error) if place in str(error) else f"{place}: {error}"
        kind = CaseError if isinstance(error, FormatError) else type(error)
        raise kind(message) from error
