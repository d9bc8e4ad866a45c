"""Studies of 120 closings of the T: placed off by so much that some fail, in two sizes."""

from __future__ import annotations

import functools
import itertools
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from experiments.cli import main
from experiments.study.run import shards as run
from experiments.study.run.folder import StudyFolder
from tests.experiments.commands.runner import Result, here
from tests.experiments.small import t_case, write_case

VARIED = ("--vary", "place_xy=normal:0.2", "--vary", "outline_scale=grid:0.98,1.02")
TRIALS = 120
WHOLE = ["results.md", "study.json", "trials.parquet"]


@dataclass(frozen=True)
class Studied:
    """A folder that holds, or will hold, a study of the T."""

    path: Path
    capsys: pytest.CaptureFixture[str] | None = None

    def run(self, *options: str, varied: tuple[str, ...] = VARIED) -> Result:
        """By the command, all of it given."""
        size = () if "--trials" in options else ("--trials", str(TRIALS))
        return self.command(str(t_file(self.path.parent)), *varied, *size, *options)

    def resume(self, *options: str) -> Result:
        """By the command, without naming the case."""
        return self.command("--resume", *options)

    def command(self, *options: str) -> Result:
        arguments = ("study", *options, "--out", str(self.path), "--no-figures")
        if self.capsys is None:
            return Result(main(arguments), "", "")
        return here(self.capsys, *arguments)

    def broken_off(self, patch: pytest.MonkeyPatch, shards: int, *options: str) -> Self:
        """Interrupted when so many shards are kept."""
        with patch.context() as inner:
            inner.setattr(StudyFolder, "keep", failing(StudyFolder.keep, shards, KeyboardInterrupt))
            assert self.run(*options).code == 130
        assert len(self.shards) == shards
        return self

    @property
    def shards(self) -> list[Path]:
        return sorted((self.path / "shards").glob("trials-*"))

    @property
    def table(self) -> pa.Table:
        return pq.read_table(self.path / "trials.parquet").replace_schema_metadata(None)

    @property
    def document(self) -> dict[str, Any]:
        return json.loads((self.path / "study.json").read_text())

    @property
    def files(self) -> dict[str, bytes]:
        paths = sorted(path for path in self.path.rglob("*") if path.is_file())
        return {str(path.relative_to(self.path)): path.read_bytes() for path in paths}

    def check_same(self, other: Studied) -> None:
        """To the last bit, in rows and findings, and nothing else is left in the folder."""
        assert self.table.equals(other.table)
        assert self.document["found"] == other.document["found"]
        assert self.document["finished"]
        assert list(self.files) == WHOLE


def t_file(folder: Path) -> Path:
    """The T as a case file."""
    path = folder / "t.json"
    return path if path.is_file() else write_case(t_case(), path)


@functools.cache
def left_alone(folder: Path, trials: int = TRIALS, *options: str) -> Studied:
    """One thread, one shard, one process: what any other way must give."""
    done = Studied(folder / f"alone_{trials}{''.join(options)}")
    result = done.run("--trials", str(trials), "--threads", "1", "--shard", "1000", *options)
    assert result.code == 0
    return done


def failing(real: Any, good: int, error: type[BaseException], *words: Any) -> Any:
    """A function that raises from its call ``good`` (from 0) on."""
    calls = itertools.count()

    def call(*given: Any, **named: Any) -> Any:
        if next(calls) >= good:
            raise error(*words)
        return real(*given, **named)

    return call


def no_trials(patch: pytest.MonkeyPatch) -> None:
    """From now on a trial that is run is a mistake."""
    patch.setattr(run, "shard_table", failing(None, 0, AssertionError, "a trial was run"))
