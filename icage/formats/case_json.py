"""The case file: an outline, a finger radius, a target grasp. Format ``icage-case/1``.

A plan (``icage-plan/1``) and a list of grasps (``icage-grasps/1``) hold the same and are read, too.
"""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, Final, cast

from icage.case import MAX_NAME, Case
from icage.errors import CaseError, FormatError, InputError
from icage.formats.drawings.read import FORMATS as FORMATS_OF_DRAWINGS
from icage.formats.drawings.read import is_drawing, trace_file
from icage.formats.drawings.reading import Reading, ReadingOptions
from icage.formats.files import read_bytes
from icage.formats.json_text import a_number, an_object, describe, parse_json, points, required
from icage.outline import MAX_VERTICES, Outline
from icage.units import UNITS, Unit

FORMAT: Final = "icage-case/1"

PLAN: Final = "icage-plan/1"
"""A plan: its ``contacts`` are the grasp."""

GRASPS: Final = "icage-grasps/1"
"""A list: ``grasps[K - 1].contacts`` are grasp K."""

FORMATS: Final = (FORMAT, PLAN, GRASPS)

_GEOJSON: Final = (
    "Feature", "FeatureCollection", "GeometryCollection", "Polygon", "MultiPolygon",
    "LineString", "MultiLineString", "Point", "MultiPoint",
)  # fmt: skip
"""What "type" is in a GeoJSON text."""

MAX_BYTES: Final = 10_000_000
"""Largest case file read."""


def read_case(path: Path, grasp: int = 1) -> Case:
    """The case in a JSON file; ``grasp`` (from 1) is which one of a list of grasps.

    Raises
    ------
    InputError:
        Whatever is wrong with the file, in one line that begins with its path.
    """
    with _told_with(str(path)):
        return parse_case(read_json(path), path.parent, (path,), grasp)


def parse_case(data: object, folder: Path, sources: tuple[Path, ...] = (), grasp: int = 1) -> Case:
    """The case in parsed JSON; an outline given as a file is looked for in ``folder``.

    ``sources`` are the files that the JSON was read from.
    """
    case = an_object(data, "the case")
    found = parse_object(case, folder, sources)
    place, value = _contacts(case, grasp)
    contacts = points(value, place, least=3, most=3)
    with _told_with(place):
        return replace(found.with_grasp(contacts), name=_name_of(case, found.name, grasp))


def read_any(path: Path, grasp: int = 1) -> Case:
    """The case in a JSON file, or its object alone where it means to have no grasp.

    A grasp that is misspelt is an error. The file is read once: it may be a pipe.

    Raises
    ------
    InputError:
        As ``read_case``.
    """
    with _told_with(str(path)):
        case = an_object(read_json(path), "the case")
        if case.get("format") != FORMAT or any(key.lower() == "grasp" for key in case):
            return parse_case(case, path.parent, (path,), grasp)
        return parse_object(case, path.parent, (path,))


def read_object(path: Path) -> Case:
    """The object in a case file, as a case without a grasp: one that it has is not looked at."""
    with _told_with(str(path)):
        return parse_object(an_object(read_json(path), "the case"), path.parent, (path,))


def case_document(case: Case, made_by: str | None = None) -> dict[str, Any]:
    """A case as ``icage-case/1``; ``made_by`` is the command that found it."""
    return {
        **object_document(case, FORMAT),
        **({"grasp": {"contacts": case.target}} if case.target is not None else {}),
        **({"made_by": made_by} if made_by is not None else {}),
    }


def object_document(case: Case, form: str) -> dict[str, Any]:
    """The object and its fingers: how every document begins that is read as a case."""
    return {
        "format": form,
        "name": case.name,
        "unit": case.unit,
        "outline": {"vertices": case.outline.vertices},
        "finger_radius": case.finger_radius,
    }


def grasp_name(name: str, number: int) -> str:
    """What grasp ``number`` (from 1) of an object is called.

    >>> grasp_name("wrench", 2)
    'wrench/2'
    """
    end = f"/{number}"
    return name[: MAX_NAME - len(end)] + end


