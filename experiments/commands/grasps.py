"""``icage grasps OUTLINE-OR-CASE``: good target grasps of an object, or all of one hand."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from experiments.io.options import (
    UNITS,
    add_json,
    check_output,
    count,
    file_name,
    not_negative,
    number,
    positive,
)
from experiments.io.options import seed as seed_option

if TYPE_CHECKING:
    from icage.cage import Cage
    from icage.formats.case_json import Object
    from icage.grasps.search import Aim
    from icage.planned_grasps import PlannedGrasps

_WORKERS = 2


def add_parser(subparsers: Any) -> None:
    """Options of the command."""
    parser = subparsers.add_parser(
        "grasps",
        help="the best target grasps of an object",
        description="Search the three-finger immobilizing grasps of an object for those with the "
        "largest cages, or list all immobilizing grasps of one given hand (--phi).",
    )
    parser.add_argument(
        "object",
        metavar="OUTLINE-OR-CASE",
        type=file_name,
        help="drawing, case file, or a shipped object's name",
    )
    parser.add_argument("--finger-radius", type=not_negative, help="radius of disc fingers")
    parser.add_argument("--width", type=positive, help="longer side of a drawing, in UNIT")
    parser.add_argument("--unit", choices=UNITS, help="unit of a drawing's width (m)")
    parser.add_argument(
        "--phi", type=number, nargs=2, metavar=("P1", "P2"), help="shape of the hand, degrees"
    )
    parser.add_argument("--top", type=count, default=10, help="how many to list (10)")
    parser.add_argument(
        "--aim",
        choices=("first", "cage"),
        default="first",
        help="rank by sigma_first / sigma_0 (first) or by sigma_max / sigma_0 (cage)",
    )
    parser.add_argument(
        "--within",
        type=positive,
        metavar="DEG",
        help="with --phi: search hands within DEG of that shape, read from any finger",
    )
    parser.add_argument(
        "--corners",
        type=int,
        choices=range(4),
        default=0,
        help="least number of fingers in concave corners (0)",
    )
    parser.add_argument("--seed", type=seed_option, default=0, help="of the random moves (0)")
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Search, plan the winners, list them."""
    from experiments.cases.named import find_object
    from icage.errors import InputError
    from icage.formats.json_out import write_json

    thing = find_object(args.object, args.width, args.unit)
    check_output("--json", args.json, *thing.sources)
    radius = thing.finger_radius if args.finger_radius is None else args.finger_radius
    if radius > thing.outline.diameter:
        raise InputError(
            f"--finger-radius {radius:g}: the object's diameter is {thing.outline.diameter:g}"
        )
    if args.within is not None and args.phi is None:
        raise InputError("--within needs --phi")
    if args.phi is not None and args.within is None:
        planned, left_out = _of_one_hand(thing, radius, args.phi, args.aim), {}
    else:
        planned, left_out = _best(thing, radius, args)
    cages = planned.cages[: args.top]
    _tell(planned, left_out)
    document = {
        "format": "icage-grasps/1",
        "name": thing.name,
        "unit": thing.unit,
        "finger_radius": radius,
        "aim": args.aim,
        "grasps": [_entry(cage, args.aim) for cage in cages],
        "failed": [{"contacts": f.contacts, "why": f.why} for f in planned.failures],
        **left_out,
    }
    if args.json is not None:
        write_json(document, args.json)
    if args.json != "-":
        _print(thing, radius, cages, args.aim)
    return 0


