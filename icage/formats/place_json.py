"""The best placement as the document ``icage-place/1``, and as lines to read."""

from __future__ import annotations

from collections.abc import Iterator
from math import degrees
from typing import Any

from icage.placing.best import BestPlacement


def place_document(best: BestPlacement) -> dict[str, Any]:
    """The document; lengths in the case's unit, turns in degrees."""
    at, bears = best.placement, best.turn_and_shift
    curve = bears.curve()
    return {
        "format": "icage-place/1",
        "placement": {"x": at.x, "y": at.y, "theta": at.theta, "sigma": at.sigma},
        "fingers": best.fingers,
        "tolerance": best.tolerance,
        "tolerance_upper": best.tolerance_upper,
        "tolerance_box": {"shift": bears.shift, "turn_deg": degrees(bears.turn)},
        "tolerance_curve": {
            "pivot": bears.pivot,
            "turn_deg": [degrees(turn) for turn in curve[:, 0].tolist()],
            "shift": curve[:, 1],
        },
        "clearance": best.clearance,
        "limited_by": best.limited_by,
        "level": best.level,
        "mu": best.mu,
        "opening": best.opening,
        "opening_error": best.opening_error,
    }


def place_summary(best: BestPlacement, name: str, unit: str) -> Iterator[str]:
    """Lines for a reader."""
    at, bears = best.placement, best.turn_and_shift
    friction = f", friction up to {best.mu:g}" if best.mu else ""
    yield f"{name}: the open hand stands best{friction}"
    yield (
        f"placement    x {at.x:.6g}, y {at.y:.6g} {unit}, theta {degrees(at.theta):.6g} deg, "
        f"sigma {at.sigma:.6g} {unit}"
    )
    for finger, (x, y) in enumerate(best.fingers.tolist(), 1):
        yield f"  finger {finger}   {x:.6g}, {y:.6g}"
    whatever = "its opening too" if best.opening_error else "as a rigid hand"
    yield (
        f"tolerance    every finger may be off by {best.tolerance:.6g} {unit}, {whatever} (none "
        f"has more than {best.tolerance_upper:.6g})"
    )
    yield (
        f"limited by   {best.limited_by}: clearance {best.clearance:.6g} {unit}, level "
        f"{'none' if best.level is None else f'{best.level:.9g} {unit}'}"
    )
    yield (
        f"as a whole   {bears.shift:.6g} {unit} of shift without a turn, {degrees(bears.turn):.5g} "
        "deg of turn without a shift"
    )
