"""``python -m icage.compile_kernels``: machine code for everything that is asked often.

Small problems through the front door, so that every kernel is compiled for the very types of
arguments that it meets there. In the order in which a session is likely to need them; after each
the list of what is ready is written. [docs/decisions/0009-cold-start.md]
"""

from __future__ import annotations

import os
import signal
import sys
from contextlib import suppress

import numpy as np

import icage
from icage.cells.membership import query
from icage.grasps.of_one_hand import grasps_of_hand
from icage.hand import HandShape
from icage.kernels import background
from icage.kernels.compiled import machine_code_at_once, with_machine_code
from icage.sampling import draw_starts
from models import CASES


def main(options: list[str]) -> int:
    """Compile what is not compiled; with an option for other processes, one at a time."""
    lock = background.take_lock()
    if options:
        signal.alarm(background.SECONDS)
        if lock is None:
            return 0
    if "--behind" in options:  # nobody waits for it
        os.nice(5)
    machine_code_at_once()
    for job in (
        _plan,
        _plan_discs,
        _queries,
        _regions,
        _contact_space,
        _grasps,
        _one_hand,
        _sublevels,
    ):
        # what cannot be compiled here fails again where it is needed, and is heard of there
        with suppress(Exception):
            job()
        background.write_list(with_machine_code(), complete=False)
    background.write_list(with_machine_code(), complete=True)
    return 0


def _plan() -> None:
    icage.plan(_case("T_best"))


def _plan_discs() -> None:
    icage.plan(_case("disc_Y"))


def _regions() -> None:
    for name in ("T_best", "disc_Y"):
        cage = icage.plan(_case(name))
        cage.regions("sigma_first")
        draw_starts(cage, "guaranteed", 20, np.random.default_rng(0))


def _queries() -> None:
    for name in ("T_best", "disc_Y"):
        cage = icage.plan(_case(name))
        rows = cage.target_placement.as_array() * np.linspace(1.0, 2.0, 50)[:, None]
        query(cage, rows).grasps_of(0)


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


def _case(name: str) -> icage.Case:
    return icage.load(CASES / f"{name}.json")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
