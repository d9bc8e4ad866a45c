"""One call of ``icage grasps`` for many objects: what is missing is searched, then the table is
written.
"""

from __future__ import annotations

import stat
import sys
from collections.abc import Iterator, Sequence
from contextlib import closing
from pathlib import Path
from typing import Final

from experiments.collection.backends import on_cluster, on_this_machine
from experiments.collection.kept_rows import KeptRows, Known
from experiments.collection.objects import Readable, object_files, read_one
from experiments.collection.options import SearchOptions
from experiments.collection.rows import Row, unreadable_row
from experiments.io.options import check_output
from experiments.io.pieces import cores
from experiments.io.progress import stage_bar
from experiments.io.versions import said_of_code
from icage.errors import InputError

_NAMED: Final = 10
"""Files without a grasp that are told of one by one."""


def check_table(out: str) -> Path:
    """The place of the table, looked at before any work.

    Raises
    ------
    InputError:
        It is no name for a Parquet file, or cannot be written.
    """
    if Path(out).suffix.lower() != ".parquet":
        raise InputError(f"--out {out!r}: a name ending in .parquet is needed")
    check_output("--out", out)
    place = Path(out).resolve()
    if place.exists() and not stat.S_ISREG(place.stat().st_mode):
        raise InputError(f"--out {out!r} is no regular file")
    return place


def search_objects(
    given: Sequence[str],
    out: str,
    options: SearchOptions,
    workers: int | None,
    scheduler: str | None,
    any_code: bool = False,
) -> list[str]:
    """Search every object of these files and folders that has no rows yet, and write all; the lines
    to print.

    The table is the same whatever was searched before, by how many, and in whatever order.

    Raises
    ------
    InputError:
        As ``object_files``, the table cannot be written or is of another search, or the cluster is
        no use.
    """
    place = check_table(out)
    files = object_files([Path(one) for one in given])
    document = options.document()
    if scheduler is None:
        backend = on_this_machine(options, document, workers or cores())
    else:
        backend = on_cluster(scheduler, document, any_code)
    document |= said_of_code(None, document, any_code)
    kept = KeptRows(place, document, any_code)
    with kept.alone():
        run = _Run(files, options, kept.known())
        with stage_bar() as bar, closing(backend(run.missing())) as answers:
            for one, rows in answers:
                kept.keep(one.file, rows)
                run.rows[one.file, one.digest] = rows
                run.searched += 1
                bar("objects", len(run.rows), len(files))
        rows = run.in_order()
        kept.finish(rows)
    _tell([row for row in rows if row["rank"] is None])
    return _summary(run, rows, given, out)


class _Run:
    """The objects in their order, and the rows of those that have some."""

    def __init__(self, files: list[tuple[str, Path]], options: SearchOptions, known: Known) -> None:
        self._files, self._options, self._known = files, options, known
        self._order: list[tuple[str, str]] = []
        self.rows: Known = {}
        self.searched = 0

    def missing(self) -> Iterator[Readable]:
        """Objects to search, read when they are asked for."""
        for file, path in self._files:
            one = read_one(file, path, self._options)
            key = (file, one.digest)
            self._order.append(key)
            if key in self._known:
                self.rows[key] = self._known[key]
            elif isinstance(one, Readable):
                yield one
            else:
                self.rows[key] = [unreadable_row(one)]

    def in_order(self) -> list[Row]:
        """All rows: by file, then by rank."""
        if len(self._order) != len(self._files):
            raise RuntimeError("not every object was looked at")
        return [{"rank": None, **row} for key in self._order for row in self.rows[key]]


def _tell(failed: list[Row]) -> None:
    """Files without a grasp, on standard error."""
    lines = [f"{row['file']}: {row['why']}" for row in failed[:_NAMED]]
    if len(failed) > _NAMED:
        lines.append(f"and {len(failed) - _NAMED} more without a grasp: column why of the table")
    for line in lines:
        print(f"icage: {line}", file=sys.stderr)


def _summary(run: _Run, rows: list[Row], given: Sequence[str], out: str) -> list[str]:
    failed = sum(row["rank"] is None for row in rows)
    count = len(run.rows)
    late = sum(row.get("ended") is not None for row in rows if row["rank"] in (None, 1))
    what = given[0] if len(given) == 1 else f"{len(given)} files and folders"
    lines = [
        f"{what}: {count} objects, {count - failed} with a grasp, {failed} without; "
        f"{run.searched} searched now"
    ]
    if late:
        lines.append(f"{late} searches were out of time: the best of what they had")
    lines.append(f"{len(rows)} rows in {out}")
    return lines
