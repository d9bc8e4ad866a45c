"""How a study was made, for its page: object, starts, inputs, tolerances, length."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from experiments.study.inputs.variables import VARIABLES, Variable
from experiments.study.report.names import display
from experiments.study.run.announcement import nominal_words


def method(document: Mapping[str, Any]) -> Iterator[str]:
    """Lines of the list; what has no number, since nothing was closed, is left out."""
    config, found = document["config"], document["found"]
    unit, size = document["unit"], document["diameter"]
    vertices = len(document["case"]["outline"]["vertices"])
    yield (
        f"- Object: {vertices} vertices, diameter {size:.6g} {unit}; fingers of radius "
        f"{document['case']['finger_radius']:.4g} {unit}."
    )
    yield f"- The hand is meant to stand: {_meant(document)}."
    yield f"- Sampling: {config['sampling']}, seed {config['seed']}.{_even(config['sampling'])}"
    for name, one in config["vary"].items():
        yield f"- {name} ({VARIABLES[name].help}): {_distribution(name, one, unit)}."
    yield f"- Not varied: {_nominal(config['vary'])}."
    yield f"- {_tolerances(config, found, size, unit)}"
    yield f"- Time step {config['time_step']:g} s, at most {config['max_time']:g} s" + (
        f", {_number(found['steps_mean'])} steps on average." if found["steps_mean"] else "."
    )
    if found["penetration_max"] is not None:
        yield f"- {_forces(found, size)}"
    yield f"- {_length(document)}"


def _meant(document: Mapping[str, Any]) -> str:
    """Where the hand is meant to stand; of one placement, what the planner says."""
    nominal = document["nominal"]
    if not nominal:
        whole = document["config"]["starts"] == "cage"
        return f"drawn uniformly from the {'whole cage' if whole else 'guaranteed set'}"
    values = ", ".join(f"{k} {nominal[k]:.6g}" for k in ("x", "y", "theta", "sigma"))
    said = nominal_words(document)
    return f"one nominal placement ({values}; {document['unit']}, rad); the planner says: {said}"


def _even(sampling: str) -> str:
    """What the intervals are, and what they are not where the draws are not independent."""
    if sampling == "random":
        return " Intervals of rates are Wilson's at 95 %."
    return (
        " Intervals of rates are Wilson's at 95 %, made for independent draws; Sobol points fill "
        "the inputs more evenly, so they are as a rule wider than need be."
    )


def _tolerances(config: Mapping[str, Any], found: Mapping[str, Any], size: float, unit: str) -> str:
    line = (
        f"An end counts as a grasp within {config['position_tolerance']:g} diameters and "
        f"{config['angle_tolerance']:g} rad"
    )
    if found["position_error_max"] is None:
        return f"{line}."
    return (
        f"{line}; those in the target were off by at most "
        f"{_number(found['position_error_max'], size)} diameters "
        f"({_number(found['position_error_max'])} {unit}) and "
        f"{_number(found['angle_error_max'])} rad."
    )


def _forces(found: Mapping[str, Any], size: float) -> str:
    return (
        f"Deepest finger {_number(found['penetration_max'], size)} diameters while closing, "
        f"{_number(found['penetration_rest_max'], size)} at rest; largest force on a finger "
        f"{_number(found['peak_force_max'])} closing forces (median of the closings "
        f"{_number(found['peak_force_median'])}; the largest are impacts, as stiff as the engine "
        "makes them)."
    )


def _length(document: Mapping[str, Any]) -> str:
    """How many trials were asked for and run, and why not as many."""
    asked, stopped = document["config"]["trials"], document["stopped"]
    early = ", it stopped early" if stopped["early"] else ""
    return f"{asked} trials asked for, {stopped['at']} run{early} ({stopped['why']})."


def _nominal(vary: Mapping[str, Any]) -> str:
    left = [one for name, one in VARIABLES.items() if name not in vary]
    zero = ", ".join(one.name for one in left if not one.nominal)
    others = (f"{one.name} {_plain(one)}" for one in left if one.nominal)
    return "; ".join(part for part in (", ".join(others), zero and f"0: {zero}") if part)


def _plain(one: Variable) -> str:
    factor, shown = display(one, "")  # no length has a usual value but 0
    return f"{factor * one.nominal:.4g} {shown}".strip()


def _distribution(name: str, one: Mapping[str, Any], unit: str) -> str:
    factor, shown = display(VARIABLES[name], unit)
    p = [f"{factor * value:.4g}" for value in one["parameters"]]
    word = {
        "fixed": lambda: p[0],
        "uniform": lambda: f"uniform from {p[0]} to {p[1]}",
        "normal": lambda: f"normal ({p[0]}, {p[1]}: mean, standard deviation)",
        "truncated": lambda: f"normal ({p[0]}, {p[1]}) within {p[2]} to {p[3]}",
        "grid": lambda: f"{len(p)} values, {p[0]} to {p[-1]}",
    }[one["kind"]]()  # fmt: skip
    return f"{word} {shown}".strip()


def _number(value: float, over: float = 1.0) -> str:
    shown = value / over
    return f"{shown:.2g}" if shown < 10 else f"{shown:.0f}"