def _best(
    thing: Object, radius: float, args: argparse.Namespace
) -> tuple[PlannedGrasps, dict[str, int]]:
    """The best grasps of any hand, and how much the search has left out."""
    import os
    from math import radians

    import numpy as np

    from experiments.io.progress import stage_bar
    from icage.grasps.search import Wanted, ranked_grasps
    from icage.hand import HandShape
    from icage.planned_grasps import planned_grasps

    near = None
    if args.phi is not None:
        HandShape.from_angles_deg(*args.phi)  # says what is wrong with the angles
        near = (radians(args.phi[0]), radians(args.phi[1]), radians(args.within))

    with stage_bar() as progress:
        found = ranked_grasps(
            thing.outline,
            finger_radius=radius,
            wanted=Wanted(args.aim, args.corners, near),
            rng=np.random.default_rng(args.seed),
            workers=min(_WORKERS, os.cpu_count() or 1),
            progress=progress,
        )
    contacts = (candidate.contacts for candidate in found.candidates)
    planned = planned_grasps(thing.outline, radius, contacts, args.aim, args.top)
    left_out = {"triples_left_out": found.triples_left_out, "searches_broken_off": found.broken_off}
    return planned, left_out


def _of_one_hand(thing: Object, radius: float, phi: list[float], aim: Aim) -> PlannedGrasps:
    from icage.discs.offsets import offsets
    from icage.grasps.of_one_hand import grasps_of_hand
    from icage.hand import HandShape
    from icage.planned_grasps import planned_grasps_of_hand

    hand = HandShape.from_angles_deg(phi[0], phi[1])
    grown = offsets(thing.outline, radius, 8).inner if radius > 0.0 else thing.outline
    found = grasps_of_hand(grown, hand)
    return planned_grasps_of_hand(thing.outline, radius, hand, found, aim)


def _tell(planned: PlannedGrasps, left_out: dict[str, int]) -> None:
    """What was not looked at or came to nothing, on standard error."""
    import sys

    lines: list[str] = []
    if left_out.get("triples_left_out"):
        lines.append(
            f"{left_out['triples_left_out']} triples of contacts were not drawn, at random"
        )
    if left_out.get("searches_broken_off"):
        lines.append(f"{left_out['searches_broken_off']} searches were too large and broken off")
    if planned.failures:
        reasons = "; ".join(f"{count} {why}" for why, count in planned.reasons())
        lines.append(
            f"candidates that are no grasps of these fingers: {len(planned.failures)} ({reasons})"
        )
    for line in lines:
        print(f"icage: {line}", file=sys.stderr)


def _entry(cage: Cage, aim: Aim) -> dict[str, Any]:
    from icage.planned_grasps import score

    return {
        "contacts": cage.contacts,
        "phi_deg": cage.hand.phi_deg,
        "sigma_0": cage.sigma_0,
        "sigma_first": cage.sigma_first,
        "sigma_max": cage.sigma_max,
        "score": score(cage, aim),
        "verdict": cage.verdict,
        "free_fingers": cage.grasps[0].free_fingers,
        "escape_free_fingers": cage.punctures[-1].free_fingers if cage.sigma_max else None,
    }


def _print(thing: Object, radius: float, cages: Sequence[Cage], aim: Aim) -> None:
    from icage.planned_grasps import score

    print(
        f"{thing.name}: {len(thing.outline)} vertices, finger radius {radius:g} {thing.unit}, "
        f"{len(cages)} grasps, ranked by sigma_{'max' if aim == 'cage' else 'first'} / sigma_0"
    )
    print(f"{'score':>8} {'first/0':>8} {'max/0':>8} {'sigma_0':>10}  phi [deg]         contacts")
    for cage in cages:
        first = _ratio(cage.sigma_first, cage.sigma_0)
        top = _ratio(cage.sigma_max, cage.sigma_0)
        phi = "({:.2f}, {:.2f})".format(*cage.hand.phi_deg)
        points = "  ".join(f"({x:.6g}, {y:.6g})" for x, y in cage.contacts)
        print(
            f"{score(cage, aim):8.4f} {first:>8} {top:>8} {cage.sigma_0:10.6g}  {phi:<17} {points}"
        )


def _ratio(level: float | None, sigma_0: float) -> str:
    return "never" if level is None else f"{level / sigma_0:.4f}"
