"""The result as a table: for a terminal and as Markdown."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Final

from experiments.io.intervals import rate_upper
from experiments.io.one_line import markdown as as_markdown

HEAD: Final = (
    "case", "discs", "sigma_max/sigma_0", "guaranteed", "rest", "outside", "random", "guided",
    "rigid", "guided above", "measured off", "deepest", "held", "second", "friction", "verdict",
)  # fmt: skip

BOTH_HEAD: Final = (
    "case", *("guaranteed", "rest", "outside", "random", "error", "deepest") * 2
)  # fmt: skip
"""The same in both engines: MuJoCo, then Chipmunk2D."""

LEGEND: Final = (
    "discs: radius over the diameter, * derived from point fingers, ** at another grasp of that "
    "hand. guaranteed: closings that ended in the target. rest: in the target + in another grasp "
    "of the plan. outside: in the target + in another grasp + let go. random, guided, rigid: "
    "attacks below sigma_max that got the object out, of how many. guided above: attacks above it "
    "that did. measured off: where guided attacks begin to succeed, from the planner's sigma_max. "
    "deepest: finger over the diameter, closings | attacks. held: after closing, rank of the "
    "contacts. second: the other engine's guaranteed + random escapes. friction: closings with "
    "friction from below sigma_first(mu) that ended within its tolerance of the target, and how "
    "many coefficients."
)


def table(rows: Sequence[Mapping[str, Any]]) -> list[tuple[str, ...]]:
    """The head and a row per case."""
    return [HEAD, *(_row(row) for row in rows)]


def both_engines(rows: Sequence[Mapping[str, Any]]) -> list[tuple[str, ...]]:
    """The head and a row per case that both engines ran; no rows if the second is not there."""
    ran = [row for row in rows if row["second"] is not None]
    return [BOTH_HEAD, *((row["case"], *_first(row), *_other(row)) for row in ran)] if ran else []


def terminal(rows: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """Columns of equal width, then what the columns mean and what did not hold."""
    yield from _aligned(table(rows))
    both = both_engines(rows)
    if both:
        yield ""
        yield BOTH
        yield from _aligned(both)
        yield ""
    yield from _below(rows)


def _aligned(lines: list[tuple[str, ...]]) -> Iterator[str]:
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    for line in lines:
        cells = [line[0].ljust(widths[0])]
        cells += [text.rjust(w) for text, w in zip(line[1:], widths[1:], strict=True)]
        yield "  ".join(cells).rstrip()


def markdown(rows: Sequence[Mapping[str, Any]], title: str, command: str) -> Iterator[str]:
    """A page: title, table, legend, bottom line, the command that makes it again."""
    rows = [
        {
            **row,
            "case": as_markdown(row["case"]),
            "failures": [as_markdown(sentence) for sentence in row["failures"]],
        }
        for row in rows
    ]
    yield f"# {title}"
    yield ""
    yield from _piped(table(rows))
    for line in _below(rows):
        yield ""
        yield line
    both = both_engines(rows)
    if both:
        yield ""
        yield BOTH
        yield ""
        yield from _piped(both)
    yield ""
    yield f"    {command}"


def _piped(lines: list[tuple[str, ...]]) -> Iterator[str]:
    cells = [[re.sub(r"(?<!\\)\|", "/", text) for text in line] for line in lines]
    yield f"| {' | '.join(cells[0])} |"
    yield f"|{'---|' * len(cells[0])}"
    yield from (f"| {' | '.join(line)} |" for line in cells[1:])


def _below(rows: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    yield LEGEND
    yield bottom_line(rows)
    settings = next((row["attacks"] for row in rows if row["attacks"]), None)
    if settings is not None:
        constant, damping = settings["solref"]
        yield (
            f"seed {rows[0]['seed']}, friction only where it is named, time step "
            f"{settings['time_step']} s, contacts with a time constant of {constant:g} s and a "
            f"damping ratio of {damping:g}"
        )
    for row in rows:
        yield from (f"{row['case']}: {sentence}" for sentence in row["failures"])


def bottom_line(rows: Sequence[Mapping[str, Any]]) -> str:
    """The sums over all cases that physics could judge."""
    judged = [row for row in rows if row["attacks"] and row["attacks"]["verdict"] != THIN]
    closed = [row["closings"]["guaranteed"] for row in rows if "guaranteed" in row["closings"]]
    target, trials = sum(c["target"] for c in closed), sum(c["trials"] for c in closed)
    below = [_runs(row, "below") for row in judged]
    out = sum(run["escapes"] for runs in below for run in runs.values())
    tried = sum(run["attacks"] for runs in below for run in runs.values())
    above = [runs["guided"] for row in judged if "guided" in (runs := _runs(row, "above"))]
    thin = sum(1 for row in rows if row["attacks"] and row["attacks"]["verdict"] == THIN)
    none = sum(1 for row in rows if row["physical"] is None)
    bad = sum(1 for row in rows if row["failures"])
    each = [runs["random"] for runs in below if "random" in runs]
    worst = max((rate_upper(r["escapes"], r["attacks"]) for r in each), default=1.0)
    return (
        f"{len(rows)} cases, {bad} failed; {target} of {trials} closings from guaranteed sets in "
        f"the target; {out} of {tried} attacks below sigma_max escaped (random attacks on one "
        f"case: rate under {100.0 * worst:.1f} % at 95 %, Clopper-Pearson); "
        f"{sum(r['escapes'] for r in above)} of {sum(r['attacks'] for r in above)} guided ones "
        f"above it; {thin} too thin for physics, {none} with nothing to close into"
    )


BOTH: Final = (
    "Both engines, MuJoCo first, then Chipmunk2D: fewer trials, each its own starts, ends told by "
    "their pose to 0.05 diameters and 0.1 rad"
)

THIN: Final = "too_thin_for_physics"


def _runs(row: Mapping[str, Any], side: str) -> dict[str, Any]:
    attacks = row["attacks"] or {}
    return {
        name: attacks[name][side]
        for name in ("random", "guided", "rigid")
        if name in attacks and attacks[name][side] is not None
    }


def _row(row: Mapping[str, Any]) -> tuple[str, ...]:
    physical, closings, attacks = row["physical"], row["closings"], row["attacks"] or {}
    levels = physical or row["planner"]
    below, above = _runs(row, "below"), _runs(row, "above")
    return (
        row["case"],
        "-" if physical is None else _discs(physical),
        _opening(levels),
        *(_closings(closings.get(which), which) for which in ("guaranteed", "rest", "outside")),
        *(_escapes(below.get(name)) for name in ("random", "guided", "rigid")),
        _escapes(above.get("guided")),
        _off(attacks.get("guided", {}).get("measured"), levels["sigma_max"]),
        _deepest(closings, attacks),
        _held(row["shake"]),
        _second(row["second"]),
        _friction(row.get("friction")),
        _verdict(row),
    )


def _discs(physical: Mapping[str, Any]) -> str:
    stars = "**" if "another" in physical["origin"] else "*" * ("derived" in physical["origin"])
    return f"{100.0 * physical['finger_radius'] / physical['diameter']:.2g} %{stars}"


def _opening(levels: Mapping[str, Any]) -> str:
    if levels["verdict"] != "cage":
        return str(levels["verdict"]).replace("_", " ")
    return f"{levels['sigma_max'] / levels['sigma_0']:.4f}"


def _closings(closed: Mapping[str, Any] | None, which: str) -> str:
    if closed is None:
        return "-"
    if which == "guaranteed":
        return f"{closed['target']}/{closed['trials']}"
    parts = f"{closed['target']}+{closed['other_grasp']}"
    let_go = f"+{closed['escaped']}" if which == "outside" else ""
    return f"{parts}{let_go}/{closed['trials']}"


def _escapes(run: Mapping[str, Any] | None) -> str:
    return "-" if run is None else f"{run['escapes']}/{run['attacks']}"


def _off(measured: Sequence[float | None] | None, top: float | None) -> str:
    if measured is None or top is None:
        return "-"
    low, high = (None if level is None else 100.0 * (level / top - 1.0) for level in measured)
    end = "inf" if high is None else f"{high:+.3f} %"
    return f"{low:+.3f} .. {end}"


def _deepest(closings: Mapping[str, Any], attacks: Mapping[str, Any]) -> str:
    if not closings and not attacks:
        return "-"
    deepest = max((c["penetration"] for c in closings.values()), default=0.0)
    return f"{deepest:.1e} | {attacks.get('penetration', 0.0):.1e}"


def _held(shake: Mapping[str, Any] | None) -> str:
    if shake is None:
        return "-"
    return f"{'yes' if shake['held'] else 'no'}, {shake['rank']}"


def _first(row: Mapping[str, Any]) -> tuple[str, ...]:
    return _engine(row["closings"], _runs(row, "below").get("random"))


def _other(row: Mapping[str, Any]) -> tuple[str, ...]:
    return _engine(row["second"]["closings"], row["second"]["random_below"])


def _engine(closings: Mapping[str, Any], attacks: Mapping[str, Any] | None) -> tuple[str, ...]:
    off = [closed["position_error"] for closed in closings.values()]
    deep = [closed["penetration"] for closed in closings.values()]
    deep += [] if attacks is None else [attacks["penetration"]]
    return (
        *(_closings(closings.get(which), which) for which in ("guaranteed", "rest", "outside")),
        _escapes(attacks),
        f"{max(off, default=0.0):.0e}",
        f"{max(deep, default=0.0):.1e}",
    )


def _second(second: Mapping[str, Any] | None) -> str:
    if second is None:
        return "-"
    guaranteed = second["closings"].get("guaranteed")
    closed = "-" if guaranteed is None else f"{guaranteed['target']}/{guaranteed['trials']}"
    return f"{closed} + {_escapes(second['random_below'])}"


def _friction(runs: Sequence[Mapping[str, Any]] | None) -> str:
    if not runs:
        return "-"
    target, trials = sum(run["target"] for run in runs), sum(run["trials"] for run in runs)
    return f"{target}/{trials}, {len(runs)}"


def _verdict(row: Mapping[str, Any]) -> str:
    if row["failures"]:
        return "FAILED"
    if row["physical"] is None:
        return "no physics"
    verdict = (row["attacks"] or {}).get("verdict", "ok")
    return "too thin" if verdict == THIN else str(verdict)
