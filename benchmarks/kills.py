"""Kill a study with SIGKILL at random moments until it is done, and compare with one left alone.

    python -m benchmarks.kills --kills 20 --json benchmarks/kills.json

Every start but the last is killed: one in five while it is still starting, the others while trials
are run and shards are written. After every kill, what was on the disk before must still be there.
In the end every trial must be there once, in rows that are those of an undisturbed run to the last
bit. A shard is small, so that files are being written a good part of the time.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq

CASE = "pliers"
VARIED = ("--vary", "place_xy=normal:5mm", "--vary", "outline_scale=grid:0.98,1.02")

_STARTING = 5
"""One kill in so many comes before the first trial."""


def main() -> None:
    """Kill, resume, compare, print; exit code 1 if anything is lost, doubled or different."""
    parser = argparse.ArgumentParser(description=__doc__, allow_abbrev=False)
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--seed", type=int, default=20)
    parser.add_argument("--trials", type=int, default=1000)
    parser.add_argument("--shard", type=int, default=5)
    parser.add_argument("--json", type=Path, help="write what was done")
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="icage-kills-") as folder:
        told = survive(Path(folder), chosen.kills, chosen.seed, chosen.trials, chosen.shard)
    for number, kill in enumerate(told["kills"], 1):
        half = f", {kill['half_written']} file half written" if kill["half_written"] else ""
        print(
            f"kill {number:2d}  {kill['after']:6.2f} s after its start, {kill['stage']:<8}  "
            f"{kill['kept']:5d} trials kept{half}"
        )
    print(
        f"{len(told['kills'])} kills, {told['trials']} trials: {told['lost']} lost, "
        f"{told['twice']} twice, {told['left_over']} files left over, "
        f"table {'the same to the last bit' if told['same'] else 'DIFFERENT'}"
    )
    if chosen.json:
        chosen.json.write_text(json.dumps(told, indent=1) + "\n")
    bad = told["lost"] or told["twice"] or told["left_over"] or not told["same"]
    sys.exit(1 if bad else 0)


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


if __name__ == "__main__":
    main()
