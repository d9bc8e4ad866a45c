"""The best grasps of an object that came without one: searched, told of, kept as case files."""

from __future__ import annotations

import argparse
import os
import shlex
import sys
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from experiments.cases.asked import size_words
from experiments.cases.reading import reading_of, reading_words
from experiments.io.progress import search_bar
from icage.cage import Cage
from icage.case import Case
from icage.errors import InputError
from icage.formats.case_json import grasp_name

if TYPE_CHECKING:
    from icage.grasps.planned import PlannedGrasps
    from icage.grasps.wanted import Wanted

SEARCHED: Final = 10
"""Grasps that are planned before the best is taken: as many as ``icage grasps`` lists."""

WORKERS: Final = 2


@dataclass(frozen=True, slots=True)
class Chosen:
    """The cases to work on.

    Attributes
    ----------
    cases:
        The case that was named, or the object with each of its best grasps.
    made_by:
        The command that finds the same grasps; None for a case that came with its grasp.
    """

    cases: tuple[Case, ...]
    made_by: str | None = None


def chosen(case: Case, args: argparse.Namespace, count: int = 1) -> Chosen:
    """A case with a grasp as it is; else its ``count`` best grasps, said on standard error.

    ``args`` are those that named the case. The same grasps as ``icage grasps`` lists first.

    Raises
    ------
    GraspError:
        The object has no immobilizing three-finger grasp.
    """
    if case.target is not None:
        return Chosen((case,))
    from icage.grasps.wanted import Wanted

    check_radius(case)
    found = best_grasps_of(
        case, max(SEARCHED, count), Wanted("first", tolerance=args.tolerance or 0.0)
    )
    cages = found.cages[:count]
    if not cages:
        raise InputError(f"{case.name}: none of {found.compared} grasps compared is a cage")
    print(
        f"icage: {case.name} ({size_words(case)}) has no grasp yet: taken "
        f"{'is the best' if len(cages) == 1 else f'are the best {len(cages)}'} of "
        f"{found.compared} grasps compared",
        file=sys.stderr,
    )
    for number, cage in enumerate(cages, 1):
        print(f"icage: grasp {number}: {_levels(cage, case.unit)}", file=sys.stderr, flush=True)
    return Chosen(cases_from(case, cages), search_command(case, args, args.case))


def best_grasps_of(
    case: Case,
    top: int,
    wanted: Wanted,
    seed: int = 0,
    workers: int | None = None,
    seconds: float | None = None,
) -> PlannedGrasps:
    """``icage.grasps.of_case.best_of_case`` under a bar, on the machine's cores unless told."""
    from icage.grasps.of_case import best_of_case  # only now: the search is a planner of its own
    from icage.kernels.compiled import long_job

    long_job()
    rng, threads = np.random.default_rng(seed), workers or min(WORKERS, os.cpu_count() or 1)
    with search_bar() as bar:
        return best_of_case(case, top, wanted, rng, threads, bar, seconds)


def check_radius(case: Case) -> None:
    """Fingers larger than the object are a mistake of units.

    Raises
    ------
    InputError:
        The finger radius is larger than the object's diameter.
    """
    if case.finger_radius > case.outline.diameter:
        raise InputError(
            f"the finger radius of {case.name} is {case.finger_radius:g}; up to the object's "
            f"diameter, {case.outline.diameter:g}, is allowed"
        )


def cases_from(case: Case, cages: tuple[Cage, ...]) -> tuple[Case, ...]:
    """The object with each of these grasps, numbered from 1."""
    return tuple(
        replace(
            case, name=grasp_name(case.name, k), finger_radius=cage.finger_radius,
            target=cage.contacts,
        )
        for k, cage in enumerate(cages, 1)
    )  # fmt: skip


def search_command(case: Case, args: argparse.Namespace, source: str) -> str:
    """``icage grasps`` for the same object and fingers."""
    words = ["icage", "grasps", source]
    words += reading_words(reading_of(args))
    if case.finger_radius > 0.0:
        words += ["--finger-radius", f"{case.finger_radius!r}"]
    return shlex.join(words)


def say_how_to_keep(found: Chosen) -> None:
    """For commands that write no folder: how to get the grasp as a case file."""
    if found.made_by is not None:
        line = f"icage: `{found.made_by} --cases DIR` keeps it as a case, DIR/1.json"
        print(line, file=sys.stderr, flush=True)


def _levels(cage: Cage, unit: str) -> str:
    from icage.grasps.scores import score
    from icage.grasps.wanted import Wanted

    first, top = (
        "never" if level is None else f"{level:.6g}" for level in (cage.sigma_first, cage.sigma_max)
    )
    return (
        f"score {score(cage, Wanted()):.4f}, sigma_0 {cage.sigma_0:.6g}, sigma_first {first}, "
        f"sigma_max {top} {unit}"
    )