def _contacts(case: dict[str, Any], number: int) -> tuple[str, Any]:
    """Where the contacts of the grasp stand, and what stands there."""
    kind = case["format"]
    if kind == GRASPS:
        grasps = required(case, "grasps", "the list of grasps")
        if not isinstance(grasps, list):
            raise CaseError(f"grasps is {describe(grasps)}; a list is needed")
        rows = cast("list[object]", grasps)
        if not 1 <= number <= len(rows):
            has = f"has grasps 1 to {len(rows)}" if rows else "has no grasps"
            raise CaseError(f"grasp is {number}; the file {has}")
        place = f"grasps[{number - 1}]"
        row = an_object(rows[number - 1], place)
        return f"{place}.contacts", required(row, "contacts", place)
    if number != 1:
        raise CaseError(
            f"grasp is {number}; a {'plan' if kind == PLAN else 'case'} file has one grasp"
        )
    if kind == PLAN:
        return "contacts", required(case, "contacts", "the plan")
    grasp = an_object(required(case, "grasp", "the case"), "grasp")
    return "grasp.contacts", required(grasp, "contacts", "grasp")


def _name_of(case: dict[str, Any], name: str, number: int) -> str:
    return grasp_name(name, number) if case["format"] == GRASPS else name


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
    if "format" not in case and case.get("type") in _GEOJSON:
        raise CaseError(
            f"this is GeoJSON (its type is {describe(case['type'])}): name it *.geojson to have "
            "its outline"
        )
    if required(case, "format", "the case") not in FORMATS:
        others = " (or a plan or a list of grasps)"
        raise CaseError(f"format is {describe(case['format'])}; {FORMAT!r} is needed{others}")
    name = required(case, "name", "the case")
    if not isinstance(name, str) or not 0 < len(name) <= MAX_NAME or not name.isprintable():
        raise CaseError(
            f"name is {describe(name)}; a printable string of 1 to {MAX_NAME} characters is needed"
        )
    unit = parse_unit(case.get("unit", "m"))
    place = an_object(required(case, "outline", "the case"), "outline")
    drawing, reading = _drawing_of(place, folder, unit)
    finger_radius = a_number(case.get("finger_radius", 0.0), "finger_radius")
    if finger_radius < 0.0:
        raise CaseError(f"finger_radius is {finger_radius:g}; 0 or more is needed")
    if drawing is None or reading is None:
        vertices = points(place["vertices"], "outline.vertices", most=MAX_VERTICES)
        with _told_with("outline.vertices"):
            return Case(name, unit, Outline(vertices), finger_radius, None, sources)
    with _told_with("outline"):
        found = trace_file(drawing, reading)
    return Case(
        name, unit, found.outline, finger_radius, None, (*sources, drawing), found.size_from,
        found.notes, reading,
    )  # fmt: skip


def parse_unit(value: object) -> Unit:
    """One of the units a case may have."""
    if value not in UNITS:
        raise CaseError(f"unit is {describe(value)}; one of {', '.join(UNITS)} is needed")
    return value


_NUMBERS: Final = ("width", "tolerance", "gap", "section", "threshold")
"""Keys of ``outline`` that are numbers."""


def _drawing_of(
    data: dict[str, Any], folder: Path, unit: Unit
) -> tuple[Path | None, Reading | None]:
    """The drawing that the outline is read from, and how; None where it has vertices."""
    if ("vertices" in data) == ("file" in data):
        have = "both" if "vertices" in data else "neither"
        raise CaseError(f"outline has {have} of the keys 'vertices' and 'file'; one is needed")
    if "vertices" in data:
        return None, None
    file = data["file"]
    if not isinstance(file, str) or not file or not file.isprintable():
        raise CaseError(f"outline.file is {describe(file)}; the path of a drawing is needed")
    if not is_drawing(Path(file)):
        kinds = ", *".join(FORMATS_OF_DRAWINGS)
        raise CaseError(f"outline.file is {describe(file)}; a drawing (*{kinds}) is needed")
    if "unit" in data:
        raise CaseError(
            f"outline.unit is {describe(data['unit'])}; the unit of a case is its own key, and "
            "its outline has the same"
        )
    options: dict[str, Any] = {
        key: a_number(data[key], f"outline.{key}") if key in _NUMBERS else data[key]
        for key in ReadingOptions.__annotations__
        if key in data
    }
    if isinstance(options.get("layers"), list):
        options["layers"] = tuple(options["layers"])
    with _told_with("outline"):
        return folder / file, Reading(unit=unit, **options)


@contextmanager
def _told_with(place: str) -> Generator[None]:
    """Errors of the block say where they arose, unless they do."""
    try:
        yield
    except InputError as error:
        message = str(error) if place in str(error) else f"{place}: {error}"
        kind = CaseError if isinstance(error, FormatError) else type(error)
        raise kind(message) from error
