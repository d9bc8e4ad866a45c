"""A signal that asks to end is heard wherever it comes."""

from __future__ import annotations

import os
import signal
import sys
import time
import weakref

import pytest

from experiments.io.ends import asked_to_end


class Thing:
    pass


def end_in_a_callback(number: int) -> None:
    """The signal comes while Python runs what can raise nothing."""

    def gone(_: object) -> None:
        os.kill(os.getpid(), number)
        for _ in range(1000):  # the handler runs here
            pass

    thing = Thing()
    kept = weakref.ref(thing, gone)
    del thing
    assert kept() is None
    time.sleep(10.0)  # ... and is heard here


@pytest.mark.skipif(sys.platform == "win32", reason="signals between processes")
@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGHUP"])
def test_a_signal_in_a_callback_is_not_lost(name: str) -> None:
    number = getattr(signal, name)
    hook = sys.unraisablehook
    for _ in range(3):
        with pytest.raises(KeyboardInterrupt), asked_to_end() as asked:
            end_in_a_callback(number)
        assert asked.interrupted == (name == "SIGINT")
        assert asked.code == (0 if name == "SIGINT" else 128 + number)
    assert sys.unraisablehook is hook


def test_other_faults_in_a_callback_are_told_as_ever(monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[object] = []
    monkeypatch.setattr(sys, "unraisablehook", lambda one: told.append(one.exc_type))

    def gone(_: object) -> None:
        raise ZeroDivisionError

    with asked_to_end() as asked:
        thing = Thing()
        kept = weakref.ref(thing, gone)
        del thing
        assert kept() is None
    assert told == [ZeroDivisionError]
    assert asked.code == 0
