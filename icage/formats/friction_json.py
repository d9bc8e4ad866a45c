"""What friction leaves of a cage, as keys of ``icage-plan/1`` and as lines to read."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import degrees
from typing import Any

from icage.cage import Cage
from icage.friction.ends import JamEnds
from icage.friction.jam import Jam, JamTolerance
from icage.friction.levels import FrictionLevel


def friction_document(found: Sequence[FrictionLevel], tolerance: JamTolerance) -> dict[str, Any]:
    """The keys ``friction`` and ``tolerance``; lengths in the cage's unit."""
    return {
        "friction": [
            {
                "mu": level.mu,
                "sigma_first": level.sigma_first,
                "jam": None if level.jam is None else _jam(level.jam),
                "ends": _ends(level.ends),
            }
            for level in found
        ],
        "tolerance": {"position": tolerance.position, "angle_deg": degrees(tolerance.angle)},
    }


def _ends(ends: JamEnds | None) -> dict[str, float] | None:
    """In the units of ``tolerance``: diameters and degrees."""
    if ends is None:
        return None
    return {"position_max": ends.position_max, "angle_max_deg": degrees(ends.angle_max)}


def _jam(jam: Jam) -> dict[str, Any]:
    at = jam.placement
    return {
        "fingers": jam.fingers,
        "contacts": jam.contacts,
        "placement": {"x": at.x, "y": at.y, "theta": at.theta, "sigma": at.sigma},
        "sigma": jam.sigma,
    }


def friction_summary(
    cage: Cage, found: Sequence[FrictionLevel], tolerance: JamTolerance
) -> Iterator[str]:
    """Lines for a reader."""
    if cage.status == "not_a_cage":
        return
    yield (
        f"friction     closing ends within {tolerance.position:g} diameters and "
        f"{degrees(tolerance.angle):.4g} deg of the target"
    )
    for level in found:
        if level.sigma_first is None:
            until = "however far the hand opens"
        else:
            until = (
                f"below {level.sigma_first:.9g} ({level.sigma_first / cage.sigma_0:.6g} sigma_0)"
            )
        limit = "" if level.jam is None else f": fingers {_list(level.jam.fingers)} jam there"
        ends = level.ends
        stops = ""
        if level.mu and ends is not None:
            stops = (
                f"; stops at most {ends.position_max:.4g} diameters, "
                f"{degrees(ends.angle_max):.4g} deg off"
            )
        yield f"  mu {level.mu:<9g} {until}{limit}{stops}"


def _list(fingers: tuple[int, ...]) -> str:
    names = [str(finger) for finger in fingers]
    return f"{', '.join(names[:-1])} and {names[-1]}"
