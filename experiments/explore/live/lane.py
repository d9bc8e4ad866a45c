"""A process that works for the live page, one question at a time, the newest one next.

A drag asks faster than a plan answers. Whoever waits when a newer question comes is told that it is
out of date; whoever is being answered is, too, once it has taken so long that starting the process
anew is cheaper than waiting for it.
"""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from importlib import import_module
from multiprocessing import get_context
from multiprocessing.connection import Connection
from multiprocessing.context import SpawnProcess
from multiprocessing.synchronize import Event
from typing import Any, Final

from experiments.explore.live.thing import Thing
from experiments.io.gave_out import what_gave_out
from experiments.io.one_line import one_line
from experiments.io.workers import begin_worker
from icage.errors import InputError

PATIENCE: Final = 4.0
"""[s] After which a question in hand gives way to a newer one: a few times what a process takes to
start."""

_LOOK: Final = 0.2
"""[s] Between two looks at whether anything else has changed while a process is at work."""

Stopped = Callable[[], bool]
"""Whether somebody wants what there is, now."""


class OutOfDateError(Exception):
    """A newer question has taken the place of this one."""


class OverError(Exception):
    """The server ends, or an answer took longer than it may."""


@dataclass(slots=True)
class _Job:
    """A question, and what came of it: the text of the answer or an error."""

    kind: str
    question: dict[str, Any]
    done: threading.Event = field(default_factory=threading.Event)
    text: str = ""
    error: Exception | None = None
    given_up: bool = False

    def end(self, text: str = "", error: Exception | None = None) -> None:
        """Whoever waits goes on."""
        self.text, self.error = text, error
        self.done.set()


class Lane:
    """One process and the thread that speaks to it; it starts with the first question.

    Parameters
    ----------
    module:
        Whose ``worker(thing)`` makes, in that process, ``answer(kind, question, stopped)``, which
        returns the text of a JSON document.
    thing:
        The object that all questions are about.
    """

    def __init__(self, module: str, thing: Thing) -> None:
        self._module, self._thing = module, thing
        self._news = threading.Condition()
        self._waiting: _Job | None = None
        self._over = False
        self._process: SpawnProcess | None = None
        self._speak: Connection | None = None
        self._hold: Connection | None = None
        self._stop: Event | None = None
        self._keeper = threading.Thread(target=self._keep, daemon=True)
        self._keeper.start()

    def ask(self, kind: str, question: dict[str, Any], seconds: float) -> str:
        """The text of the answer, [s] ``seconds`` from now at the latest.

        Raises
        ------
        OutOfDateError:
            A newer question came.
        InputError:
            The question has no answer; says why.
        OverError:
            The server ends, or it took too long.
        """
        job = _Job(kind, question)
        with self._news:
            if self._over:
                raise OverError("the server is about to end")
            if self._waiting is not None:
                self._waiting.end(error=OutOfDateError())
            self._waiting = job
            self._news.notify()
        if not job.done.wait(seconds):
            job.given_up = True
            raise OverError(f"no answer within {seconds:g} s")
        if job.error is not None:
            raise job.error
        return job.text

    def warm(self, question: dict[str, Any]) -> None:
        """Start the process before it is asked anything else."""
        threading.Thread(target=self._warm, args=(question,), daemon=True).start()

    def _warm(self, question: dict[str, Any]) -> None:
        with suppress(OutOfDateError, InputError, OverError):
            self.ask("warm", question, 60.0)

    def stop(self) -> None:
        """Who is at work shall answer with what there is."""
        stop = self._stop
        if stop is not None:
            stop.set()

    def close(self) -> None:
        """End the process, and everyone who waits."""
        with self._news:
            self._over = True
            if self._waiting is not None:
                self._waiting.end(error=OverError("the server is about to end"))
                self._waiting = None
            self._news.notify()
        self._keeper.join(5.0)

    def _keep(self) -> None:
        """The thread: processes are started here, for one lives no longer than its thread."""
        while True:
            with self._news:
                while self._waiting is None and not self._over:
                    self._news.wait()
                job, self._waiting = self._waiting, None
            if job is None:
                self._end_process()
                return
            try:
                job.end(self._answered(job))
            except Exception as error:  # whatever it is, whoever asked must not wait for ever
                job.end(error=error)

    def _answered(self, job: _Job) -> str:
        speak = self._started()
        if self._stop is not None:
            self._stop.clear()
        try:
            speak.send((job.kind, job.question))
            begun = time.monotonic()
            while not speak.poll(_LOOK):
                self._give_up_if_late(job, time.monotonic() - begun)
            good, text = speak.recv()
        except (EOFError, OSError) as error:
            self._end_process()
            raise InputError(
                "the process that worked on this ended, as where memory is short"
            ) from (error)
        if not good:
            raise InputError(text)
        return text

    def _give_up_if_late(self, job: _Job, taken: float) -> None:
        if self._over:
            self._end_process()
            raise OverError("the server is about to end")
        if job.given_up or (self._waiting is not None and taken > PATIENCE):
            self._end_process()
            raise OutOfDateError

    def _started(self) -> Connection:
        if self._process is not None and self._process.is_alive() and self._speak is not None:
            return self._speak
        self._end_process()
        spawn = get_context("spawn")  # a fork would take locks along that nobody opens
        self._speak, heard = spawn.Pipe()
        watched, self._hold = spawn.Pipe(duplex=False)
        self._stop = spawn.Event()
        self._process = spawn.Process(
            target=_work,
            args=(heard, watched, os.getpid(), self._module, self._thing, self._stop),
            daemon=True,
        )
        self._process.start()
        heard.close()
        watched.close()
        return self._speak

    def _end_process(self) -> None:
        for end in (self._hold, self._speak):
            if end is not None:
                end.close()
        self._hold = self._speak = None
        if self._process is not None:
            self._process.kill()
            self._process.join(5.0)
            self._process = None


def _work(
    heard: Connection, watched: Connection, parent: int, module: str, thing: Thing, stop: Event
) -> None:
    """The process: answers until nobody is there to ask."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for who started us
    begin_worker(watched, parent)
    worker = import_module(module).worker(thing)
    while True:
        try:
            kind, question = heard.recv()
        except (EOFError, OSError):
            return
        heard.send(_told(worker, kind, question, stop.is_set))


def _told(worker: Any, kind: str, question: dict[str, Any], stopped: Stopped) -> tuple[bool, str]:
    """The answer, or one line that says why there is none."""
    try:
        return True, worker.answer(kind, question, stopped)
    except InputError as error:
        return False, one_line(str(error))
    except Exception as error:
        reason = what_gave_out(error) or f"internal: {type(error).__name__}: {error} (our fault)"
        return False, one_line(reason)
