"""What the loops over closings are compiled to: they count nothing and hold nobody up."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import Any

import numba
import numpy as np
import pytest

import sim
from sim.closing import approach, computed_step, look, near_edges, push_loop
from sim.world import hand_in_object
from sim.world.machine_loops import FILES, SOURCES, borrowing, inlined

ROOMS = (approach, computed_step, look, near_edges, push_loop, hand_in_object)


def loops() -> dict[str, Any]:
    """All compiled loops of closings, by name."""
    return {
        f"{room.__name__}.{name}": value
        for room in ROOMS
        for name, value in vars(room).items()
        if isinstance(value, numba.core.registry.CPUDispatcher)
    }


def test_all_loops_count_no_references_and_release_pythons_lock() -> None:
    found = loops()
    assert {"sim.closing.push_loop._close_on", "sim.closing.look._observe"} <= set(found)
    for name, loop in found.items():
        assert loop.targetoptions["nogil"], name
        assert not loop.targetoptions["_nrt"], name
        assert not loop.targetoptions.get("fastmath"), name


def test_all_files_with_loops_are_in_the_stamp_of_every_loop() -> None:
    """Or machine code would stay what it was after a change of what it is made of."""
    room = Path(sim.__file__).parent
    with_loops = {
        path.relative_to(room).as_posix()
        for path in room.glob("**/*.py")
        if "numba" in (text := path.read_text(encoding="utf-8")) or "machine_loops" in text
    }
    assert with_loops == set(FILES)
    for module in FILES:
        name = "sim." + module.removesuffix(".py").replace("/", ".")
        for loop in vars(import_module(name)).values():
            if isinstance(loop, numba.core.registry.CPUDispatcher):
                assert loop._cache._cache_file._source_stamp == SOURCES.digest


@pytest.mark.parametrize("how", [borrowing, inlined])
def test_such_a_loop_cannot_make_an_array(how: Any) -> None:
    """References to it would be counted by nobody: it does not compile."""

    def array(count):  # type: ignore[no-untyped-def]
        return np.zeros(count)

    with pytest.raises(numba.TypingError):
        how(array)(3)
