"""A trial of a study that was run again: its document and its lines."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from experiments.study.run.one_trial_again import StudyRerun, outcome_words

_POSE = ("x", "y", "theta", "sigma")


def document(done: StudyRerun) -> dict[str, Any]:
    """The document ``icage-replay-trial/1``; lengths in ``unit``, angles in [rad]."""
    names = ("outcome", "grasp_id", "steps", "position_error", "angle_error", "peak_force")
    return {
        "format": "icage-replay-trial/1",
        "index": done.index,
        "grasp": done.study.case.name,
        "set": "study",
        "trial": done.index,
        "seed": done.study.config.seed,
        "unit": done.study.case.unit,
        "start": [done.now[f"start_{name}"] for name in _POSE],
        "verdict": done.now["verdict"],
        "recorded": done.recorded,
        **{name: done.now[name] for name in names},
        "end": None if done.now["end_x"] is None else [done.now[f"end_{n}"] for n in _POSE],
        "penetration_max": done.now["penetration_max"],
        "penetration_rest": done.now["penetration_rest"],
        "identical": not done.differences,
        "differences": [
            {"what": what, "recorded": was, "now": now} for what, was, now in done.differences
        ],
        "versions_differ": {
            name: {"recorded": was, "here": here}
            for name, (was, here) in done.other_versions.items()
        },
    }


def summary(done: StudyRerun) -> Iterator[str]:
    """Lines for a reader."""
    study, now, unit = done.study, done.now, done.study.case.unit
    yield f"{study.case.name}, study, trial {done.index}, seed {study.config.seed}"
    for name in study.design.names:
        yield f"{name:<12} {now[name]:.9g}"
    yield f"start        {_pose(now, 'start', unit)}"
    yield f"verdict      {now['verdict']}{'' if now['in_cage'] else ', not in the cage'}"
    steps = "" if now["steps"] is None else f" after {now['steps']} steps"
    yield f"outcome      {outcome_words(done)}{steps}"
    if now["end_x"] is not None:
        yield f"end          {_pose(now, 'end', unit)}"
        yield (
            f"error        {now['position_error']:.3g} {unit}, {now['angle_error']:.3g} rad from "
            f"the target; deepest {now['penetration_max']:.3g} {unit}, at rest "
            f"{now['penetration_rest']:.3g} {unit}; peak force {now['peak_force']:.3g}"
        )
    for name, (was, here) in done.other_versions.items():
        yield f"version      {name} was {was}, is {here}"
    for what, was, value in done.differences:
        yield f"differs      {what} was {was!r}, is {value!r}"
    if not done.differences:
        yield "record       the same to the last bit"


def _pose(row: dict[str, Any], prefix: str, unit: str) -> str:
    x, y, theta, sigma = (row[f"{prefix}_{name}"] for name in _POSE)
    return f"x {x:.9g}, y {y:.9g}, theta {theta:.9g} rad, sigma {sigma:.9g} {unit}"
