"""The folder of a study: its document, shards written whole or not at all, the table in the end.

While it runs, ``shards/trials-FIRST-LAST.parquet`` hold trials FIRST..LAST. When it is done they
become one ``trials.parquet``. Each shard names the study it belongs to, so that none of another is
ever counted.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Generator, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from experiments.io.arrow_table import Table
from experiments.io.held_folder import held_folder, writable
from experiments.io.parquet_files import read_table, sync_folder, words_of, write_table
from icage.errors import InputError
from icage.formats.json_out import json_text
from icage.formats.whole_files import whole_file

JSON, TRIALS, PAGE = "study.json", "trials.parquet", "results.md"
SHARDS: Final = "shards"

_NAME: Final = re.compile(r"trials-(\d{9})-(\d{9})\.parquet")
_KEY: Final = b"icage-study"

_PART: Final = re.compile(r"\.[a-z]+\.[0-9a-f]{8}\.(json|parquet|md|svg)")
"""A file that was being written when its process was killed."""

_LARGEST: Final = 1_000_000_000
"""[byte] Largest document read."""


@dataclass(frozen=True, slots=True)
class StudyFolder:
    """A place on disk and the fingerprint of the study that lives there."""

    path: Path
    fingerprint: str

    @contextmanager
    def alone(self) -> Generator[None]:
        """Make the folder and hold it; the hold ends with the process, however that ends.

        Two studies at once would take each other's shards for leftovers.

        Raises
        ------
        InputError:
            Another process holds it.
        """
        with held_folder(self.path, "study"):
            yield

    def shards(self) -> Iterator[tuple[tuple[int, int], Table]]:
        """(first, last) trial and table of every whole shard of this study, in order; others are
        removed.

        A shard that cannot be read, is of another study or overlaps an earlier one is run again.
        """
        with writable(self.path):
            yield from self._shards()

    def _shards(self) -> Iterator[tuple[tuple[int, int], Table]]:
        past = -1
        for path in sorted((self.path / SHARDS).glob("trials-*.parquet")):
            name = _NAME.fullmatch(path.name)
            span = (int(name[1]), int(name[2])) if name else (0, -1)
            table = self._whole(path, span) if span[0] > past else None
            if table is None:
                path.unlink()
            else:
                past = span[1]
                yield span, table
        for part in (self.path / SHARDS).glob(".trials-*"):  # of a process that was killed
            part.unlink()

    def _whole(self, path: Path, span: tuple[int, int]) -> Table | None:
        table = self._read(path)
        if table is None:
            return None
        numbers = np.arange(span[0], span[1] + 1)
        return table if np.array_equal(table["trial"].to_numpy(), numbers) else None

    def _read(self, path: Path) -> Table | None:
        """A table of this study, every page of it as it was written; else None."""
        table = read_table(path)
        if table is None:
            return None
        own = words_of(table).get(_KEY) == self.fingerprint.encode()
        return table if own and "trial" in table.column_names else None

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
        self._write(table, path)

    def finish(self, table: Table) -> None:
        """Write the whole table, then forget the shards."""
        self._write(table, self.path / TRIALS)
        self.clear()

    def reopen(self, table: Table) -> None:
        """Make one shard of the whole table, for a study that goes on."""
        self.keep(table, 0)
        with writable(self.path):
            (self.path / TRIALS).unlink()

    def clear(self) -> None:
        """Remove the shards: they are in the table."""
        with writable(self.path):
            for path in (self.path / SHARDS).glob("*trials-*"):
                path.unlink()
        with suppress(OSError):
            (self.path / SHARDS).rmdir()

    def beyond(self, total: int) -> int:
        """How far the trials of this study go: one more than the last of them, 0 if none is past
        the first ``total``. Nothing is touched.
        """
        ends = [self._rows(self.path / TRIALS)]
        for path in (self.path / SHARDS).glob("trials-*.parquet"):
            name = _NAME.fullmatch(path.name)
            if name and int(name[2]) >= total and self._rows(path):
                ends.append(int(name[2]) + 1)
        return max(ends) if max(ends) > total else 0

    def _rows(self, path: Path) -> int:
        """Rows of a table of this study by its own words, 0 if it is none."""
        try:
            with pq.ParquetFile(path) as file:
                words = file.schema_arrow.metadata or {}
                own = words.get(_KEY) == self.fingerprint.encode()
                return int(file.metadata.num_rows) if own else 0
        except (OSError, ValueError, pa.ArrowException):
            return 0

    def sweep(self) -> None:
        """Remove what a killed process had half written."""
        with writable(self.path):
            for path in self.path.glob(".*"):
                if _PART.fullmatch(path.name):
                    path.unlink()

    def finished(self) -> Table | None:
        """The whole table if it is there and of this study."""
        return self._read(self.path / TRIALS)

    def _write(self, table: Table, path: Path) -> None:
        write_table(table, path, {_KEY: self.fingerprint.encode()})


def read_document(folder: Path) -> dict[str, Any] | None:
    """``study.json`` of a folder, None if there is none.

    Raises
    ------
    InputError:
        It is no study's document.
    """
    path = folder / JSON
    try:
        if path.stat().st_size > _LARGEST:
            raise InputError(f"{str(path)!r} is larger than {_LARGEST} bytes")
        document = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return None
    except (OSError, ValueError, RecursionError) as error:
        raise InputError(f"{str(path)!r} cannot be read: {error}") from error
    if not isinstance(document, dict):
        raise InputError(f"{str(path)!r} is not a study's document")
    return document


def write_document(document: dict[str, Any], folder: Path) -> None:
    """Write ``study.json``, whole or not at all."""
    with whole_file(folder / JSON) as part, part.open("w", encoding="utf-8") as stream:
        stream.write(json_text(document))
        stream.flush()
        os.fsync(stream.fileno())
    sync_folder(folder)
