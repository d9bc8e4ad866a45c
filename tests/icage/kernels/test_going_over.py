"""A kernel is interpreted first, then goes over to machine code: the answer is the same."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, cast

import numpy as np
import pytest

from icage.cells.kernels.tree import births
from icage.kernels import compiled as module
from icage.kernels.compiled import PATIENCE, Kernel, compiled


@compiled
def halved(x: float) -> float:
    """A kernel that others call."""
    return 0.5 * x


@compiled
def summed(values: np.ndarray) -> float:
    """Calls another kernel once a number."""
    total = 0.0
    for value in values:
        total += halved(value)
    return total


@compiled
def inverse(values: np.ndarray) -> float:
    """Divides by the first number."""
    return 1.0 / values[0]


VALUES = np.arange(200.0)


class Others:
    """The other process, as a test wants it."""

    def __init__(self, at_work: bool, ready: bool) -> None:
        self.working, self.finished, self.looks = at_work, ready, 0
        self.added: list[str] = []
        self.alone: list[str] = []

    def start(self) -> None:
        pass

    def add(self, name: str) -> None:
        self.added.append(name)

    def at_work(self) -> bool:
        self.looks += 1
        return self.working

    def is_ready(self, name: str) -> bool:
        assert name.endswith(("summed", "inverse"))
        return self.finished

    @contextmanager
    def alone_with(self, name: str, *, patient: bool) -> Iterator[None]:
        assert patient
        self.alone.append(name)
        yield


@pytest.fixture
def fresh(monkeypatch: pytest.MonkeyPatch) -> Callable[..., Others]:
    """A process that has not interpreted anything yet, beside another one."""

    def make(*, at_work: bool = False, ready: bool = False) -> Others:
        others = Others(at_work, ready)
        process = module._Process()
        process.never = False
        monkeypatch.setattr(module, "background", others)
        monkeypatch.setattr(module, "claims", others)
        monkeypatch.setattr(module, "_process", process)
        for kernel in (summed, inverse):
            monkeypatch.setattr(kernel, "machine", None)
            monkeypatch.setattr(kernel, "dispatcher", Seen(cast(Kernel, kernel)), raising=False)
        return others

    return make


class Seen:
    """Machine code that counts its calls."""

    def __init__(self, kernel: Kernel) -> None:
        self.kernel, self.calls = kernel, 0

    def __call__(self, *args: Any) -> Any:
        self.calls += 1
        return module.Kernel(self.kernel.plain).dispatcher(*args)


def machine_calls(kernel: Any) -> int:
    return cast(Seen, kernel.dispatcher).calls


def test_a_short_call_is_interpreted(fresh: Callable[..., Others]) -> None:
    fresh(ready=True)
    assert summed(VALUES) == 9950.0
    assert machine_calls(summed) == 0
    assert module._process.spent > 0.0


def test_a_call_beyond_patience_is_made_again(
    fresh: Callable[..., Others], monkeypatch: pytest.MonkeyPatch
) -> None:
    """In the midst of it, at an inner call: machine code repeats it from its start."""
    fresh(ready=True)
    monkeypatch.setattr(module, "PATIENCE", 1e-9)
    assert summed(VALUES) == 9950.0
    assert machine_calls(summed) == 1
    assert module._thread.name == ""
    assert summed(VALUES) == 9950.0
    assert machine_calls(summed) == 2


def test_what_another_process_compiles_is_not_compiled_here(
    fresh: Callable[..., Others], monkeypatch: pytest.MonkeyPatch
) -> None:
    others = fresh(at_work=True)
    monkeypatch.setattr(module, "PATIENCE", 1e-9)
    monkeypatch.setattr(module, "_NEXT_LOOK", 1e-9)
    assert summed(VALUES) == 9950.0
    assert machine_calls(summed) == 0
    assert others.looks > 1
    others.finished = True
    assert summed(VALUES) == 9950.0
    assert machine_calls(summed) == 1


def test_it_is_compiled_here_if_nobody_else_does(
    fresh: Callable[..., Others], monkeypatch: pytest.MonkeyPatch
) -> None:
    others = fresh()
    monkeypatch.setattr(module, "PATIENCE", 1e-9)
    monkeypatch.setattr(module, "_NEXT_LOOK", 1e-9)
    assert summed(VALUES) == 9950.0
    assert machine_calls(summed) == 0  # which takes longer than to load it, and more patience
    monkeypatch.setattr(module, "COMPILE_PATIENCE", 1e-9)
    assert summed(VALUES) == 9950.0
    assert machine_calls(summed) == 1
    assert others.added == [summed.name]  # type: ignore[attr-defined]


def test_a_long_call_waits_in_the_end(
    fresh: Callable[..., Others], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Or what interprets on all cores would starve what compiles for it."""
    others = fresh(at_work=True)
    module._process.spent = module.COMPILE_PATIENCE + 1.0
    assert summed(VALUES) == 9950.0
    assert others.alone == [summed.name]  # type: ignore[attr-defined]
    assert machine_calls(summed) == 1


def test_large_arguments_take_machine_code_that_is_there(fresh: Callable[..., Others]) -> None:
    others = fresh(at_work=True)
    large = np.ones(module.LARGE + 1)
    assert summed(large) == 0.5 * len(large)
    assert machine_calls(summed) == 0  # not there yet
    others.finished = True
    assert summed(large) == 0.5 * len(large)
    assert machine_calls(summed) == 1


def test_huge_arguments_are_not_interpreted(fresh: Callable[..., Others]) -> None:
    others = fresh(at_work=True)
    assert summed(np.ones(module.HUGE + 1)) == 0.5 * (module.HUGE + 1)
    assert machine_calls(summed) == 1
    assert others.alone == [summed.name]  # type: ignore[attr-defined]  # it was waited for


def test_patience_is_that_of_the_whole_process(fresh: Callable[..., Others]) -> None:
    fresh(ready=True)
    module._process.spent = PATIENCE
    assert summed(VALUES) == 9950.0
    assert machine_calls(summed) == 1


def test_machine_code_decides_what_python_would_do_otherwise(fresh: Callable[..., Others]) -> None:
    """numpy divides by zero with a warning; machine code raises, and so does the kernel."""
    fresh()
    with pytest.raises(ZeroDivisionError):
        inverse(np.zeros(1))
    assert machine_calls(inverse) == 1
    assert inverse(np.array([4.0])) == 0.25


def test_the_size_of_a_call_counts_named_tuples() -> None:
    assert module._size((1.0, np.ones((3, 2)), (np.ones(4), (np.ones(1), 2)))) == 11


def test_a_kernel_is_known_by_its_name() -> None:
    assert pickle.loads(pickle.dumps(births)) is births
    assert births.__doc__ is not None
    assert births.__name__ == "births"
