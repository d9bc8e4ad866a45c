"""What a user names on the command line: a case file, a drawing, or a shipped object."""

from __future__ import annotations

from pathlib import Path

from experiments.io.options import reason
from icage.case import Case
from icage.errors import InputError
from icage.formats.case_json import parse_unit, read_case, read_object
from icage.formats.svg.outline import read_svg, stated_unit
from models import case_path, object_names, outline_path


def case_file(text: str) -> Path:
    """The file of a case given as a path or as a shipped object's name; it need not exist."""
    if text in object_names() and not Path(text).is_file():
        return case_path(text)
    return _given(text)


def find_case(text: str) -> Case:
    """The case given as a path or as a shipped object's name."""
    return read_case(case_file(text))


def find_object(text: str, width: float | None = None, unit: str | None = None) -> Case:
    """The object of a drawing, of a case file (with or without a grasp), or a shipped one.

    Parameters
    ----------
    text:
        A path ``*.svg`` or ``*.json``, or a shipped object's name.
    width:
        [unit] Longer side of its bounding box, for drawings only; if None, the size they state.
    unit:
        Unit of a drawing's outline; if None, as in ``read_drawing``.
    """
    if text in object_names() and not Path(text).is_file():
        path = outline_path(text)
    else:
        path = _given(text)
    if path.suffix.lower() == ".svg":
        return read_drawing(path, width, unit)
    if width is not None or unit is not None:
        raise InputError(f"--width and --unit are for drawings (*.svg); {path} has its own")
    return read_object(path)


def read_drawing(
    path: Path, width: float | None = None, unit: str | None = None, tolerance: float | None = None
) -> Case:
    """The object of a drawing, lengths in ``unit``.

    Without a unit the answer is in the one in which the drawing states its size (mm in, mm out),
    and so is ``width``; in m where the drawing states none. ``size_from`` says which it was.
    """
    own = stated_unit(path)
    measure = parse_unit(unit or own or "m")
    outline = read_svg(path, width, tolerance, measure)
    if width is None:
        origin = f"from the file's own size, in {own}"
    else:
        origin = f"from --width {width:g} {measure}"
        if unit is None:
            why = "as in the file" if own else "the file states none"
            origin += f" (no --unit given: {measure} is assumed, {why})"
    return Case(path.stem, measure, outline, 0.0, None, (path,), origin)


def size_words(thing: Case) -> str:
    """``40 x 23.1 mm, from the file's own size, in mm``."""
    x, y = thing.outline.vertices.max(axis=0) - thing.outline.vertices.min(axis=0)
    return ", ".join(part for part in (f"{x:.6g} x {y:.6g} {thing.unit}", thing.size_from) if part)


def _given(text: str) -> Path:
    path = Path(text)
    try:
        missing = not path.exists()
    except (OSError, ValueError) as error:
        raise InputError(f"{text!r} cannot be a file: {reason(error)}") from error
    if missing:
        names = ", ".join(object_names())
        raise InputError(f"{text!r} does not exist; shipped objects: {names}")
    return path
