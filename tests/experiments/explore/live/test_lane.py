"""One process, the newest question next: nobody waits for ever, whatever becomes of the process."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable, Iterator

import numpy as np
import pytest

from experiments.explore.live import lane as lanes
from experiments.explore.live.lane import Lane, OutOfDateError, OverError
from experiments.explore.live.thing import Thing
from icage.errors import InputError

THING = Thing("x", "m", np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]))


@pytest.fixture
def lane() -> Iterator[Lane]:
    made = Lane("tests.experiments.explore.live.made_up_worker", THING)
    yield made
    made.close()


class Asking(threading.Thread):
    """A question on a thread of its own, and what came of it."""

    def __init__(self, ask: Callable[[], str]) -> None:
        super().__init__()
        self.ask, self.found = ask, None
        self.start()

    def run(self) -> None:
        try:
            self.found = self.ask()
        except Exception as error:
            self.found = error


def until(true: Callable[[], bool]) -> None:
    for _ in range(2000):
        if true():
            return
        time.sleep(0.01)
    raise AssertionError("never true")


def alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


def test_of_questions_that_wait_only_the_newest_is_answered(lane: Lane) -> None:
    first = Asking(lambda: lane.ask("wait", {"seconds": 1.0}, 30.0))
    until(lambda: lane._process is not None and lane._waiting is None)
    second = Asking(lambda: lane.ask("wait", {}, 30.0))
    until(lambda: lane._waiting is not None)
    third = Asking(lambda: lane.ask("wait", {}, 30.0))
    for one in (first, second, third):
        one.join(30.0)
    assert isinstance(second.found, OutOfDateError)
    assert first.found == third.found  # the same process


def test_who_takes_long_gives_way(lane: Lane, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lanes, "PATIENCE", 0.3)
    before = lane.ask("wait", {}, 30.0)
    first = Asking(lambda: lane.ask("wait", {"seconds": 60.0}, 90.0))
    until(lambda: lane._waiting is None)
    time.sleep(0.1)
    assert lane.ask("wait", {}, 30.0) != before
    first.join(30.0)
    assert isinstance(first.found, OutOfDateError)
    assert not alive(int(before))


def test_refusals_and_faults_are_one_line_and_the_process_goes_on(lane: Lane) -> None:
    before = lane.ask("wait", {}, 30.0)
    with pytest.raises(InputError, match="^not this$"):
        lane.ask("refuse", {}, 30.0)
    with pytest.raises(InputError, match="our fault"):
        lane.ask("fail", {}, 30.0)
    assert lane.ask("wait", {}, 30.0) == before


def test_a_process_that_dies_is_replaced(lane: Lane) -> None:
    before = lane.ask("wait", {}, 30.0)
    with pytest.raises(InputError, match="ended"):
        lane.ask("die", {}, 30.0)
    assert lane.ask("wait", {}, 30.0) != before


def test_what_there_is_can_be_asked_for(lane: Lane) -> None:
    waits = Asking(lambda: lane.ask("interrupt", {}, 30.0))
    until(lambda: lane._process is not None and lane._waiting is None)
    while waits.is_alive():
        lane.stop()
        waits.join(0.05)
    assert waits.found == "stopped"


def test_an_answer_that_takes_too_long_is_not_waited_for(lane: Lane) -> None:
    before = int(lane.ask("wait", {}, 30.0))
    with pytest.raises(OverError, match=r"0\.3 s"):
        lane.ask("wait", {"seconds": 60.0}, 0.3)
    until(lambda: not alive(before))  # nor worked on any more
    assert lane.ask("wait", {}, 30.0) != str(before)


def test_the_end_ends_whoever_works_and_waits() -> None:
    lane = Lane("tests.experiments.explore.live.made_up_worker", THING)
    before = int(lane.ask("wait", {}, 30.0))
    waits = Asking(lambda: lane.ask("wait", {"seconds": 60.0}, 90.0))
    until(lambda: lane._waiting is None)
    lane.close()
    waits.join(10.0)
    assert isinstance(waits.found, OverError | OutOfDateError)
    assert not alive(before)
    with pytest.raises(OverError):
        lane.ask("wait", {}, 1.0)
