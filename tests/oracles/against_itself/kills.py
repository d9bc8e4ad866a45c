"""A study that is killed at random moments until it is done, beside one left alone."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq

CASE = "pliers"
VARIED = ("--vary", "place_xy=normal:5mm", "--vary", "outline_scale=grid:0.98,1.02")

_STARTING = 5
"""One kill in so many comes before the first trial."""


def survive(folder: Path, kills: int, seed: int, trials: int, shard: int) -> dict[str, Any]:
    """Run a study alone and one that is killed so many times; what became of it."""
    rng = np.random.default_rng(seed)
    begun = time.monotonic()
    alone = _start(folder / "alone", trials, shard)
    _announced(alone)
    starting = time.monotonic() - begun
    _check(alone)
    working = time.monotonic() - begun - starting
    out, done = folder / "killed", []
    for number in range(kills):
        before = _kept(out)
        begun = time.monotonic()
        child = _start(out, trials, shard)
        if number % _STARTING == _STARTING - 1:
            stage, wait = "starting", rng.uniform(0.0, starting)
        else:  # in all about the whole work, the first shards of every start counted off
            _announced(child)
            stage, wait = "running", rng.uniform(0.0, 2.4 * working / kills)
        time.sleep(wait)
        child.kill()
        after = time.monotonic() - begun
        finished = child.wait() == 0
        _close(child)
        kept = _kept(out)
        if not before <= kept:
            raise RuntimeError(f"kill {number + 1} lost trials {sorted(before - kept)}")
        half = sum(path.is_file() for path in out.rglob(".*"))
        done.append(
            {
                "after": round(after, 3),
                "stage": "finished" if finished else stage,
                "kept": len(kept),
                "half_written": half,
            }
        )
    _check(_start(out, trials, shard))
    one, other = (pq.read_table(f / "trials.parquet") for f in (folder / "alone", out))
    numbers = other["trial"].to_numpy()
    return {
        "format": "icage-kills/1",
        "case": CASE,
        "vary": list(VARIED[1::2]),
        "seed": seed,
        "trials": trials,
        "shard": shard,
        "starting_seconds": round(starting, 2),
        "working_seconds": round(working, 2),
        "kills": done,
        "lost": int(trials - len(set(numbers.tolist()))),
        "twice": int(len(numbers) - len(set(numbers.tolist()))),
        "left_over": sum(p.name not in _WHOLE for p in out.rglob("*")),
        "same": bool(one.equals(other)) and _found(folder / "alone") == _found(out),
    }


_WHOLE = ("study.json", "trials.parquet", "results.md")


def _start(out: Path, trials: int, shard: int) -> subprocess.Popen[str]:
    """``--resume`` also where there is nothing yet: what a script would do."""
    options = ("--trials", str(trials), "--shard", str(shard), "--resume", "--no-figures")
    command = (sys.executable, "-m", "experiments.cli", "study", CASE, *VARIED, *options)
    return subprocess.Popen(
        [*command, "--out", str(out)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


def _announced(child: subprocess.Popen[str]) -> None:
    """Wait for the line that is printed before the first trial."""
    assert child.stdout is not None
    if not child.stdout.readline():
        _check(child)


def _check(child: subprocess.Popen[str]) -> None:
    _, err = child.communicate()
    if child.returncode:
        raise RuntimeError(f"the study ended with {child.returncode}: {err}")


def _close(child: subprocess.Popen[str]) -> None:
    for stream in (child.stdout, child.stderr):
        if stream is not None:
            stream.close()


def _kept(out: Path) -> set[int]:
    """Trials in files that have their name."""
    paths = [out / "trials.parquet", *(out / "shards").glob("trials-*.parquet")]
    found: set[int] = set()
    for path in paths:
        if path.is_file():
            found |= set(pq.read_table(path, columns=["trial"])["trial"].to_pylist())
    return found


def _found(folder: Path) -> Any:
    return json.loads((folder / "study.json").read_text())["found"]
