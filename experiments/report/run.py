"""From a folder or a file to its page."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from experiments.report.content import Report
from experiments.report.escape import escape_report
from experiments.report.jams import jams_report
from experiments.report.page_html import MARK, page_html
from experiments.report.regress import regress_report
from experiments.report.replay import replay_report
from experiments.report.shake import shake_report
from experiments.report.source import Source, find
from experiments.report.study import study_report
from icage.errors import InputError
from icage.formats.whole_files import whole_file

NAME: Final = "report.html"
"""Of the page of a folder; the page of FILE.json is FILE.html."""

BUILDERS: Final[Mapping[str, Callable[[Source, Path], Report]]] = {
    "replay": replay_report,
    "study": study_report,
    "regress": regress_report,
    "escape": escape_report,
    "shake": shake_report,
    "jams": jams_report,
}


@dataclass(frozen=True, slots=True)
class Written:
    """A page that was written, of ``size`` bytes."""

    path: Path
    size: int
    report: Report


def usual_place(path: Path) -> Path:
    """Where the page of a folder or a file goes unless told.

    Raises
    ------
    InputError:
        There is a file of this name that is no page of ours.
    """
    place = path / NAME if path.is_dir() else path.with_suffix(".html")
    if place.exists() and not _is_ours(place):
        raise InputError(
            f"{str(place)!r} is there and no report; name another file with --out, or move it away"
        )
    return place


def _is_ours(place: Path) -> bool:
    try:
        with place.open("rb") as stream:
            return MARK.encode() in stream.read(4096)
    except OSError:
        return False


def write_report(source: Source, path: Path) -> Written:
    """Write the page of a document, whole or not at all.

    Raises
    ------
    InputError:
        The document, or a table beside it, is not as we write them.
    OutputError:
        The page cannot be written.
    """
    report = BUILDERS[source.kind](source, path)
    content = page_html(report).encode("utf-8")
    with whole_file(path) as part:
        part.write_bytes(content)
    return Written(path, len(content), report)


__all__ = ["NAME", "Written", "find", "usual_place", "write_report"]
