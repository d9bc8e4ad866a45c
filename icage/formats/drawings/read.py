"""Read a drawing of any format: which reader a file needs, and how large it may be."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Final, NamedTuple, TypeAlias

from icage.errors import FormatError, InputError
from icage.formats.drawings.reading import Reading
from icage.formats.files import read_bytes

if TYPE_CHECKING:
    from icage.formats.drawings.drawing import Drawing
    from icage.formats.drawings.trace import Traced

Reader: TypeAlias = "Callable[[bytes, Reading], Drawing]"


class Format(NamedTuple):
    """A format of drawings.

    Attributes
    ----------
    name:
        What to call it.
    reader:
        Module with ``read(content, reading)``, imported when it is needed.
    limit:
        [bytes] Largest file.
    """

    name: str
    reader: str
    limit: int


_SVG: Final = Format("an SVG drawing", "icage.formats.svg.reader", 10_000_000)

FORMATS: Final[dict[str, Format]] = {
    ".svg": _SVG,
}
"""By the suffix of the file's name."""


def is_drawing(path: Path) -> bool:
    """Whether the name is that of a drawing.

    >>> is_drawing(Path("a.SVG")), is_drawing(Path("a.json"))
    (True, False)
    """
    return path.suffix.lower() in FORMATS


def read_drawing(path: Path, reading: Reading) -> Drawing:
    """What a file holds.

    Raises
    ------
    FormatError:
        Not readable, too large, or not understood.
    """
    form = FORMATS.get(path.suffix.lower())
    if form is None:
        if path.is_dir():
            raise FormatError(f"{path} is a folder; a drawing is needed")
        raise FormatError(f"{path} is no drawing; {', '.join(FORMATS)} are read")
    content = read_bytes(path, form.limit, form.name)
    reader: Reader = import_module(form.reader).read
    return reader(content, reading)


def trace_file(path: Path, reading: Reading) -> Traced:
    """The outline of a drawing in a file. Raises what ``read_drawing`` and ``traced`` raise."""
    from icage.formats.drawings.trace import traced  # only now: it loads shapely

    try:
        return traced(read_drawing(path, reading), reading)
    except InputError as error:
        raise type(error)(str(error) if str(path) in str(error) else f"{path}: {error}") from error
