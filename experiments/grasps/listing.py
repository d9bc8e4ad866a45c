"""The list that ``icage grasps`` prints, and what it says of what is not on the list."""

from __future__ import annotations

import sys
from argparse import Namespace

from experiments.cases.asked import size_words
from experiments.cases.free_gap import free_gap
from experiments.grasps.wanted_by_options import limit_words
from icage.case import Case
from icage.grasps.planned import PlannedGrasps


def tell(planned: PlannedGrasps, args: Namespace) -> None:
    """What was not looked at or came to nothing, on standard error."""
    lines: list[str] = []
    if planned.ended is not None:
        after = f" after {args.seconds:g} s" if planned.ended == "out of time" else ""
        lines.append(f"the search was {planned.ended}{after}: the best of what it had")
    if planned.triples_left_out:
        lines.append(f"{planned.triples_left_out} triples of contacts were not drawn, at random")
    if planned.searches_broken_off:
        lines.append(f"{planned.searches_broken_off} searches were too large and broken off")
    if planned.unplanned:
        lines.append(
            f"{planned.unplanned} candidates that might be among the best were not planned and "
            "ranked: there were too many"
        )
    if planned.failures:
        lines.append(
            f"candidates that are no grasps of these fingers: {len(planned.failures)} "
            f"({planned.reason_words()})"
        )
    for line in lines:
        print(f"icage: {line}", file=sys.stderr)


def print_list(case: Case, planned: PlannedGrasps, args: Namespace) -> None:
    """The object, the hands that were looked at, and a line a grasp, on standard output."""
    cages = planned.cages[: args.top]
    print(
        f"{case.name}: {len(case.outline)} vertices, {_fingers(case.finger_radius, case.unit)}, "
        f"{len(cages)} grasps, ranked by {_ranked(args)} / sigma_0"
    )
    print(f"size {size_words(case)}")
    if args.phi is None or args.within is not None:
        print(f"hands {limit_words(case, args)}")
    print(
        f"{'score':>8} {'first/0':>8} {'max/0':>8} {'sigma_0':>10} {'free gap':>9} {'alike':>5}  "
        f"{'phi [deg]':<17} contacts"
    )
    for cage, score, alike in zip(cages, planned.scores, planned.alike, strict=False):
        first = _ratio(cage.sigma_first, cage.sigma_0)
        top = _ratio(cage.sigma_max, cage.sigma_0)
        phi = "({:.2f}, {:.2f})".format(*cage.hand.phi_deg)
        points = "  ".join(f"({x:.6g}, {y:.6g})" for x, y in cage.contacts)
        print(
            f"{score:8.4f} {first:>8} {top:>8} {cage.sigma_0:10.6g} "
            f"{free_gap(cage):9.4g} {alike:5d}  {phi:<17} {points}"
            f"{'' if cage.wedge is None else '  (a wedge: see icage plan --exact-fit)'}"
        )


def _ranked(args: Namespace) -> str:
    if args.aim == "friction":
        return f"sigma_first at friction {args.mu:g}"
    if args.aim == "place":
        return "tolerance of the best placement"
    return "sigma_max" if args.aim == "cage" else "sigma_first"


def _fingers(radius: float, unit: str) -> str:
    return f"disc fingers of radius {radius:g} {unit}" if radius > 0.0 else "point fingers"


def _ratio(level: float | None, sigma_0: float) -> str:
    return "never" if level is None else f"{level / sigma_0:.4f}"
