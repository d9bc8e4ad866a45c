"""The command line: ``icage COMMAND ...``. Its exit codes are a promise.

0: the question was answered. 2: bad input, wrong options, a place that takes no answer, or a
machine or library that gave out: one line on standard error, nothing written. 1: a check that ran
and failed, nobody reads standard output, or our fault. 130: interrupted. 143: asked to end by
SIGTERM (129: by SIGHUP, a terminal that closed), which is an interrupt like any other: what is done
is kept, nothing half written is left.
"""

from __future__ import annotations

import argparse
import atexit
import gc
import os
import pkgutil
import signal
import sys
from collections.abc import Generator, Sequence
from contextlib import contextmanager, redirect_stderr, redirect_stdout, suppress
from importlib import import_module
from io import TextIOWrapper, UnsupportedOperation
from typing import Any, Final, NoReturn, TextIO, cast

import experiments.commands
import icage
from experiments.io.ends import Asked, asked_to_end
from experiments.io.gave_out import what_gave_out
from experiments.io.one_line import PrintableStream, one_line
from experiments.io.warnings_kept import keep_warnings
from icage.errors import InputError
from icage.kernels.background import abandon
from icage.kernels.compiling import when_compiling

_SIGNALS: Final = 128
"""Exit codes from here on name the signal that ended the command."""


class Parser(argparse.ArgumentParser):
    """argparse whose mistakes are input errors like any other, without abbreviations."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        kwargs.setdefault("allow_abbrev", False)
        super().__init__(*args, **kwargs)

    def error(self, message: str) -> NoReturn:
        """Raise what argparse would print."""
        raise InputError(f"{message} (see {self.prog} --help)")


def parser() -> Parser:
    """The parser of all commands in ``experiments.commands``."""
    top = Parser(
        prog="icage",
        description="How far may a three-finger hand open before the object inside can escape?",
        epilog="A shipped object's name (pliers, saw, wrench), or that of one of its grasps "
        "(pliers/1_best), may stand wherever a CASE does. Exit codes: 0 answered, 1 a check failed "
        "or our fault, 2 bad input, 130 interrupted, 143 ended by SIGTERM: what is done is kept.",
    )
    top.add_argument("--version", action="version", version=f"icage {icage.__version__}")
    commands = top.add_subparsers(dest="command", metavar="COMMAND", required=True)
    for module in pkgutil.iter_modules(experiments.commands.__path__):
        command = import_module(f"experiments.commands.{module.name}")
        command.add_parser(commands)
        commands.choices[module.name.replace("_", "-")].set_defaults(run=command.run)
    return top


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code."""
    _collect_seldom()
    keep_warnings()
    heard = _open_streams()
    with asked_to_end() as asked, _guarded_streams():
        code = _run(arguments, asked)
    if code >= _SIGNALS:
        abandon()  # who compiled behind this command ends, too
    return code if heard else code or 1


def _run(arguments: Sequence[str] | None, asked: Asked) -> int:
    """The exit code, whatever happens."""
    try:
        args = parser().parse_args(arguments)
        when_compiling(_say_compiling)
        code: int = args.run(args)
        sys.stdout.flush()
        return asked.code or code
    except InputError as error:
        _say(str(error))
        return 2
    except KeyboardInterrupt:
        return _interrupted(asked)
    except BrokenPipeError:
        _forget_output()
        return 1
    except Exception as error:
        if isinstance(error, SystemError) and _is_interrupt(error):
            return _interrupted(asked)
        gave_out = what_gave_out(error)
        if gave_out:
            _say(gave_out)
            _forget_output()
            return 2
        if asked.number or asked.interrupted:  # libraries make other errors of it in their import
            return _interrupted(asked)
        if os.environ.get("ICAGE_DEBUG"):
            raise
        reason = f"{type(error).__name__}: {error}"
        _say(f"internal: {reason} (our fault; ICAGE_DEBUG=1 shows where)")
        return 1


def _collect_seldom() -> None:
    """Look for garbage in circles seldom, and not at the end: a third of the time of a short plan.

    What is imported is a million objects that stay; arrays are freed without being looked for.
    """
    gc.set_threshold(50_000, 20, 100)
    atexit.register(gc.freeze)


def _open_streams() -> bool:
    """Standard streams that take any text; a closed one leads nowhere, false if that is stdout."""
    heard = sys.stdout is not None
    if not heard:
        sys.stdout = _nowhere()
    if sys.stderr is None:  # else what is printed there would appear on standard output
        sys.stderr = _nowhere()
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    return heard


@contextmanager
def _guarded_streams() -> Generator[None]:
    """Whatever a name or a path holds, nothing reaches a terminal that it would obey."""
    out, err = PrintableStream(sys.stdout), PrintableStream(sys.stderr)
    with redirect_stdout(cast(TextIO, out)), redirect_stderr(cast(TextIO, err)):
        yield


def _nowhere() -> TextIO:
    return os.fdopen(os.open(os.devnull, os.O_WRONLY), "w")


def _forget_output() -> None:
    """Keep the interpreter from complaining, as it ends, about what standard output holds back."""
    with suppress(UnsupportedOperation):  # a stream that is no file holds nothing back
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _is_interrupt(error: BaseException | None) -> bool:
    """Whether an interrupt is behind it: inside a compiled function it becomes a SystemError."""
    while error is not None and not isinstance(error, KeyboardInterrupt):
        error = error.__cause__ or error.__context__
    return error is not None


def _interrupted(asked: Asked) -> int:
    # An interrupt that met text being run, as some libraries do in their import, is remembered by
    # Python, which then ends by SIGINT whatever we return; running any text makes it forget.
    exec("0")
    _say("terminated" if asked.number else "interrupted")
    return asked.code or 128 + signal.SIGINT


def _say_compiling() -> None:
    """For whoever sits before it; a log or a script is not told what is no result."""
    if sys.stderr.isatty():
        line = "icage: compiling the planner, once per installation, about a minute"
        print(line, file=sys.stderr, flush=True)


def _say(message: str) -> None:
    """One line on standard error, whatever the message holds."""
    print(f"icage: error: {one_line(message)}", file=sys.stderr, flush=True)


if __name__ == "__main__":
    sys.exit(main())
