"""The case file that the live page saves: as text for the browser, and on disk where asked for."""

from __future__ import annotations

from pathlib import Path

from experiments.io.options import check_output
from icage.case import Case
from icage.errors import InputError, OutputError
from icage.formats.case_json import case_document
from icage.formats.json_out import json_text
from icage.formats.whole_files import whole_file

MADE_BY = "icage explore"


class Keeper:
    """Writes one file, over and over if asked, but never over anybody else's.

    Parameters
    ----------
    path:
        Where; None for nowhere.
    inputs:
        Files that the object was read from.

    Raises
    ------
    InputError:
        Something is there already, or no file can be made there.
    """

    def __init__(self, path: Path | None, inputs: tuple[Path, ...] = ()) -> None:
        self._path = path
        self._written: bytes | None = None
        if path is None:
            return
        check_output("--save", str(path), *inputs)
        if path.exists() or path.is_symlink():
            raise InputError(f"--save {str(path)!r} is there already; name a file that is not")

    def keep(self, case: Case) -> str:
        """The text of an answer: ``case``, the case's file, and ``written``, where it is.

        Raises
        ------
        OutputError:
            The file cannot be written, or is not as we left it.
        """
        document = case_document(case, MADE_BY)
        where = None if self._path is None else self._write(json_text(document), self._path)
        name = "".join(c if c.isalnum() or c in "-_." else "-" for c in case.name).strip(".-")
        return json_text({"file": f"{name or 'case'}.json", "case": document, "written": where})

    def _write(self, text: str, path: Path) -> str:
        content = text.encode("utf-8")
        there = path.exists() or path.is_symlink()
        if there and (self._written is None or path.read_bytes() != self._written):
            raise OutputError(f"{str(path)!r} is there and not as this page wrote it: left alone")
        with whole_file(path) as part:
            part.write_bytes(content)
        self._written = content
        return str(path)
