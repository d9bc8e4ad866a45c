"""What ``icage escape`` answers: a document of format ``icage-escape/1`` and a table."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Final

from experiments.escape.run import AttackResult, Escape
from experiments.io.intervals import rate_upper
from sim.attack.held import Attacks
from sim.attack.measured_sigma_max import Measured

FORMAT: Final = "icage-escape/1"


def escape_document(result: Escape) -> dict[str, Any]:
    """Levels, intervals and depths in the case's unit; time step in [s]."""
    cage, unit = result.cage, result.case.outline.diameter
    config = None if result.setup is None else result.setup.scene.config
    return {
        "format": FORMAT,
        "case": result.case.name,
        "derived": result.physical.derived,
        "another_grasp": result.physical.another,
        "unit": result.case.unit,
        "diameter": unit,
        "finger_radius": result.case.finger_radius,
        "contacts": result.case.contacts,
        "verdict": result.verdict,
        "why": result.why,
        "failures": list(result.failures),
        "plan_verdict": cage.status,
        "sigma_0": cage.sigma_0,
        "sigma_max": cage.sigma_max,
        "sigma_max_upper": cage.sigma_max_upper,
        "sigma_largest": cage.sigma_largest,
        "level_below": result.below,
        "level_above": result.above,
        "seed": result.seed,
        "attackers": {a.attacker: _of_attacker(a, unit) for a in result.attackers},
        "penetration_max": result.penetration_max * unit,
        "friction": None if config is None else config.friction,
        "time_step": None if config is None else config.time_step,
        "solref": None if config is None else list(config.solref),
        "solimp": None if config is None else list(config.solimp),
    }


def _of_attacker(of_attacker: AttackResult, unit: float) -> dict[str, Any]:
    return {
        "below": _run(of_attacker.below, unit),
        "above": None if of_attacker.above is None else _run(of_attacker.above, unit),
        "measured": None if of_attacker.measured is None else _measured(of_attacker.measured, unit),
    }


def _run(run: Attacks, unit: float) -> dict[str, Any]:
    return {
        "attacks": len(run),
        "escapes": run.escapes,
        "diverged": run.diverged,
        "rate_upper_95": rate_upper(run.escapes, len(run)),
        "penetration_max": float(run.penetration_max.max()) * unit,
        "stop_overrun": max(float(run.rise_max.max()) - 1.0, 0.0),
        "steps_mean": float(run.steps.mean()),
    }


def _measured(found: Measured, unit: float) -> dict[str, Any]:
    return {
        "low": found.low * unit,
        "high": found.high * unit if math.isfinite(found.high) else None,
        "high_seen": found.seen * unit if math.isfinite(found.seen) else None,
        "attacks": found.attacks,
        "escapes": found.escaped,
        "held_below": found.held,
        "penetration_max": found.penetration_max * unit,
        "stop_overrun": max(found.rise_max - 1.0, 0.0),
    }


def escape_table(result: Escape) -> list[str]:
    """Lines to read: the plan, a row an attacker, settings, verdict."""
    cage, case, unit = result.cage, result.case, result.case.outline.diameter
    top = "never" if cage.sigma_max is None else f"{cage.sigma_max:.6g}"
    lines = [
        f"{case.name}: {len(case.outline)} vertices, diameter {unit:.6g} {case.unit}, fingers of "
        f"radius {case.finger_radius:.6g} {case.unit}, seed {result.seed}",
        f"planned: {cage.status}, sigma_0 {cage.sigma_0:.6g}, sigma_max {top}",
    ]
    if result.physical.derived:
        lines.append(result.physical.origin)
    if result.setup is not None:
        head = ("attacker", "below", "escaped", "rate <", "above", "escaped", "deepest", "overrun",
                "measured sigma_max", "off by", "seen")  # fmt: skip
        rows = [head, *(_row(result, a) for a in result.attackers)]
        widths = [max(len(row[k]) for row in rows) for k in range(len(head))]
        lines += [
            "  ".join(text.rjust(w) for text, w in zip(row, widths, strict=True)) for row in rows
        ]
        config = result.setup.scene.config
        above = "-" if result.above is None else f"{result.above:.6g}"
        lines.append(
            f"below {result.below:.6g}, above {above}; rate: under this at 95 % (exact one-sided "
            "bound, Clopper-Pearson); deepest: finger over the diameter; overrun: of the stop, "
            "over sigma; seen: least sigma that an escape had"
        )
        lines.append(
            f"time step {config.time_step:g} s, solref {_words(config.solref)}, solimp "
            f"{_words(config.solimp)}"
        )
    lines.append(f"{result.verdict}{'' if result.why is None else f': {result.why}'}")
    return lines


def _row(result: Escape, of_attacker: AttackResult) -> tuple[str, ...]:
    below, above, found = of_attacker.below, of_attacker.above, of_attacker.measured
    unit, top = result.case.outline.diameter, result.cage.sigma_max
    runs = [run for run in (below, above) if run is not None]
    interval, off, seen = "-", "-", "-"
    if found is not None and top is not None:
        interval = f"[{found.low * unit:.6g}, {found.high * unit:.6g}]"
        off = f"{100.0 * (found.low * unit / top - 1.0):+.3f} .. "
        off += f"{100.0 * (found.high * unit / top - 1.0):+.3f} %"
        seen = f"{100.0 * (found.seen * unit / top - 1.0):+.3f} %"
    return (
        of_attacker.attacker, str(len(below)), str(below.escapes),
        f"{100.0 * rate_upper(below.escapes, len(below)):.1f} %",
        *(("-", "-") if above is None else (str(len(above)), str(above.escapes))),
        f"{max(float(run.penetration_max.max()) for run in runs):.1e}",
        f"{max(max(float(run.rise_max.max()) - 1.0, 0.0) for run in runs):.1e}",
        interval, off, seen,
    )  # fmt: skip


def _words(values: Sequence[float]) -> str:
    return " ".join(f"{value:g}" for value in values)
