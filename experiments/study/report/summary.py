"""What a study found: counts, rates with intervals, what each input does, what matters most."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from typing import Any, Final

import numpy as np

from experiments.io.arrow_table import Table
from experiments.io.intervals import wilson
from experiments.io.outcome_words import NOT_CLOSED
from experiments.study.inputs.config import StudyConfig
from experiments.study.inputs.design import Design
from experiments.study.report.indices import sobol, split
from experiments.study.report.names import percent
from experiments.study.run.rows import target_trials
from experiments.study.run.shard import STUDY_OUTCOMES
from icage.arrays import BoolArray, FloatArray
from icage.cells.membership import VERDICTS

BINS: Final = 10
"""Of a variable that is not on a grid, with as many trials each as any other."""

_STREAM: Final = 15
"""Of the random numbers of bootstrap intervals."""

_ENDS: Final = ("target", "other_grasp", "escaped")
"""Outcomes that are counted per verdict of the planner."""

LISTED: Final = 50
"""Failed closings named in ``study.json``; the table has all."""


NEAR_POSITION: Final = 0.02
"""[diameter] An end this near the target is near it, ..."""

NEAR_ANGLE: Final = 0.1
"""[rad] ... if it is turned no further: what is lost of a grasp by friction is often no more."""


def summary(config: StudyConfig, design: Design, table: Table, diameter: float) -> dict[str, Any]:
    """The findings, as they stand in ``study.json``; ``diameter`` of the planned object, [unit]."""
    reached = target_trials(table)
    outcomes = np.array(table["outcome"].to_pylist())
    count = len(reached)
    closed = ~np.isin(outcomes, list(NOT_CLOSED))
    alone = independent(design, count)
    near = closed & _near(table, diameter)
    failed = np.flatnonzero(closed & ~reached)
    found: dict[str, Any] = {
        "trials": count,
        "outcomes": {name: int((outcomes == name).sum()) for name in STUDY_OUTCOMES},
        "closed": int(closed.sum()),
        **_rates(reached[alone], closed[alone]),
        "near_target": {
            "position": NEAR_POSITION,
            "angle": NEAR_ANGLE,
            "trials": int(near.sum()),
            "independent": int(near[alone].sum()),
        },
        "grasps": _grasps(table, outcomes),
        "verdicts": list(_verdicts(table, outcomes, closed)),
        "position_error_max": _of(table, "position_error", reached, np.max),
        "angle_error_max": _of(table, "angle_error", reached, np.max),
        "peak_force_median": _of(table, "peak_force", closed, np.median),
        "peak_force_max": _of(table, "peak_force", closed, np.max),
        "penetration_max": _of(table, "penetration_max", closed, np.max),
        "penetration_rest_max": _of(table, "penetration_rest", closed, np.max),
        "steps_mean": _of(table, "steps", closed, np.mean),
        "failed": len(failed),
        "failed_trials": table["trial"].to_numpy()[failed[:LISTED]].tolist(),
        "variables": {
            name: _variable(config, name, table[name].to_numpy()[alone], reached[alone],
                            closed[alone], near[alone])
            for name in design.names
        },
    }  # fmt: skip
    if config.sampling == "saltelli":
        found["indices"] = _indices(design, reached)
    return found


def _near(table: Table, diameter: float) -> BoolArray:
    """(n,) whether a trial ended near the target, whatever its outcome is called."""
    off, turned = (
        np.asarray(table[name].to_numpy(zero_copy_only=False), dtype=np.float64)
        for name in ("position_error", "angle_error")
    )
    with np.errstate(invalid="ignore"):  # null where nothing was closed
        return (off <= NEAR_POSITION * diameter) & (turned <= NEAR_ANGLE)


def _rates(reached: BoolArray, closed: BoolArray) -> dict[str, Any]:
    """Rates of the target with their intervals, of independent trials (n)."""
    trials, shut, target = len(reached), int(closed.sum()), int(reached.sum())
    return {
        "independent": {"trials": trials, "closed": shut, "target": target},
        "target_rate": target / trials if trials else None,
        "target_rate_95": list(wilson(target, trials)) if trials else None,
        "target_rate_of_closed": target / shut if shut else None,
        "target_rate_of_closed_95": list(wilson(target, shut)) if shut else None,
    }


def independent(design: Design, count: int) -> BoolArray:
    """Which of the first ``count`` trials share no input with another: rows A and B of Saltelli's
    design, all trials of any other. Only they give a rate, and its interval.
    """
    if not design.groups:
        return np.ones(count, dtype=np.bool_)
    return np.arange(count) % (len(design.groups) + 2) < 2


def _grasps(table: Table, outcomes: Any) -> dict[str, int]:
    """Trials per grasp of the plan, for those that ended in another one."""
    ids = table["grasp_id"].to_numpy()[outcomes == "other_grasp"]
    return {str(k): int((ids == k).sum()) for k in np.unique(ids).tolist()}


def _verdicts(table: Table, outcomes: Any, closed: BoolArray) -> Iterator[dict[str, Any]]:
    """What the planner said of the planned hand at the starts, and what became of the true one."""
    verdict = np.array(table["verdict"].to_pylist())
    caged = table["in_cage"].to_numpy(zero_copy_only=False)
    for name in VERDICTS:
        for in_cage in (True, False):
            here = (verdict == name) & (caged == in_cage)
            if here.any():
                yield {
                    "verdict": name,
                    "in_cage": in_cage,
                    "trials": int(here.sum()),
                    "closed": int(closed[here].sum()),
                    **{word: int((outcomes[here] == word).sum()) for word in _ENDS},
                }


def _of(table: Table, name: str, rows: BoolArray, how: Any) -> float | None:
    values = np.asarray(table[name].to_numpy(zero_copy_only=False), dtype=np.float64)[rows]
    values = values[np.isfinite(values)]
    return float(how(values)) if len(values) else None


def _variable(
    config: StudyConfig, name: str, values: FloatArray, reached: BoolArray, closed: BoolArray,
    near: BoolArray,
) -> dict[str, Any]:  # fmt: skip
    """Rate of the target over the values (n,) of one variable: per grid value, else per decile."""
    if config.vary[name].kind == "grid":
        groups = [values == v for v in sorted(set(config.vary[name].parameters))]
    else:
        rank = np.empty(len(values), dtype=np.int64)
        rank[np.argsort(values, kind="stable")] = np.arange(len(values))
        groups = [rank * BINS // max(len(values), 1) == k for k in range(BINS)]
    return {"bins": [_bin(values[g], reached[g], closed[g], near[g]) for g in groups if g.any()]}


def _bin(
    values: FloatArray, reached: BoolArray, closed: BoolArray, near: BoolArray
) -> dict[str, Any]:
    shut, target = int(closed.sum()), int(reached.sum())
    return {
        "low": float(values.min()),
        "high": float(values.max()),
        "mean": float(values.mean()),
        "trials": len(values),
        "closed": shut,
        "target": target,
        "near_target": int(near.sum()),
        "rate_95": list(wilson(target, shut)) if shut else None,
    }


def _indices(design: Design, reached: BoolArray) -> dict[str, Any]:
    """Sobol indices of "ended in the target", per independent input and for placement as one."""
    names = [name for name, _ in design.groups]
    parts = split(reached.astype(np.float64), len(names))
    return asdict(sobol(*parts, names, np.random.default_rng([design.config.seed, _STREAM])))


def sentence(found: dict[str, Any], what: str) -> str:
    """The bottom line: of independent trials alone, as a rate is."""
    low, high = found["target_rate_95"]
    one = found["independent"]
    few = one["trials"] < found["trials"]
    kind, of = ("independent trials", f" (of {found['trials']} run)") if few else ("trials", "")
    return (
        f"{one['target']} of {one['trials']} {kind} of {what}{of} ended in the target grasp: "
        f"{percent(found['target_rate'])} (95 %: {percent(low)} to {percent(high)})"
    )
