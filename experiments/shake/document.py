"""What ``icage shake`` found, as the document ``icage-shake/1`` and as lines to read."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

from experiments.io.versions import versions
from experiments.shake.run import PLAY_TOLERANCE, Shaken
from sim.grip.form_closure import CARRYING
from sim.grip.play import Play
from sim.grip.shake import HELD_SHIFT, HELD_TURN, PUSH


def shake_document(done: Shaken) -> dict[str, Any]:
    """Lengths in ``unit``, angles in [rad], forces in shares of the drive force."""
    case, cage, size = done.physical.case, done.physical.cage, done.physical.cage.outline.diameter
    closing = done.closings[0]
    lost = done.outcome == "diverged"
    return {
        "format": "icage-shake/1",
        "name": case.name,
        "unit": case.unit,
        "diameter": size,
        "finger_radius": case.finger_radius,
        "derived": done.physical.derived,
        "seed": done.seed,
        "versions": versions(),
        "config": asdict(done.scene.config),
        "contacts": cage.contacts,
        "sigma_0": cage.sigma_0,
        "held": done.held,
        "criterion": {"displacement": HELD_SHIFT * size, "rotation": HELD_TURN},
        "closing": {
            "start": closing.start.as_array(),
            "outcome": done.outcome,
            "end": None if lost else closing.end.as_array(),
            "steps": closing.steps,
            "position_error": None if lost else float(done.verdicts.position_error[0]) * size,
            "angle_error": None if lost else float(done.verdicts.angle_error[0]),
            "penetration_rest": None if lost else closing.penetration_rest * size,
        },
        "contact_types": done.supports.types,
        "concave_corners": done.supports.concave_corners,
        "form_closure": _closure(done),
        "shake": _shake(done, size),
        "play": [_play(play, size) for play in done.plays] if done.plays else None,
        "failures": done.failures,
    }


def _closure(done: Shaken) -> dict[str, Any] | None:
    if done.form_closure is None or done.touches is None:
        return None
    found = done.form_closure
    return {
        "closed": found.closed,
        "agrees_with_planner": found.agrees_with(done.supports),
        "rank": found.rank,
        "singular_values": found.singular_values,
        "least_multiplier": found.margin,
        "carrying": done.touches.carrying,
        "contacts": [
            {"finger": int(finger) + 1, "force": float(force)}
            for finger, force in zip(done.touches.finger, done.touches.forces, strict=True)
        ],
    }


def _shake(done: Shaken, size: float) -> dict[str, Any] | None:
    if done.shake is None:
        return None
    return {
        "pushes": [
            {
                "force": push.force,
                "torque": push.torque * size,
                "displacement": push.shift * size,
                "rotation": push.turn,
            }
            for push in done.shake.pushes
        ],
        "random": {
            "displacement": done.shake.random_shift * size,
            "rotation": done.shake.random_turn,
        },
        "penetration_max": done.shake.penetration * size,
        "diverged": done.shake.diverged,
    }


def _play(play: Play, size: float) -> dict[str, Any]:
    return {
        "delta": play.delta,
        "measured": play.measured,
        "law": play.law,
        "on_edges": play.on_edges,
        "on_lines": play.predicted,
        "penetration": play.penetration * size,
    }


def shake_summary(done: Shaken) -> Iterator[str]:
    """Lines for a reader."""
    case, cage = done.physical.case, done.physical.cage
    size = cage.outline.diameter
    derived = f", {done.physical.origin}" if done.physical.derived else ""
    yield (
        f"{case.name}: discs of radius {case.finger_radius:.6g} {case.unit}{derived}; "
        f"contacts {', '.join(kind.replace('_', ' ') for kind in done.supports.types)}"
    )
    closing = done.closings[0]
    yield (
        f"closing      from sigma {closing.start.sigma / cage.sigma_0:.6g} sigma_0: "
        f"{done.outcome.replace('_', ' ')} after {closing.steps} steps"
    )
    if done.form_closure is not None and done.touches is not None:
        kind = "first order (form closure)" if done.form_closure.closed else "second order only"
        same = "as" if done.form_closure.agrees_with(done.supports) else "NOT as"
        yield (
            f"held to      {kind}: {len(done.touches.finger)} contacts, "
            f"{done.touches.carrying} with force above {CARRYING:g} of the largest, wrenches of "
            f"rank {done.form_closure.rank}, {same} {done.supports.concave_corners} concave "
            "corners ask for"
        )
    if done.shake is not None:
        yield from _pushed(done, size)
    for play in done.plays:
        low, high = play.measured
        where = "" if play.on_edges else " (a finger has left its edge)"
        yield (
            f"play         {low:.5f}, {high:.5f} rad at sigma_0 (1 + {play.delta:g}); "
            f"acos(1 / (1 + {play.delta:g})) = {play.law:.5f}{where}"
        )
    if done.plays:
        yield f"             must agree within {PLAY_TOLERANCE:.0%} while on the edges"
    yield "held" if done.held else "NOT HELD"


def _pushed(done: Shaken, size: float) -> Iterator[str]:
    assert done.shake is not None
    unit = done.physical.case.unit
    for push in done.shake.pushes:
        name = (
            f"torque {push.torque:+.3g}"
            if push.torque
            else f"force {_degrees(push.force):3.0f} deg"
        )
        yield f"  {name:<15}{push.shift * size:9.2e} {unit}, {push.turn:9.2e} rad"
    yield (
        f"  {'random shake':<15}{done.shake.random_shift * size:9.2e} {unit}, "
        f"{done.shake.random_turn:9.2e} rad; deepest {done.shake.penetration * size:.2e} {unit}"
    )
    yield (
        f"             forces are {PUSH:g} of the drive; held: at most {HELD_SHIFT * size:.3g} "
        f"{unit} and {HELD_TURN:g} rad"
    )


def _degrees(force: tuple[float, float]) -> float:
    return math.degrees(math.atan2(force[1], force[0])) % 360.0
