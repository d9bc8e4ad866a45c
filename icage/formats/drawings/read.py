"""Read a drawing of any format: which reader a file needs, and how large it may be."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Final, NamedTuple, TypeAlias

from icage.errors import FormatError, InputError
from icage.formats.drawings.reading import Reading, option_of
from icage.formats.files import read_bytes
from icage.library_faults import geometry_told

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
    options:
        Fields of ``Reading`` that say something here and not everywhere.
    """

    name: str
    reader: str
    limit: int
    options: tuple[str, ...] = ()


_OF_MESHES: Final = ("section", "axis")

_SPECIAL: Final = ("layers", *_OF_MESHES, "threshold")
"""Options of some formats."""

_SVG: Final = Format("an SVG drawing", "icage.formats.svg.reader", 10_000_000)
_DXF: Final = Format("a DXF drawing", "icage.formats.dxf.reader", 20_000_000, ("layers",))
_STL: Final = Format("an STL mesh", "icage.formats.mesh.stl", 60_000_000, _OF_MESHES)
_OBJ: Final = Format("an OBJ mesh", "icage.formats.mesh.obj", 60_000_000, _OF_MESHES)
_PLY: Final = Format("a PLY mesh", "icage.formats.mesh.ply", 60_000_000, _OF_MESHES)
_IMAGE: Final = Format(
    "a PNG or JPEG image", "icage.formats.image.reader", 60_000_000, ("threshold",)
)
_GEOJSON: Final = Format("a GeoJSON file", "icage.formats.geo.geojson", 10_000_000)
_WKT: Final = Format("a WKT file", "icage.formats.geo.wkt", 10_000_000)

FORMATS: Final[dict[str, Format]] = {
    ".svg": _SVG,
    ".dxf": _DXF,
    ".stl": _STL,
    ".obj": _OBJ,
    ".ply": _PLY,
    ".png": _IMAGE,
    ".jpg": _IMAGE,
    ".jpeg": _IMAGE,
    ".geojson": _GEOJSON,
    ".wkt": _WKT,
}
"""By the suffix of the file's name."""

PICTURES: Final = (".png", ".jpg", ".jpeg")
"""Those that may be there for other reasons: beside drawings, as previews of them."""

_MESHES: Final = "export the part as STL, or a sketch of it as DXF"
_PICTURES: Final = "save it as PNG"

NOT_READ: Final[dict[str, tuple[str, str]]] = {
    ".svgz": ("a compressed SVG drawing", "unpack it with gunzip, or save it as plain SVG"),
    ".dwg": ("a DWG drawing", "save it as DXF"),
    ".dwf": ("a DWF drawing", "export DXF"),
    ".pdf": ("a PDF document", "export SVG or DXF"),
    ".eps": ("an EPS drawing", "export SVG or DXF"),
    ".ps": ("a PostScript drawing", "export SVG or DXF"),
    ".ai": ("an Illustrator drawing", "export SVG"),
    ".cdr": ("a CorelDRAW drawing", "export SVG or DXF"),
    ".step": ("a STEP model", _MESHES),
    ".stp": ("a STEP model", _MESHES),
    ".iges": ("an IGES model", _MESHES),
    ".igs": ("an IGES model", _MESHES),
    ".fcstd": ("a FreeCAD document", _MESHES),
    ".scad": ("an OpenSCAD program", _MESHES),
    ".3mf": ("a 3MF model", "export STL"),
    ".amf": ("an AMF model", "export STL"),
    ".glb": ("a glTF model", "export STL"),
    ".gltf": ("a glTF model", "export STL"),
    ".off": ("an OFF mesh", "export STL, OBJ or PLY"),
    ".heic": ("a HEIC image", _PICTURES),
    ".webp": ("a WebP image", _PICTURES),
    ".bmp": ("a BMP image", _PICTURES),
    ".gif": ("a GIF image", _PICTURES),
    ".tif": ("a TIFF image", _PICTURES),
    ".tiff": ("a TIFF image", _PICTURES),
    ".shp": ("a shapefile", "export GeoJSON"),
    ".kml": ("a KML file", "export GeoJSON in a projection in metres"),
    ".gpkg": ("a GeoPackage", "export GeoJSON"),
}
"""Formats that are known and not read: what each is called, and the way out."""


def is_drawing(path: Path) -> bool:
    """Whether the name is that of a drawing, be it of a format that is refused by its name.

    >>> is_drawing(Path("a.SVG")), is_drawing(Path("a.dwg")), is_drawing(Path("a.json"))
    (True, True, False)
    """
    return path.suffix.lower() in FORMATS or path.suffix.lower() in NOT_READ


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
        if path.suffix.lower() in NOT_READ:
            what, way_out = NOT_READ[path.suffix.lower()]
            raise FormatError(f"{path} is {what}, which is not read: {way_out}")
        if path.suffix.lower() == ".json":
            raise FormatError(
                f"{path} is no drawing but JSON: a case has its outline already, and `icage plan` "
                "and `icage grasps` take it; GeoJSON is read if its name ends in .geojson"
            )
        raise FormatError(f"{path} is no drawing; {', '.join(FORMATS)} are read")
    if _is_no_file(path):
        raise FormatError(f"{path} is a pipe or a device; {form.name} in a file is needed")
    _refuse_others(reading, form)
    content = read_bytes(path, form.limit, form.name)
    reader: Reader = import_module(form.reader).read
    return reader(content, reading)


def fitting(path: Path, reading: Reading) -> Reading:
    """The options that say something about this file: for folders, whose files are of many kinds.

    >>> fitting(Path("a.svg"), Reading(unit="mm", layers=("CUT",))).given()
    {'unit': 'mm'}
    """
    form = FORMATS.get(path.suffix.lower())
    if form is None:
        return reading
    others = {name: None for name in _SPECIAL if name not in form.options}
    return replace(reading, **others)


def _refuse_others(reading: Reading, form: Format) -> None:
    for name in reading.given():
        if name in _SPECIAL and name not in form.options:
            kinds = " or ".join(one.name for one in _kinds_with(name))
            raise FormatError(f"{option_of(name)} is for {kinds}, and this is {form.name}")


def _kinds_with(option: str) -> list[Format]:
    return [form for form in dict.fromkeys(FORMATS.values()) if option in form.options]


def _is_no_file(path: Path) -> bool:
    """Whether a path is a pipe or a device: a pipe that nobody writes to would be waited for."""
    try:
        return path.exists() and not path.is_file() and not path.is_dir()
    except (OSError, ValueError):  # no path at all, which is told when it is read
        return False


@geometry_told()
def trace_file(path: Path, reading: Reading) -> Traced:
    """The outline of a drawing in a file. Raises what ``read_drawing`` and ``traced`` raise."""
    from icage.formats.drawings.trace import traced  # only now: it loads shapely

    try:
        return traced(read_drawing(path, reading), reading)
    except InputError as error:
        raise type(error)(str(error) if str(path) in str(error) else f"{path}: {error}") from error
