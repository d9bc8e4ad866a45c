"""The folder of a study: its document, shards written whole or not at all, the table in the end.

While it runs, ``shards/trials-FIRST-LAST.parquet`` hold trials FIRST..LAST. When it is done they
become one ``trials.parquet``. Each shard names the study it belongs to, so that none of another is
ever counted.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

from experiments.io.arrow_table import Table
from experiments.io.held_folder import writable
from experiments.io.own_files import DamagedError, own_json, set_aside
from experiments.io.parquet_files import (
    read_table,
    rows_and_words,
    sync_folder,
    words_of,
    write_table,
)
from experiments.study.inputs.config import MOST_TRIALS
from icage.errors import InputError
from icage.formats.json_out import json_text
from icage.formats.whole_files import whole_file
from icage.staging import sweep

JSON, TRIALS, PAGE = "study.json", "trials.parquet", "results.md"
SHARDS: Final = "shards"

ASIDE: Final = "set-aside"
"""Where what was no use is moved."""

_NAME: Final = re.compile(r"trials-(\d{9})-(\d{9})\.parquet")
_KEY: Final = b"icage-study"

_LARGEST: Final = 1_000_000_000
"""[byte] Largest document read."""


class ForeignError(DamagedError):
    """A table is of another study, of a replay, or of nobody we know."""


@dataclass(frozen=True, slots=True)
class StudyFolder:
    """A place on disk and the fingerprint of the study that lives there.

    Attributes
    ----------
    schema:
        Columns of its tables, if they are known.
    """

    path: Path
    fingerprint: str
    schema: Any = None

    def shards(self) -> Iterator[tuple[tuple[int, int], Table]]:
        """(first, last) trial and table of every whole shard of this study, in order.

        One that overlaps an earlier one is removed, one that is damaged or of another study is set
        aside, and both are run again. Files of other names are nobody's business.

        Raises
        ------
        UnreadableError:
            One cannot be read for a reason that is not in it.
        """
        with writable(self.path):
            yield from self._shards()

    def _shards(self) -> Iterator[tuple[tuple[int, int], Table]]:
        past = -1
        for path, span in self._named():
            try:
                table = self._whole(path, span)
            except DamagedError as error:
                set_aside(path, self.path / ASIDE, str(error))
                continue
            if span[0] > past:
                past = span[1]
                yield span, table
            else:
                path.unlink()

    def _named(self) -> Iterator[tuple[Path, tuple[int, int]]]:
        """Files with the name of a shard, and the trials that it says."""
        for path in sorted((self.path / SHARDS).glob("trials-*.parquet")):
            name = _NAME.fullmatch(path.name)
            if name is not None:
                yield path, (int(name[1]), int(name[2]))

    def _whole(self, path: Path, span: tuple[int, int]) -> Table:
        first, last = span
        if not first <= last < MOST_TRIALS:
            raise DamagedError(f"{path.name} is no name of a shard: there are no such trials")
        table = read_table(path, last - first + 1)
        self._check(table, path, first)
        if table.num_rows != last - first + 1:
            raise DamagedError(f"{str(path)!r} does not hold the trials that its name says")
        return table

    def _check(self, table: Table, path: Path, first: int) -> None:
        """A table of trials of this study, from ``first`` on, each once and in order."""
        if words_of(table).get(_KEY) != self.fingerprint.encode():
            raise ForeignError(f"{str(path)!r} is no table of this study")
        names = ("trial", "outcome") if self.schema is None else tuple(self.schema.names)
        if not set(names) <= set(table.column_names) or not (
            self.schema is None or table.replace_schema_metadata(None).schema.equals(self.schema)
        ):
            raise DamagedError(f"{str(path)!r} has not the columns of this study")
        numbers = np.arange(first, first + table.num_rows)
        if not np.array_equal(table["trial"].to_numpy(), numbers):
            raise DamagedError(f"{str(path)!r} does not hold each trial once, in order")

    def keep(self, table: Table, first: int) -> None:
        """Write a shard, whole and on the disk before it gets its name.

        Raises
        ------
        OutputError:
            The disk is full, or the folder may not be written to; nothing of it is left.
        """
        last = first + table.num_rows - 1
        path = self.path / SHARDS / f"trials-{first:09d}-{last:09d}.parquet"
        with writable(self.path):
            path.parent.mkdir(parents=True, exist_ok=True)
        self._write(table, path, for_long=False)

    def finish(self, table: Table) -> None:
        """Write the whole table, then forget the shards."""
        self._write(table, self.path / TRIALS, for_long=True)
        self.clear()

    def reopen(self, table: Table) -> None:
        """Make one shard of the whole table, for a study that goes on."""
        self.keep(table, 0)
        with writable(self.path):
            (self.path / TRIALS).unlink()

    def clear(self) -> None:
        """Remove the shards of this study: they are in the table."""
        with writable(self.path):
            for path, _ in self._named():
                if self._rows(path):
                    path.unlink()
            sweep(self.path / SHARDS)
        with suppress(OSError):
            (self.path / SHARDS).rmdir()

    def beyond(self, total: int) -> int:
        """How far the trials of this study go: one more than the last of them, 0 if none is past
        the first ``total``. Nothing is touched.
        """
        ends = [self._rows(self.path / TRIALS)]
        for path, (_, last) in self._named():
            if total <= last < MOST_TRIALS and self._rows(path):
                ends.append(last + 1)
        return max(ends) if max(ends) > total else 0

    def _rows(self, path: Path) -> int:
        """Rows of a table of this study by its own words, 0 if it is none."""
        try:
            rows, words = rows_and_words(path)
        except InputError:
            return 0
        return rows if words.get(_KEY) == self.fingerprint.encode() else 0

    def finished(self) -> Table | None:
        """The whole table if it is there.

        Raises
        ------
        UnreadableError, DamagedError:
            It cannot be read, or is not as this study wrote it. It stays where it is.
        """
        path = self.path / TRIALS
        if not os.path.lexists(path):
            return None
        try:
            table = read_table(path)
            self._check(table, path, 0)
        except ForeignError:
            raise
        except DamagedError as error:
            raise DamagedError(
                f"{error}; it is not replaced: move it away, and --resume runs its trials again"
            ) from error
        return table

    def check(self) -> None:
        """Refuse a folder whose table, or whose shards, are of another study.

        Raises
        ------
        UnreadableError, DamagedError:
            As ``finished``; or there are shards, and all are of another study.
        """
        self.finished()
        owners: set[bytes | None] = set()
        for path, _ in self._named():
            with suppress(DamagedError):
                owners.add(rows_and_words(path)[1].get(_KEY))
        if owners - {None} and self.fingerprint.encode() not in owners:
            raise ForeignError(
                f"{str(self.path / SHARDS)!r} holds trials of another study than {JSON} tells of; "
                "they are not replaced"
            )

    def row(self, index: int) -> dict[str, Any] | None:
        """The row of a trial, from the table or from a shard; None if it is not there."""
        table = self.finished()
        if table is not None:
            row = table.slice(index, 1).to_pylist()
            return row[0] if row else None
        for path, (first, last) in self._named():
            if first <= index <= last:
                found: dict[str, Any] = (
                    self._whole(path, (first, last)).slice(index - first, 1).to_pylist()[0]
                )
                return found
        return None

    def count(self) -> int:
        """Trials that are there, by their files' own words."""
        whole = self._rows(self.path / TRIALS)
        return whole or sum(self._rows(path) for path, _ in self._named())

    def _write(self, table: Table, path: Path, *, for_long: bool) -> None:
        write_table(table, path, {_KEY: self.fingerprint.encode()}, for_long=for_long)


def read_document(folder: Path) -> dict[str, Any] | None:
    """``study.json`` of a folder, None if there is none.

    Raises
    ------
    InputError:
        It is no study's document.
    """
    path = folder / JSON
    return own_json(path, _LARGEST) if os.path.lexists(path) else None


def write_document(document: dict[str, Any], folder: Path) -> None:
    """Write ``study.json``, whole or not at all."""
    with whole_file(folder / JSON) as part, part.open("w", encoding="utf-8") as stream:
        stream.write(json_text(document))
        stream.flush()
        os.fsync(stream.fileno())
    sync_folder(folder)
