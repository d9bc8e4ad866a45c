"""Which grasps the options of ``icage grasps`` ask for, and the same in words."""

from __future__ import annotations

from argparse import Namespace
from math import degrees, inf, radians

from icage.case import Case
from icage.errors import InputError
from icage.grasps.wanted import LEAST_ANGLE, LEAST_GAP, HandLimits, Wanted, as_stretches
from icage.hand import HandShape

_LIMITS = (
    "least_angle", "least_gap", "sigma_min_of_hand", "sigma_max_of_hand", "tolerance", "seconds",
)  # fmt: skip


def wanted_of(args: Namespace) -> Wanted:
    """What the options ask for."""
    near = None
    if args.phi is not None:
        HandShape.from_angles_deg(*args.phi)  # says what is wrong with the angles
        near = (radians(args.phi[0]), radians(args.phi[1]), radians(args.within))
    limits = HandLimits(
        least_angle=LEAST_ANGLE if args.least_angle is None else radians(args.least_angle),
        least_gap=args.least_gap,
        sigma_least=args.sigma_min_of_hand or 0.0,
        sigma_most=inf if args.sigma_max_of_hand is None else args.sigma_max_of_hand,
    )
    return Wanted(
        args.aim,
        args.corners,
        near,
        limits,
        as_stretches(args.avoid),
        args.tolerance or 0.0,
        args.mu,
    )


def refuse_limits(args: Namespace) -> None:
    """All grasps of one hand are listed: limits would be asked of nothing."""
    given = [name for name in _LIMITS if getattr(args, name) is not None]
    if args.avoid:
        given.append("avoid")
    if given:
        option = given[0].replace("_", "-")
        raise InputError(
            f"--{option} limits a search, and --phi without --within lists all grasps of one hand; "
            "leave one of them out"
        )


def limit_words(case: Case, args: Namespace) -> str:
    """Which hands were looked at, and how to ask for others."""
    unit = f" {case.unit}"
    gap = LEAST_GAP * case.outline.diameter if args.least_gap is None else args.least_gap
    words = [f"with a free gap of {gap:.4g}{unit} and more between fingers (--least-gap)"]
    if args.phi is None:
        angle = degrees(LEAST_ANGLE) if args.least_angle is None else args.least_angle
        words.insert(0, f"with angles of {angle:g} degrees and more (--least-angle)")
    if args.sigma_min_of_hand is not None:
        words.append(f"that close to {args.sigma_min_of_hand:g}{unit}")
    if args.sigma_max_of_hand is not None:
        words.append(f"that open to {args.sigma_max_of_hand:g}{unit}")
    if args.avoid:
        plural = "es" if len(args.avoid) > 1 else ""
        words.append(f"that touch nothing on {len(args.avoid)} stretch{plural} of the outline")
    return ", ".join(words)
