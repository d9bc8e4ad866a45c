"""``python -m icage.compile_kernels``: machine code for everything that is asked often.

Small problems through the front door, so that every kernel is compiled for the very types of
arguments that it meets there. In the order in which a session is likely to need them; after each
the list of what is ready is written. [docs/decisions/0009-cold-start.md]
"""

from __future__ import annotations

import gc
import os
import signal
import sys
from collections import deque
from contextlib import suppress
from time import sleep
from typing import Final

import numpy as np

import icage
from icage.cells.free_space import FreeSpace
from icage.cells.membership import query
from icage.cells.target import contacts_as_configuration, is_local_minimum, plateau_through
from icage.discs.offsets import offsets
from icage.grasps.of_one_hand import grasps_of_hand
from icage.hand import HandShape
from icage.kernels import background, claims
from icage.kernels.compiled import machine_code_at_once, with_machine_code
from icage.sampling import draw_starts
from models import CASES

_LOOK: Final = 0.1
"""[s] Between two looks for a kernel that another process has in hand."""


def main(options: list[str]) -> int:
    """Compile what is not compiled; with an option for other processes, one at a time."""
    lock = background.take_lock()
    if options:
        signal.alarm(background.SECONDS)
        background.follow()
        if lock is None:
            return 0
    if "--behind" in options:  # nobody waits for it
        os.nice(5)
    gc.set_threshold(50_000, 20, 100)  # a compiler leaves little garbage: a tenth of the time
    machine_code_at_once(patient=False)
    jobs = deque([_plan, _plan_discs, _queries, _starts, _regions])
    jobs += [_other_minima, _contact_space, _grasps, _one_hand, _sublevels, _friction, _place]
    waiting = 0
    while jobs:
        job = jobs.popleft()
        try:
            # what cannot be compiled here fails again where it is needed, and is heard of there
            with suppress(Exception):
                job()
        except claims.Busy:  # somebody has that kernel in hand: another job meanwhile
            jobs.append(job)
            waiting += 1
            if waiting >= len(jobs):
                sleep(_LOOK)
            continue
        waiting = 0
        background.write_list(with_machine_code(), complete=False)
    background.write_list(with_machine_code(), complete=True)
    return 0


def _plan() -> None:
    icage.plan(_case("T_best"))


def _plan_discs() -> None:
    case = _case("disc_Y")
    icage.plan(case)
    offsets(case.outline, case.finger_radius, 4)  # where no true curve is found


def _starts() -> None:
    for name in ("T_best", "disc_Y"):
        draw_starts(icage.plan(_case(name)), "guaranteed", 20, np.random.default_rng(0))


def _regions() -> None:
    for name in ("T_best", "disc_Y"):
        icage.plan(_case(name)).regions("sigma_first")


def _queries() -> None:
    for name in ("T_best", "disc_Y"):
        cage = icage.plan(_case(name))
        rows = cage.target_placement.as_array() * np.linspace(1.0, 2.0, 50)[:, None]
        query(cage, rows).grasps_of(0)


def _other_minima() -> None:
    """What a plan asks where there are several minima, or a shallow one."""
    cage = icage.plan(_case("T_best"))
    free_space = FreeSpace.around(cage.outline, cage.hand)
    here = contacts_as_configuration(free_space, cage.contacts)
    is_local_minimum(free_space, here, cage.sigma_0)
    plateau_through(free_space, here, cage.sigma_0)


def _contact_space() -> None:
    for name in ("T_best", "disc_Y"):
        icage.plan(_case(name), method="contact-space")


def _grasps() -> None:
    _case("T_best").grasps(top=1)


def _one_hand() -> None:
    case = _case("T_best")
    grasps_of_hand(case.outline, HandShape.from_contacts(case.contacts))


def _sublevels() -> None:
    case = _case("T_best")
    icage.sublevels(case.outline, case.hand)


def _friction() -> None:
    icage.plan(_case("T_best")).friction(0.3)
    icage.plan(_case("disc_Y")).friction(0.3)


def _place() -> None:
    icage.place(icage.plan(_case("T_best")), opening_error=True)


def _case(name: str) -> icage.Case:
    return icage.load(CASES / f"{name}.json")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
