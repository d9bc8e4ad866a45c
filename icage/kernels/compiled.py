"""The one decorator behind every compiled function: interpreted first, machine code when it pays.

A kernel is plain Python and gives the same digits either way, so the first answers need no
compiler: a small plan is done in less time than numba takes to be imported. A process interprets
its kernels for ``PATIENCE`` seconds. After that, or at once for large arguments, it goes over to
machine code that is on disk, or comes there while another process is at work on it
(``background``). After ``COMPILE_PATIENCE`` it compiles itself what no other process has in hand
(``claims``). A call that takes too long is given up in the midst and made again: kernels write
nothing but what they return (and tables that remain true).
``NUMBA_DISABLE_JIT=1`` never compiles. [docs/decisions/0009-cold-start.md]
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from functools import cached_property, update_wrapper
from time import perf_counter
from typing import Any, Final, TypeVar, cast

import numpy as np

from icage.kernels import background, claims
from icage.kernels.compiling import announce
from icage.kernels.digest import kernel_sources

Function = TypeVar("Function", bound=Callable[..., Any])

PATIENCE: Final = 0.3
"""[s] That a process interprets before it goes over to machine code that is there: as long as it
takes to load numba."""

COMPILE_PATIENCE: Final = 10.0
"""[s] ... before it compiles what is not there, or waits for who does: half as long as that takes,
for a plan."""

LARGE: Final = 1500
"""Numbers in the arguments of a call for which machine code that is there is taken at once: a plan
for disc fingers, or for more than about a hundred vertices."""

HUGE: Final = 100_000
"""Numbers for which a call is not interpreted at all."""

_LOOK_EVERY: Final = 32
"""Inner calls of an interpreted kernel between two looks at the clock."""

_NEXT_LOOK: Final = 0.1
"""[s] Between two looks for the machine code that another process makes."""

kernel_sources()  # taken now, when the kernels are imported: of the sources that this process runs


class _GoesOver(BaseException):
    """Ends an interpreted call that machine code is to repeat; never leaves this file."""


class _Thread(threading.local):
    """Where one thread stands in its interpreted call."""

    name: str = ""
    """The kernel that was called from outside; empty between calls."""
    calls: int = 0
    started: float = 0.0
    look_at: float = 0.0


class _Process:
    """What this process has decided."""

    spent: float = 0.0
    """[s] Interpreting so far."""
    at_once: bool = False
    patient: bool = True
    """Whether it waits for a kernel that another process is compiling."""
    never: bool = background.PLAIN


_thread = _Thread()
_process = _Process()
_kernels: list[Kernel] = []
"""All kernels that were imported."""


class Kernel:
    """A function on arrays that runs as plain Python or as machine code."""

    def __init__(self, function: Callable[..., Any], *, borrows: bool = False) -> None:
        update_wrapper(self, function)
        self.plain = function
        self.borrows = borrows
        self.name = f"{function.__module__}.{function.__qualname__}"
        self.machine: Callable[..., Any] | None = None
        """Machine code, once this process has gone over."""

    def __call__(self, *args: Any) -> Any:
        """The function of these arguments, by position."""
        machine = self.machine
        if machine is not None:
            return machine(*args)
        if not _thread.name:
            return _from_outside(self, args)
        _thread.calls += 1
        if not _thread.calls % _LOOK_EVERY:
            _look()
        return self.plain(*args)

    def __reduce__(self) -> str:
        return self.plain.__qualname__

    @cached_property
    def dispatcher(self) -> Any:
        """The function as numba has it, to be called from Python."""
        from icage.kernels.machine import dispatcher_of  # only now: loads numba

        return dispatcher_of(self.plain, self.borrows)

    @cached_property
    def _numba_type_(self) -> Any:
        """By this numba knows what the name of a kernel means inside another kernel."""
        from icage.kernels.machine import inner_dispatcher_of

        if "dispatcher" in self.__dict__:  # met before: not compiled twice
            return self.dispatcher._numba_type_
        return inner_dispatcher_of(self.plain, self.borrows)._numba_type_


def compiled(function: Function) -> Function:
    """Compile without fast-math (results must not depend on it), once it pays."""
    kernel = Kernel(function)
    _kernels.append(kernel)
    return cast(Function, kernel)


def compiled_borrowing(function: Function) -> Function:
    """The same for a kernel that makes no array and returns none: it borrows those it is given.

    Machine code otherwise counts who uses an array, at every call, in steps that no two threads can
    take at once: a third of the time of a search, and two threads on one object were in each
    other's way.
    """
    kernel = Kernel(function, borrows=True)
    _kernels.append(kernel)
    return cast(Function, kernel)


def with_machine_code() -> list[str]:
    """Names of the kernels that have gone over in this process."""
    return [kernel.name for kernel in _kernels if kernel.machine is not None]


def machine_code_at_once(*, patient: bool = True) -> None:
    """From now on no kernel is interpreted: for what measures, or is known to be long.

    A kernel that another process is compiling is waited for, or ``claims.Busy`` is raised.
    """
    _process.at_once, _process.patient = True, patient


def long_job() -> None:
    """Nothing is interpreted from now on, and what is not there yet is compiled by two processes.

    For commands that call their kernels often, in other processes too.
    """
    background.start(awaited=True)
    machine_code_at_once()


def _from_outside(kernel: Kernel, args: tuple[Any, ...]) -> Any:
    if _process.never:
        with np.errstate(over="ignore"):  # the hash of a key wraps round
            return _interpreted(kernel, args, np.inf)
    left = PATIENCE - _process.spent
    if _process.at_once:
        return _by_machine(kernel, args)
    background.start()
    if left <= 0.0:
        if _goes_over(kernel.name, _process.spent):
            return _by_machine(kernel, args)
        left = _NEXT_LOOK
    elif (size := _size(args)) > LARGE and (size > HUGE or background.is_ready(kernel.name)):
        return _by_machine(kernel, args)
    try:
        # where Python's numbers and machine code part (a division by zero), machine code decides
        with np.errstate(over="ignore", under="ignore", divide="raise", invalid="raise"):
            return _interpreted(kernel, args, left)
    except (_GoesOver, ArithmeticError):
        pass
    return _by_machine(kernel, args)


def _interpreted(kernel: Kernel, args: tuple[Any, ...], seconds: float) -> Any:
    _thread.name, _thread.started = kernel.name, perf_counter()
    _thread.look_at = _thread.started + seconds
    try:
        return kernel.plain(*args)
    finally:
        _thread.name = ""
        _process.spent += perf_counter() - _thread.started


def _look() -> None:
    """Give the call up if machine code is there, or will not come from elsewhere."""
    now = perf_counter()
    if now < _thread.look_at:
        return
    if _goes_over(_thread.name, _process.spent + now - _thread.started):
        raise _GoesOver
    _thread.look_at = now + _NEXT_LOOK


def _goes_over(name: str, spent: float) -> bool:
    """Whether to take machine code, after so many seconds, even if it has to be compiled here."""
    if background.is_ready(name):
        return True
    if background.at_work():
        announce()
    return spent > COMPILE_PATIENCE


def _by_machine(kernel: Kernel, args: tuple[Any, ...]) -> Any:
    """Go over, for this call and all that follow."""
    with claims.alone_with(kernel.name, patient=_process.patient):
        machine = cast("Callable[..., Any]", kernel.dispatcher)
        answer = machine(*args)
    kernel.machine = machine
    background.add(kernel.name)
    return answer


def _size(args: tuple[Any, ...]) -> int:
    """Numbers in the arrays among the arguments, also inside named tuples."""
    total = 0
    for value in args:
        if isinstance(value, np.ndarray):
            total += value.size
        elif isinstance(value, tuple):
            total += _size(cast("tuple[Any, ...]", value))
    return total
