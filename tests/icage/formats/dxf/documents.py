"""DXF documents for the tests: made with ezdxf, or written by hand as an old program would."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import ezdxf
from ezdxf.document import Drawing

from icage.formats.drawings.trace import Traced
from tests.icage.formats.traced_files import traced_bytes


def new(version: str = "R2010", units: int = 4) -> tuple[Drawing, Any]:
    """A document in mm and its model space."""
    document = ezdxf.new(version, units=units)
    return document, document.modelspace()


def text_of(document: Drawing) -> str:
    stream = io.StringIO()
    document.write(stream)
    return stream.getvalue()


def read(folder: Path, document: Drawing | str | bytes, **reading: Any) -> Traced:
    content = document if isinstance(document, str | bytes) else text_of(document)
    return traced_bytes(folder, "drawing.dxf", content, **reading)


def by_hand(entities: str, header: str = "") -> str:
    """R12 as a program without a library writes it: entities and nothing else."""
    start = f"0\nSECTION\n2\nHEADER\n{header}0\nENDSEC\n" if header else ""
    return f"{start}0\nSECTION\n2\nENTITIES\n{entities}0\nENDSEC\n0\nEOF\n"


def line(x: float, y: float, x_end: float, y_end: float, layer: str = "0") -> str:
    return f"  0\nLINE\n  8\n{layer}\n 10\n{x}\n 20\n{y}\n 11\n{x_end}\n 21\n{y_end}\n"


def box(width: float = 40.0, height: float = 20.0, layer: str = "0") -> str:
    corners = [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)]
    return "".join(
        line(*a, *b, layer) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)
    )
