"""load(): one way in for whatever holds an object: a drawing, a case, a plan, a shipped name."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Final, Unpack

from numpy.typing import ArrayLike

from icage.cage import Cage
from icage.case import Case
from icage.checks import a_count
from icage.errors import CaseError, InputError
from icage.formats.case_json import parse_unit, read_any, read_case, read_object
from icage.formats.drawings.read import is_drawing, trace_file
from icage.formats.drawings.reading import Reading, ReadingOptions, option_of
from icage.outline import Outline
from models import case_paths, grasp_cases, object_names, outline_path

if TYPE_CHECKING:
    from icage.formats.drawings.trace import Traced

UNNAMED: Final = "object"
"""Name of a case made from bare vertices."""


def load(
    source: str | os.PathLike[str] | Outline | ArrayLike,
    *,
    finger_radius: float | None = None,
    grasp: int | None = None,
    **reading: Unpack[ReadingOptions],
) -> Case:
    """The case that a file, a shipped name or an outline stands for, with its grasp if it has one.

    Parameters
    ----------
    source:
        The path of a drawing, of a case file with or without a grasp, of a plan or of
        a list of grasps as ``icage plan`` and ``icage grasps`` write them with ``--json``; the name
        of a shipped object (``pliers``: its first grasp) or grasp (``pliers/1_best``), where no
        such file exists; or an ``Outline`` or its vertices (n, 2).
    finger_radius:
        [unit] Radius of the disc fingers; if None, what the file says, else 0: point fingers. A
        grasp belongs to its radius: with another one the case needs a grasp of its own.
    grasp:
        Which grasp, from 1, of a list of grasps or of a shipped object; the first if None.
    reading:
        ``width``, ``unit``, ``tolerance`` and what else says how a drawing is to be read: the
        fields of ``icage.formats.drawings.reading.Reading``. Bare vertices have a ``unit``.

    Raises
    ------
    InputError:
        There is no such file or name, it cannot be read, or an option does not go with it.

    Examples
    --------
    >>> load("pliers")
    <Case pliers/1_best: 51 vertices, 180 x 147.887 mm, finger radius 6 mm, sigma_0 50.4419 mm>
    >>> load([[0, 0], [4, 0], [0, 3]], unit="mm", finger_radius=0.1)
    <Case object: 3 vertices, 4 x 3 mm, finger radius 0.1 mm, no grasp yet>
    """
    how = reading_of(reading)
    if grasp is not None:
        a_count(grasp, "grasp", 0)
    if isinstance(source, Case | Cage):
        raise InputError(f"load() was given a {type(source).__name__}, which needs no loading")
    if not isinstance(source, str | os.PathLike):
        _for_drawings("bare vertices have their own size", how, allowed=("unit",))
        _refuse("bare vertices have no grasps", grasp=grasp)
        outline = source if isinstance(source, Outline) else Outline(source)
        return Case(UNNAMED, parse_unit(how.unit or "m"), outline, finger_radius or 0.0)
    found = named(os.fspath(source))
    path = found.outline
    if is_drawing(path):
        _refuse(f"{path} is a drawing and has no grasps", grasp=grasp)
        case = read_drawing(path, how)
    else:
        _for_drawings(f"{path} has its own", how)
        case = _read(found, grasp)
    return case if finger_radius is None else _with_radius(case, finger_radius)


def load_object(source: str | os.PathLike[str], **reading: Unpack[ReadingOptions]) -> Case:
    """The object alone, as a case without a grasp, of all that ``load`` reads from files.

    Of a shipped object it is the outline, with no finger radius.

    Raises
    ------
    InputError:
        As ``load``.
    """
    how = reading_of(reading)
    path = named(os.fspath(source)).outline
    if is_drawing(path):
        return read_drawing(path, how)
    _for_drawings(f"{path} has its own", how)
    return read_object(path)


def reading_of(options: ReadingOptions) -> Reading:
    """The options as one value.

    Raises
    ------
    InputError:
        There is no such option, or its value is not allowed.
    """
    for name in options:
        if name not in ReadingOptions.__annotations__:
            known = ", ".join(ReadingOptions.__annotations__)
            raise InputError(f"there is no option {name!r}; how a drawing is read: {known}")
    return Reading(**options)


@dataclass(frozen=True, slots=True)
class Named:
    """What a name stands for.

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


def read_drawing(path: Path, reading: Reading) -> Case:
    """The object of a drawing, lengths in ``unit``.

    Without a unit the answer is in the one in which the drawing states its size (mm in, mm out),
    and so is ``width``; in m where the drawing states none. ``size_from`` says which it was.
    """
    return case_of(path, reading, trace_file(path, reading))


def case_of(path: Path, reading: Reading, found: Traced) -> Case:
    """The object of a drawing that was traced, named after its file."""
    return Case(
        path.stem, found.unit, found.outline, 0.0, None, (path,), found.size_from, found.notes,
        reading,
    )  # fmt: skip


def _read(found: Named, grasp: int | None) -> Case:
    """The case in a JSON file; of a shipped object the grasp that is asked for."""
    if found.shipped is not None:
        return read_case(found.cases[_index(grasp, len(found.cases), found.shipped)])
    path = found.cases[0]
    case = read_any(path, 1 if grasp is None else grasp)
    if case.target is None:
        _refuse(f"{path} has no grasp", grasp=grasp)
    return case


def _index(grasp: int | None, count: int, name: str) -> int:
    if grasp is None:
        return 0
    if not 1 <= grasp <= count:
        raise InputError(f"grasp is {grasp}; {name} has grasps 1 to {count}")
    return grasp - 1


def _with_radius(case: Case, radius: float) -> Case:
    if case.target is not None and radius != case.finger_radius:
        raise CaseError(
            f"finger_radius is {radius:g}, but the grasp of {case.name} is for fingers of radius "
            f"{case.finger_radius:g} {case.unit}; icage.regrasp finds the grasp of other fingers"
        )
    return replace(case, finger_radius=radius)


def _for_drawings(why: str, reading: Reading, allowed: tuple[str, ...] = ()) -> None:
    """Refuse options that say how a drawing is read, for what is no drawing."""
    given = [name for name in reading.given() if name not in allowed]
    if given:
        options = " and ".join(option_of(name) for name in given)
        raise InputError(f"{options} {'is' if len(given) == 1 else 'are'} for drawings, but {why}")


def _refuse(why: str, **options: float | None) -> None:
    """Options that say nothing here; those that are None were not given."""
    for name, value in options.items():
        if value is not None:
            raise InputError(f"{name} is {value:g}, but {why}")


def _given(text: str) -> Path:
    path = Path(text)
    try:
        missing = not path.exists()
    except (OSError, ValueError) as error:
        why = (error.strerror if isinstance(error, OSError) else None) or str(error)
        raise InputError(f"{text!r} cannot be a file: {why}") from error
    if missing:
        owner, slash, _ = text.partition("/")
        if slash and owner in object_names():
            grasps = ", ".join(one for one in grasp_cases() if one.startswith(f"{owner}/"))
            raise InputError(f"{text!r} does not exist; shipped grasps of {owner}: {grasps}")
        names = ", ".join(object_names())
        raise InputError(f"{text!r} does not exist; shipped objects: {names}")
    return path
