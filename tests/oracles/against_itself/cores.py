"""One study run in many ways: other cores, threads, shards, machines; its table byte for byte."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import socket
import subprocess
import sys
from collections.abc import Generator, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

VARIED: Final = (
    "place_xy=normal:2%",
    "outline_noise=0:0.3%",
    "outline_scale=0.98:1.02",
    "finger_radius=-0.2%:0.2%",
    "phi_1=normal:0.5deg",
    "phi_2=normal:0.5deg",
    "friction=0:0.1",
)
"""Everything that gives a trial a target of its own, and what moves its closing."""

CASES: Final = ("pliers", "wrench", "saw", "disc")
"""Polygons of many edges, and one that discs touch on its corners."""

_THREADS: Final = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")


@dataclass(frozen=True)
class Way:
    """A way to run the study.

    Attributes
    ----------
    blas:
        Threads that libraries of linear algebra are told to use; None tells them nothing.
    one_core:
        Bound to one core, as by ``taskset -c 0``.
    first:
        So many trials first, in a run of their own; then the others with ``--resume``.
    workers:
        On a dask cluster of so many processes, each with a nanny.
    """

    name: str
    blas: int | None = None
    one_core: bool = False
    options: tuple[str, ...] = field(default=())
    first: int | None = None
    workers: int = 0


WAYS: Final = (
    Way("as it comes"),
    Way("taskset -c 0", one_core=True),
    Way("1 BLAS thread", blas=1),
    Way("2 BLAS threads", blas=2),
    Way("4 BLAS threads", blas=4),
    Way("1 thread", options=("--threads", "1")),
    Way("2 threads", options=("--threads", "2")),
    Way("4 threads", options=("--threads", "4"), blas=4),
    Way("shards of 7", options=("--shard", "7")),
    Way("shards of 1000", options=("--shard", "1000")),
    Way("resumed", first=50, options=("--shard", "7"), blas=4),
    Way("resumed on one core", first=90, options=("--shard", "1000"), one_core=True),
    Way("dask, 2 nannies", workers=2, options=("--shard", "7")),
    Way("dask, 2 nannies, shards of 1000", workers=2, options=("--shard", "1000")),
)


def tables(
    folder: Path, case: str, trials: int, ways: Sequence[Way] = WAYS
) -> Generator[tuple[Way, str]]:
    """Each way with the digest of everything that a study found, and of its table's bytes."""
    for number, way in enumerate(ways):
        out = folder / f"{case}_{number}"
        with _address(way) as address:
            options = (*way.options, *(("--scheduler", address) if address else ()))
            if way.first is not None:
                _run(case, out, way, ("--trials", str(way.first), *options))
            _run(case, out, way, ("--trials", str(trials), "--resume", *options))
        yield way, _digest(out)
        shutil.rmtree(out)


def _digest(out: Path) -> str:
    document: dict[str, Any] = json.loads((out / "study.json").read_text())
    digest = hashlib.sha256((out / "trials.parquet").read_bytes())
    digest.update(json.dumps([document["found"], document["nominal"]], sort_keys=True).encode())
    return digest.hexdigest()


def _run(case: str, out: Path, way: Way, options: Sequence[str]) -> None:
    given = case if case != "disc" else "models/cases/disc_hammer.json"
    varied = [word for one in VARIED for word in ("--vary", one)]
    command = [sys.executable, "-m", "experiments.cli", "study", given, *varied, "--no-figures"]
    environment = {k: v for k, v in os.environ.items() if k not in _THREADS}
    if way.blas is not None:
        environment |= dict.fromkeys(_THREADS, str(way.blas))
    done = subprocess.run(
        [*command, "--seed", "3", "--out", str(out), *options], check=False,
        env=environment, capture_output=True, text=True, timeout=600,
        preexec_fn=_on_one_core if way.one_core else None,
    )  # fmt: skip
    if done.returncode:
        raise RuntimeError(f"{way.name}: the study ended with {done.returncode}: {done.stderr}")


def _on_one_core() -> None:
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})


@contextmanager
def _address(way: Way) -> Generator[str | None]:
    """The scheduler of a cluster whose workers have nannies, which set their BLAS threads."""
    if not way.workers:
        yield None
        return
    with closing(socket.socket()) as found:
        found.bind(("127.0.0.1", 0))
        port = str(found.getsockname()[1])
    address = f"tcp://127.0.0.1:{port}"
    quiet = ("--no-dashboard", "--dashboard-address", "127.0.0.1:0")
    crew = ("--nworkers", str(way.workers), "--nthreads", "1")
    programs = [
        ("distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", port, *quiet),
        ("distributed.cli.dask_worker", address, *crew, *quiet),
    ]
    children = [
        subprocess.Popen(
            [sys.executable, "-m", *program],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )
        for program in programs
    ]  # fmt: skip
    try:
        from distributed import Client

        with Client(address, timeout=60, set_as_default=False) as client:
            client.wait_for_workers(way.workers, timeout=60)
        yield address
    finally:
        for child in reversed(children):  # asked to end, a nanny ends its worker
            child.terminate()
            child.wait(60)
