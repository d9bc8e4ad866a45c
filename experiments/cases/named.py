"""What a user names on the command line: a case file, a drawing, or a shipped object."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from experiments.io.options import reason
from icage.case import Case
from icage.errors import InputError
from icage.formats.case_json import parse_unit, read_case, read_object
from icage.formats.svg.outline import read_svg, stated_unit
from models import case_paths, grasp_cases, object_names, outline_path


@dataclass(frozen=True, slots=True)
class Named:
    """What a name on the command line stands for.

    Attributes
    ----------
    shipped:
        The name of a shipped object; None for one of its grasps, or a file.
    cases:
        Case files: all grasps of a shipped object, or one.
    outline:
        The file with its outline: a case file with or without a grasp, or a drawing.
    """

    shipped: str | None
    cases: tuple[Path, ...]
    outline: Path


def is_shipped(text: str) -> bool:
    """Whether this names a shipped object (``pliers``) or one of its grasps (``pliers/1_best``)."""
    return text in object_names() or text in grasp_cases()


def named(text: str) -> Named:
    """Whether a name is a shipped object, one of its grasps or a file; a file comes first.

    Raises
    ------
    InputError:
        It is none of them.
    """
    if is_shipped(text) and not Path(text).is_file():
        if text in object_names():
            return Named(text, case_paths(text), outline_path(text))
        path = grasp_cases()[text]
    else:
        path = _given(text)
    return Named(None, (path,), path)


def find_case(text: str) -> Case:
    """The case of a case file, of a shipped object (its first grasp) or of its grasp."""
    return read_case(named(text).cases[0])


def find_object(text: str, width: float | None = None, unit: str | None = None) -> Case:
    """The object of a drawing, of a case file (with or without a grasp), or a shipped one.

    Parameters
    ----------
    text:
        A path ``*.svg`` or ``*.json``, or the name of a shipped object or grasp.
    width:
        [unit] Longer side of its bounding box, for drawings only; if None, the size they state.
    unit:
        Unit of a drawing's outline; if None, as in ``read_drawing``.
    """
    path = named(text).outline
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
        owner, slash, _ = text.partition("/")
        if slash and owner in object_names():
            grasps = ", ".join(one for one in grasp_cases() if one.startswith(f"{owner}/"))
            raise InputError(f"{text!r} does not exist; shipped grasps of {owner}: {grasps}")
        names = ", ".join(object_names())
        raise InputError(f"{text!r} does not exist; shipped objects: {names}")
    return path
