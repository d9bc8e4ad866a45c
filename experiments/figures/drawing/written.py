"""From a figure to its file: the suffixes there are, settings that no user's file changes, bytes.

Whole or not at all, and the same bytes for the same figure.
"""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import matplotlib
from matplotlib.figure import Figure

from icage.errors import InputError
from icage.formats.whole_files import whole_file

if TYPE_CHECKING:
    from matplotlib.typing import RcKeyType

FORMATS = (".svg", ".png")

FIGURE_SETTINGS: dict[RcKeyType, Any] = {
    "svg.hashsalt": "icage",
    "svg.fonttype": "path",
    "font.family": "DejaVu Sans",
    "mathtext.fontset": "dejavusans",
    "path.simplify": False,
}
"""Fixed, so that a user's matplotlibrc changes nothing; text as outlines looks alike everywhere."""


@contextmanager
def settings(font_size: float | None = None) -> Generator[None]:
    """The settings of matplotlib for every picture; whatever the user's are."""
    chosen = FIGURE_SETTINGS.copy()
    if font_size is not None:
        chosen["font.size"] = font_size
    with matplotlib.rc_context(chosen):
        yield


def check_suffix(path: Path) -> None:
    """Refuse a name that says no format.

    Raises
    ------
    InputError:
        The suffix is neither .svg nor .png.
    """
    if path.suffix.lower() not in FORMATS:
        raise InputError(f"figure {path.name}: a name ending in .svg or .png is needed")


def write(figure: Figure, path: Path) -> None:
    """Write a figure, whole or not at all, the same bytes every time; inside ``settings``."""
    with whole_file(path) as part:
        if path.suffix.lower() == ".svg":
            figure.savefig(part, format="svg", metadata={"Date": None})
        else:
            figure.savefig(part, format="png", dpi=200, metadata={"Software": "icage"})
