"""A row as plain numbers: what JSON, the tables and the baseline all read."""

from __future__ import annotations

import math
from typing import Any

from experiments.escape.run import AttackResult
from experiments.io.intervals import rate_upper
from experiments.jams.closings import Ends
from experiments.jams.document import ends_document
from experiments.regress.checks import checks
from experiments.regress.closings import Closed
from experiments.regress.measure import Row
from icage.cage import Cage
from sim.attack.held import Attacks


def row_document(row: Row) -> dict[str, Any]:
    """Levels in the case's unit, depths and errors in diameters; None where there is nothing."""
    return {
        "case": row.name,
        "seed": row.seed,
        "why_no_physics": row.why,
        "planner": _levels(row.planned.cells),
        "physical": None if row.physical is None else _physical(row),
        "closings": {closed.run.which: _closed(closed) for closed in row.closed},
        "attacks": _attacks(row),
        "shake": _shake(row),
        "second": _second(row),
        "friction": [_rubbed(row, ends) for ends in row.rubbed],
        "failures": list(checks(row)),
    }


def _rubbed(row: Row, ends: Ends) -> dict[str, Any]:
    assert row.physical is not None
    level = ends.level / row.physical.cage.sigma_0
    counts = ends_document(ends)
    kept = (
        "mu",
        "trials",
        "target",
        "near_level",
        "stray",
        "position_error",
        "angle_error",
        "penetration",
    )
    first = level if math.isfinite(level) else None
    return {"sigma_first": first, **{key: counts[key] for key in kept}}


def _levels(cage: Cage) -> dict[str, Any]:
    return {
        "verdict": cage.status,
        "sigma_0": cage.sigma_0,
        "sigma_first": cage.sigma_first,
        "sigma_max": cage.sigma_max,
        "grasps": len(cage.grasps),
    }


def _physical(row: Row) -> dict[str, Any]:
    assert row.physical is not None
    case = row.physical.case
    return {
        "origin": row.physical.origin,
        "unit": case.unit,
        "diameter": case.outline.diameter,
        "finger_radius": case.finger_radius,
        **_levels(row.physical.cage),
    }


def _closed(closed: Closed) -> dict[str, Any]:
    return {
        "trials": closed.trials,
        **closed.run.counts,
        "misnamed": closed.misnamed,
        "let_go": closed.let_go,
        "position_error": closed.position_error,
        "angle_error": closed.angle_error,
        "penetration": closed.penetration,
    }


def _attacks(row: Row) -> dict[str, Any] | None:
    if row.escape is None:
        return None
    done = row.escape
    config = None if done.setup is None else done.setup.scene.config
    return {
        "verdict": done.verdict,
        "why": done.why,
        "below": done.below,
        "above": done.above,
        "penetration": done.penetration_max,
        "time_step": None if config is None else config.time_step,
        "solref": None if config is None else list(config.solref),
        **{a.attacker: _of_attacker(a, row) for a in done.attackers},
    }


def _of_attacker(result: AttackResult, row: Row) -> dict[str, Any]:
    assert row.physical is not None
    found, unit = result.measured, row.physical.case.outline.diameter
    return {
        "below": _run(result.below),
        "above": None if result.above is None else _run(result.above),
        "measured": None
        if found is None
        else [found.low * unit, found.high * unit if math.isfinite(found.high) else None],
    }


def _run(run: Attacks) -> dict[str, Any]:
    return {
        "attacks": len(run),
        "escapes": run.escapes,
        "diverged": run.diverged,
        "rate_upper_95": rate_upper(run.escapes, len(run)),
        "penetration": float(run.penetration_max.max()),
    }


def _shake(row: Row) -> dict[str, Any] | None:
    done = row.shaken
    if done is None:
        return None
    closure = done.form_closure
    return {
        "contact_types": list(done.supports.types),
        "outcome": done.outcome,
        "held": done.held,
        "rank": None if closure is None else closure.rank,
        "form_closure": None if closure is None else closure.closed,
        "play_over_law": [
            max(abs(turn) for turn in play.measured) / play.law
            for play in done.plays
            if play.on_edges
        ],
    }


def _second(row: Row) -> dict[str, Any] | None:
    if row.second is None:
        return None
    attacks = row.second.attacks
    return {
        "closings": {closed.run.which: _closed(closed) for closed in row.second.closed},
        "random_below": None if attacks is None else _run(attacks),
    }
