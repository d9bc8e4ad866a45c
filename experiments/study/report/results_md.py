"""``results.md``: what a study found, for a stranger. The bottom line first, then the method."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Final

from experiments.io.intervals import rate_upper
from experiments.io.one_line import markdown, printable
from experiments.io.outcome_words import END_WORDS, NOT_CLOSED, VERDICT_WORDS
from experiments.io.versions import ANY_CODE, OTHER_CODE
from experiments.study.inputs.variables import VARIABLES, label
from experiments.study.report.method import method
from experiments.study.report.names import display, merged, percent
from experiments.study.report.summary import sentence

_ENDS: Final = ("target", "other_grasp", "escaped")

LONGEST: Final = 40
"""Rows of a table of rates; finer grids are merged."""

_OUTCOMES: Final = {**END_WORDS, **{k: f"not closed: {why}" for k, why in NOT_CLOSED.items()}}


def results_page(document: Mapping[str, Any], command: str) -> str:
    """The page, Markdown; ``document`` is that of ``study.json`` when it is finished."""
    return "\n".join([*_lines(document, command), ""])


def _lines(document: Mapping[str, Any], command: str) -> Iterator[str]:
    found, config = document["found"], document["config"]
    yield f"# Study: {markdown(document['name'])}"
    yield ""
    yield f"**{sentence(found, markdown(document['name']))}.**"
    yield from _closed(found)
    yield ""
    yield from table(
        ("outcome", "trials", ""),
        [(k.replace("_", " "), str(found["outcomes"][k]), _OUTCOMES[k]) for k in _OUTCOMES
         if found["outcomes"][k]],
    )  # fmt: skip
    yield from _near(found, document)
    yield from _verdicts(found, any(VARIABLES[name].geometry for name in config["vary"]))
    for name, one in found["variables"].items():
        yield from _variable(name, one, document["unit"])
    yield from _indices(found)
    yield from _failed(found)
    yield ""
    yield "## Method"
    yield ""
    yield from method(document)
    yield ""
    yield (
        "Versions: "
        + ", ".join(f"{k} {markdown(v)}" for k, v in document["versions"].items())
        + "."
    )
    if document.get(ANY_CODE):
        known = ", ".join(document.get(OTHER_CODE, ())) or "none is known"
        yield f"Rows of other code of the same version were taken: {known}."
    yield ""
    yield "## Command"
    yield ""
    yield f"    {printable(command)}"


def _closed(found: Mapping[str, Any]) -> Iterator[str]:
    one = found["independent"]
    trials, closed, all_ = one["trials"], one["closed"], found["trials"]
    independent = ""
    if trials < all_:
        independent = "independent "
        yield (
            f"The other {all_ - trials} trials of Saltelli's design share inputs with these, to "
            "tell which input matters: rates and intervals, here and over each input, are of the "
            f"independent trials alone, counts of outcomes of all {all_}."
        )
    if not closed:
        yield "None of them was closed."
        return
    if closed < trials:
        low, high = found["target_rate_of_closed_95"]
        yield (
            f"Of the {closed} that were closed at all, {percent(found['target_rate_of_closed'])} "
            f"did (95 %: {percent(low)} to {percent(high)}); a start that was not closed is no "
            "success, but no failure of the grasp either."
        )
    if not found["failed"]:
        yield (
            f"None of {closed} {independent}closings failed (ended elsewhere), so at 95 % the rate "
            f"of failures among closings is below {percent(rate_upper(0, closed))} (exact "
            "one-sided bound, Clopper-Pearson)."
        )


def _near(found: Mapping[str, Any], document: Mapping[str, Any]) -> Iterator[str]:
    """How many ended near the target, and what near is."""
    if not found["closed"] or "near_target" not in found:  # written by an earlier version
        return
    near, unit = found["near_target"], document["unit"]
    length = near["position"] * document["diameter"]
    one = found["independent"]
    yield ""
    yield (
        f"Near the target ended {near['independent']} of {one['closed']} closings: within "
        f"{near['position']:g} diameters of the planned object ({length:.3g} {unit}, the "
        f"displacement of its centroid in the hand) and {near['angle']:g} rad of it, whatever "
        "their outcome is called; those in the target are among them."
    )


def _verdicts(found: Mapping[str, Any], other_shapes: bool) -> Iterator[str]:
    yield ""
    yield (
        "What the planner says of the planned hand and object, were that hand to stand at each "
        "trial's start, and what became of the true ones:"
        if other_shapes
        else "What the planner says of the starts, and what became of them:"
    )
    yield ""
    yield from table(
        ("planned hand" if other_shapes else "start", "in the target's cage", "trials", "closed",
         "target", "other grasp", "escaped", "elsewhere"),
        [
            (
                VERDICT_WORDS[one["verdict"]], _caged(one),
                *(str(one[key]) for key in ("trials", "closed", *_ENDS)),
                str(one["closed"] - sum(one[key] for key in _ENDS)),
            )
            for one in found["verdicts"]
        ],
    )  # fmt: skip
    if other_shapes:
        yield ""
        yield (
            "The true object or hand is not the planned one here: it may be clear of the object, "
            "or caged, where the planned one is not, and the other way round."
        )
    elif any(one["target"] and not one["in_cage"] for one in found["verdicts"]):
        yield ""
        yield "A start outside the cage may end in the target too, but nothing promises it."


def _caged(one: Mapping[str, Any]) -> str:
    """A hand in the object is in no cage and out of none."""
    if one["verdict"] == "collision":
        return "-"
    return "yes" if one["in_cage"] else "no"


def _variable(name: str, one: Mapping[str, Any], unit: str) -> Iterator[str]:
    yield ""
    yield f"## {label(name)[0].upper()}{label(name)[1:]}"
    yield ""
    yield f"`{name}`: {VARIABLES[name].help}."
    yield ""
    factor, shown = display(VARIABLES[name], unit)
    near = all("near_target" in bin_ for bin_ in one["bins"])  # not so in an earlier version's
    head = f"{name} [{shown}]" if shown else name
    last = ("near the target",) if near else ()
    yield from table(
        (head, "trials", "closed", "target", "rate of closed", "95 %", *last),
        [
            (
                _range(factor, bin_),
                *(str(bin_[key]) for key in ("trials", "closed", "target")),
                *_rate(bin_),
                *((str(bin_["near_target"]),) if near else ()),
            )
            for bin_ in merged(one["bins"], LONGEST)
        ],
    )


def _rate(bin_: Mapping[str, Any]) -> tuple[str, str]:
    """Rate and interval; nothing where nothing was closed."""
    if not bin_["closed"]:
        return "-", "-"
    low, high = bin_["rate_95"]
    return percent(bin_["target"] / bin_["closed"]), f"{percent(low)} to {percent(high)}"


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
        "variance that an input explains alone (first order), and with all others (total), with "
        "95 % bootstrap intervals."
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
    rest = f" and {more} more" if more else ""
    yield ""
    yield "## Closings that failed"
    yield ""
    yield (
        f"Closings that did not end in the target, by trial: {shown}{rest}. Any "
        "of them runs again, and is filmed, with"
    )
    yield ""
    yield f"    icage replay-trial DIR {found['failed_trials'][0]} --video trial.mp4"


def _range(factor: float, bin_: Mapping[str, Any]) -> str:
    low, high = (f"{factor * bin_[end]:.4g}" for end in ("low", "high"))
    return low if low == high else f"{low} to {high}"


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> Iterator[str]:
    """Lines of a Markdown table."""
    yield f"| {' | '.join(head)} |"
    yield f"|{'---|' * len(head)}"
    for row in rows:
        yield f"| {' | '.join(row)} |"
