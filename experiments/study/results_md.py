"""``results.md``: what a study found, for a stranger. The bottom line first, then the method."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Final

from experiments.intervals import rate_upper
from experiments.study.shown import merged, percent
from experiments.study.summary import sentence
from experiments.study.variables import VARIABLES, Variable, own_unit

LONGEST: Final = 40
"""Rows of a table of rates; finer grids are merged."""

_OUTCOMES: Final = {
    "target": "in the target grasp",
    "other_grasp": "in another grasp of the plan",
    "jammed": "at rest elsewhere, held by friction",
    "unmatched": "at rest elsewhere, without friction",
    "escaped": "the hand shut on nothing",
    "timed_out": "still moving when time was up",
    "diverged": "the engine gave up",
    "collision": "not closed: a finger would start inside the object",
    "not_caged": "not closed: the start is not caged",
    "no_shape": "not closed: the outline or hand drawn crosses itself",
}

_VERDICTS: Final = {
    "target": "closing can end only in the target",
    "caged": "caged, other grasps within reach",
    "other": "held, but not with the target",
    "escapes": "not caged",
    "collision": "in collision",
}


def results_page(document: Mapping[str, Any], command: str) -> str:
    """The page, Markdown; ``document`` is that of ``study.json`` when it is finished."""
    return "\n".join([*_lines(document, command), ""])


def _lines(document: Mapping[str, Any], command: str) -> Iterator[str]:
    found, config = document["found"], document["config"]
    yield f"# Study: {document['name']}"
    yield ""
    yield f"**{sentence(found, document['name'])}.**"
    yield from _closed(found)
    yield ""
    yield from table(
        ("outcome", "trials", ""),
        [(k.replace("_", " "), str(found["outcomes"][k]), _OUTCOMES[k]) for k in _OUTCOMES
         if found["outcomes"][k]],
    )  # fmt: skip
    yield from _verdicts(found)
    for name, one in found["variables"].items():
        yield from _variable(name, one, document["unit"])
    yield from _indices(found)
    yield from _failed(found)
    yield ""
    yield "## Method"
    yield ""
    yield from _method(document, config, found)
    yield ""
    yield "Versions: " + ", ".join(f"{k} {v}" for k, v in document["versions"].items()) + "."
    yield ""
    yield "## Command"
    yield ""
    yield f"    {command}"


def _closed(found: Mapping[str, Any]) -> Iterator[str]:
    closed, trials = found["closed"], found["trials"]
    if closed and closed < trials:
        low, high = found["target_rate_of_closed_95"]
        yield (
            f"Of the {closed} that were closed at all, {percent(found['target_rate_of_closed'])} "
            f"did (95 %: {percent(low)} to {percent(high)})."
        )
    if trials and not found["failed"]:
        yield (
            f"None of {trials} failed, so at 95 % the rate of failures is below "
            f"{percent(rate_upper(0, trials))}."
        )


def _verdicts(found: Mapping[str, Any]) -> Iterator[str]:
    yield ""
    yield "What the planner says of the starts (planned object and hand), and what became of them:"
    yield ""
    yield from table(
        ("verdict", "in the target's cage", "trials", "target", "other grasp", "escaped"),
        [
            (
                _VERDICTS[one["verdict"]], "yes" if one["in_cage"] else "no", str(one["trials"]),
                str(one["target"]), str(one["other_grasp"]), str(one["escaped"]),
            )
            for one in found["verdicts"]
        ],
    )  # fmt: skip


def _variable(name: str, one: Mapping[str, Any], unit: str) -> Iterator[str]:
    yield ""
    yield f"## {name}: {VARIABLES[name].help}"
    yield ""
    yield from table(
        (f"{name} [{_shown_unit(name, unit)}]", "trials", "target", "rate", "95 %"),
        [
            (
                _range(name, bin_), str(bin_["trials"]), str(bin_["target"]),
                percent(bin_["target"] / bin_["trials"]),
                f"{percent(bin_['rate_95'][0])} to {percent(bin_['rate_95'][1])}",
            )
            for bin_ in merged(one["bins"], LONGEST)
        ],
    )  # fmt: skip


def _indices(found: Mapping[str, Any]) -> Iterator[str]:
    indices = found.get("indices")
    if indices is None:
        return
    yield ""
    yield "## What matters most"
    yield ""
    if indices["groups"] is None:
        yield f"No Sobol indices: {indices['why']}."
        return
    yield (
        f'Sobol indices of "ended in the target", {indices["base"]} base points: the share of its '
        "variance that an input explains alone (first order), and with all others (total)."
    )
    yield ""
    yield from table(
        ("input", "first order", "95 %", "total", "95 %"),
        [
            (
                one["name"],
                f"{one['first']:.3f}", f"{one['first_low']:.3f} to {one['first_high']:.3f}",
                f"{one['total']:.3f}", f"{one['total_low']:.3f} to {one['total_high']:.3f}",
            )
            for one in sorted(indices["groups"], key=lambda g: -g["total"])
        ],
    )  # fmt: skip


def _failed(found: Mapping[str, Any]) -> Iterator[str]:
    if not found["failed"]:
        return
    shown = ", ".join(str(k) for k in found["failed_trials"][:20])
    more = found["failed"] - min(found["failed"], 20)
    yield ""
    yield (
        f"Trials that did not end in the target: {shown}{f' and {more} more' if more else ''}. Any "
        "of them runs again, and is filmed, with"
    )
    yield ""
    yield f"    icage replay-trial DIR {found['failed_trials'][0]} --video trial.mp4"


def _method(
    document: Mapping[str, Any], config: Mapping[str, Any], found: Mapping[str, Any]
) -> Iterator[str]:
    unit, size = document["unit"], document["diameter"]
    vertices = len(document["case"]["outline"]["vertices"])
    yield (
        f"- Object: {vertices} vertices, diameter {size:.6g} {unit}; fingers of radius "
        f"{document['case']['finger_radius']:.4g} {unit}."
    )
    starts = {
        "guaranteed": "drawn uniformly from the guaranteed set",
        "cage": "drawn uniformly from the whole cage",
        "nominal": "one nominal placement",
    }[config["starts"]]
    if document["nominal"]:
        values = (f"{k} {v:.6g}" for k, v in document["nominal"].items())
        starts += f" ({', '.join(values)}; {unit}, rad)"
    yield f"- The hand is meant to stand: {starts}."
    yield f"- Sampling: {config['sampling']}, seed {config['seed']}."
    for name, one in config["vary"].items():
        yield f"- {name} ({VARIABLES[name].help}): {_distribution(name, one, unit)}."
    yield f"- Not varied: {_nominal(config['vary'])}."
    yield (
        f"- An end counts as a grasp within {config['position_tolerance']:g} diameters and "
        f"{config['angle_tolerance']:g} rad; those in the target were off by at most "
        f"{_number(found['position_error_max'], size)} diameters "
        f"({_number(found['position_error_max'])} {unit}) and "
        f"{_number(found['angle_error_max'])} rad."
    )
    yield (
        f"- Time step {config['time_step']:g} s, at most {config['max_time']:g} s, "
        f"{_number(found['steps_mean'])} steps on average; deepest finger "
        f"{_number(found['penetration_max'], size)} diameters while closing, "
        f"{_number(found['penetration_rest_max'], size)} at rest; largest force on a finger "
        f"{_number(found['peak_force_max'])} closing forces (median of the trials "
        f"{_number(found['peak_force_median'])}; the largest are impacts, as stiff as the engine "
        "makes them)."
    )
    stopped = document["stopped"]
    how = "stopped early" if stopped["early"] else "ran to its end"
    yield f"- It {how}: {stopped['at']} trials; {stopped['why']}."


def _nominal(vary: Mapping[str, Any]) -> str:
    left = [one for name, one in VARIABLES.items() if name not in vary]
    zero = ", ".join(one.name for one in left if not one.nominal)
    others = (f"{one.name} {_plain(one)}" for one in left if one.nominal)
    return "; ".join(part for part in (", ".join(others), zero and f"0: {zero}") if part)


def _plain(one: Variable) -> str:
    shown = f"{_scale(one.name) * one.nominal:.4g}"
    return f"{shown} deg" if one.measure == "angle" else shown


def _distribution(name: str, one: Mapping[str, Any], unit: str) -> str:
    scale, shown = _scale(name), _shown_unit(name, unit)
    p = [f"{scale * value:.4g}" for value in one["parameters"]]
    word = {
        "fixed": lambda: p[0],
        "uniform": lambda: f"uniform from {p[0]} to {p[1]}",
        "normal": lambda: f"normal ({p[0]}, {p[1]}: mean, standard deviation)",
        "truncated": lambda: f"normal ({p[0]}, {p[1]}) within {p[2]} to {p[3]}",
        "grid": lambda: f"{len(p)} values, {p[0]} to {p[-1]}",
    }[one["kind"]]()  # fmt: skip
    return f"{word} {shown}" if shown != "1" else word


def _scale(name: str) -> float:
    return math.degrees(1.0) if VARIABLES[name].measure == "angle" else 1.0


def _shown_unit(name: str, unit: str) -> str:
    return "deg" if VARIABLES[name].measure == "angle" else own_unit(VARIABLES[name], unit)


def _range(name: str, bin_: Mapping[str, Any]) -> str:
    low, high = (f"{_scale(name) * bin_[end]:.4g}" for end in ("low", "high"))
    return low if low == high else f"{low} to {high}"


def _number(value: float | None, over: float = 1.0) -> str:
    if value is None:
        return "none"
    shown = value / over
    return f"{shown:.2g}" if shown < 10 else f"{shown:.0f}"


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> Iterator[str]:
    """Lines of a Markdown table."""
    yield f"| {' | '.join(head)} |"
    yield f"|{'---|' * len(head)}"
    for row in rows:
        yield f"| {' | '.join(row)} |"
