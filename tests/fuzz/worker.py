"""The process that runs jobs, one after another, and is replaced when one takes it along."""

from __future__ import annotations

import functools
import multiprocessing
import os
import resource
import shutil
import sys
import tempfile
import time
import traceback
import warnings
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Final

import experiments.cli
from tests.fuzz.job import PATIENCE, Job, Outcome

_WARM: Final = 300.0
"""[s] A new process loads and, on a bare machine, compiles."""

_CEILING: Final = 4_000_000_000
"""[byte] Of heap: beyond it a job fails by itself, before the machine does."""


_AT_WORK: Final = 0.01
"""[1] Who has had less than this share of a processor is not at work but waits for something."""


def _processor_time(pid: int | None) -> float:
    """[s] That a process has had, all its threads."""
    times = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(times[11]) + int(times[12])) / os.sysconf("SC_CLK_TCK")


class Guard:
    """A worker that is there when it is needed. Jobs go one by one."""

    def __init__(self) -> None:
        self._process: multiprocessing.process.BaseProcess | None = None
        self._end: Connection | None = None
        self.started = 0

    def run(self, job: Job) -> Outcome:
        """What came of a job; one that takes too long or kills its process has code None."""
        end = self._worker()
        pid = self._process.pid if self._process is not None else None
        began = spent = _processor_time(pid)
        end.send(job)
        try:
            while True:
                if end.poll(PATIENCE):
                    answer: Outcome = end.recv()
                    return answer
                before, spent = spent, _processor_time(pid)
                # on a machine that does other things it may only have had no turn
                if spent - before < _AT_WORK * PATIENCE or spent - began > PATIENCE:
                    break
            reason = f"still at work after {spent - began:.1f} s of processor time"
        except (EOFError, ConnectionError):
            reason = "the process died"
        self.close()
        return Outcome(None, reason, spent - began, 0)

    def close(self) -> None:
        """End the worker."""
        if self._process is not None and self._end is not None:
            self._process.kill()
            self._process.join()
            self._end.close()
        self._process = self._end = None

    def _worker(self) -> Connection:
        if self._end is not None:
            return self._end
        context = multiprocessing.get_context("spawn")
        ours, theirs = context.Pipe()
        process = context.Process(target=serve, args=(theirs,), daemon=True)
        process.start()
        theirs.close()
        self.started += 1
        if not ours.poll(_WARM):
            process.kill()
            raise RuntimeError("the worker does not start")
        ours.recv()
        self._process, self._end = process, ours
        return ours


def serve(end: Connection) -> None:
    """Run jobs as they come, in a folder of their own."""
    os.environ["ICAGE_COMPILE_BEHIND"] = "0"
    resource.setrlimit(resource.RLIMIT_DATA, (_CEILING, _CEILING))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    sys.warnoptions = ["always"]  # as `python -W always`: the command line shows them, then
    warnings.simplefilter("always")
    with tempfile.TemporaryDirectory(prefix="icage-fuzz-", dir=_in_memory()) as place:
        folder = Path(place) / "in"
        _warm(folder)
        end.send(None)
        while True:
            try:
                job = end.recv()
            except EOFError:
                return
            end.send(run_here(job, folder))


def _in_memory() -> str | None:
    """A place for small files that never reach a disk, where there is one."""
    return "/dev/shm" if os.access("/dev/shm", os.W_OK) else None


def _warm(folder: Path) -> None:
    """Load what is loaded late, so that no job pays for it, and build the parser only once."""
    experiments.cli.parser = functools.cache(experiments.cli.parser)
    for arguments in (("plan", "pliers", "--method", "both"), ("plan", "wrench", "--json", "-")):
        run_here(Job({}, arguments), folder)


def run_here(job: Job, folder: Path) -> Outcome:
    """A job in this process, its standard streams caught with all that libraries write there."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    for name, content in job.files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    before = _files(folder)
    caught = folder.with_name("standard-error")
    here = Path.cwd()
    os.chdir(folder)
    _forget_peak()
    started = time.process_time()
    with caught.open("w+b") as err, Path(os.devnull).open("r+b") as nowhere:
        kept = [os.dup(stream) for stream in (0, 1, 2)]
        sys.stdout.flush()
        sys.stderr.flush()
        for stream, to in ((0, nowhere), (1, nowhere), (2, err)):
            os.dup2(to.fileno(), stream)
        try:
            code = _called(job)
        finally:
            sys.stdout.flush()
            sys.stderr.flush()
            for stream, was in zip((0, 1, 2), kept, strict=True):
                os.dup2(was, stream)
                os.close(was)
            os.chdir(here)
        err.seek(0)
        text = err.read(100_000).decode("utf-8", "replace")
    new = tuple(sorted(_files(folder) - before))
    return Outcome(code, text, time.process_time() - started, _peak(), new)


def _called(job: Job) -> int:
    from tests.fuzz.calls import CALLS

    try:
        return CALLS[job.call](job.arguments)
    except BaseException:
        traceback.print_exc()
        return 1


def _files(folder: Path) -> set[str]:
    return {str(path.relative_to(folder)) for path in folder.rglob("*")}


def _forget_peak() -> None:
    Path("/proc/self/clear_refs").write_text("5")


def _peak() -> int:
    """[byte] Most memory since it was last forgotten."""
    lines = Path("/proc/self/status").read_text().splitlines()
    row = next(line for line in lines if line.startswith("VmHWM:"))
    return 1024 * int(row.split()[1])
