"""Rows on the disk: the table, and while it grows a hidden folder beside it with a file an object.

Every file says which search it is of, so that two are never mixed: what is of another search is
refused, never replaced; what cannot be read is searched again.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Generator, Iterable
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, TypeAlias

from experiments.collection.rows import Row, table_of
from experiments.io.arrow_table import Table
from experiments.io.changes import changes
from experiments.io.held_folder import held_folder, writable
from experiments.io.own_files import DamagedError, set_aside
from experiments.io.parquet_files import read_table, words_of, write_table
from experiments.io.versions import CODE, hint_of_code, said_of_code
from icage.errors import InputError
from icage.staging import sweep

_KEY: Final = b"icage-grasp-table"
"""Under which the document is kept with the rows."""

_PART: Final = re.compile(r"[0-9a-f]{32}\.parquet")
"""Rows of an object, named by its file's digest."""

Known: TypeAlias = dict[tuple[str, str], list[Row]]
"""(file, digest) to the rows of an object."""


@dataclass(frozen=True, slots=True)
class KeptRows:
    """The place of a table, and the document of the search that it is of."""

    table: Path
    document: dict[str, Any]
    any_code: bool = False
    """Rows of other code of the same version are taken, and said in the document."""

    @property
    def parts(self) -> Path:
        """The folder of what is done while not all is."""
        return self.table.with_name(f".{self.table.name}.parts")

    @contextmanager
    def alone(self) -> Generator[None]:
        """Hold the place, and leave no empty folder behind.

        Raises
        ------
        InputError:
            Another process is at it.
        """
        with held_folder(self.parts, "grasps"):
            try:
                sweep(self.table.parent)
                yield
            finally:
                with suppress(OSError):  # it holds rows
                    self.parts.rmdir()

    def known(self) -> Known:
        """All rows of this search that are there, finished or not.

        Raises
        ------
        InputError:
            The table or a part is of another search.
        """
        found: Known = {}
        if self.table.exists():
            try:
                table = read_table(self.table)
            except DamagedError as error:
                raise self._refused(str(error)) from error
            if _KEY not in words_of(table):
                raise self._refused("it is another table")
            self._add(table, found, str(self.table))
        with writable(self.parts):
            for path in sorted(self.parts.glob("*.parquet")):
                if not _PART.fullmatch(path.name):
                    continue
                try:
                    part = read_table(path)
                    if _KEY not in words_of(part):
                        raise DamagedError("it is no table of grasps")
                except DamagedError as error:
                    set_aside(
                        path, self.table.with_name(f"{self.table.name}.set-aside"), str(error)
                    )
                else:
                    self._add(part, found, f"{self.table} (unfinished, in {self.parts.name})")
        return found

    def _refused(self, why: str) -> InputError:
        return InputError(
            f"--out {str(self.table)!r} is no table of grasps and is not replaced; name another "
            f"file, or remove it ({why})"
        )

    def _add(self, table: Table, found: Known, place: str) -> None:
        free = (CODE,) if self.any_code else ()
        try:
            old: dict[str, Any] = json.loads(words_of(table)[_KEY])
            lines = [
                *changes({"format": old["format"]}, {"format": self.document["format"]}),
                *changes(old["options"], self.document["options"]),
                *changes(old["versions"], self.document["versions"], free, str),
            ]
            hint = hint_of_code(old["versions"], self.document["versions"])
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            raise InputError(f"--out {place!r}: its own words cannot be read: {error!r}") from error
        if lines:
            raise InputError(
                f"--out {place!r} holds another search: {'; '.join(lines)}; name another file, or "
                f"remove it{hint}"
            )
        self.document.update(said_of_code(old, self.document, self.any_code))
        mine: Known = {}
        for row in table.to_pylist():
            mine.setdefault((row["file"], row["digest"]), []).append(row)
        found |= mine

    def keep(self, file: str, rows: Iterable[Row]) -> None:
        """Keep the rows of an object, on the disk before this returns.

        Raises
        ------
        OutputError:
            The disk is full, or the folder may not be written to.
        """
        name = hashlib.sha256(file.encode()).hexdigest()[:32]
        self._write(rows, self.parts / f"{name}.parquet")

    def finish(self, rows: Iterable[Row]) -> None:
        """Write the whole table, then forget the parts."""
        self._write(rows, self.table)
        with writable(self.parts):
            for path in self.parts.glob("*.parquet"):
                if _PART.fullmatch(path.name):
                    path.unlink()

    def _write(self, rows: Iterable[Row], path: Path) -> None:
        words = {_KEY: json.dumps(self.document, sort_keys=True).encode()}
        write_table(table_of(rows), path, words)
