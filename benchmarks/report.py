"""docs/performance.md and its plot, from what was measured: ``python -m benchmarks.report``.

    python -m benchmarks --json benchmarks/performance.json
    python -m benchmarks.report             writes the page and docs/figures/performance.svg
    python -m benchmarks.report --check     exit 1 if the page is not what the JSON says

Nothing on the page is typed in: words here, figures from the JSON.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure as Sheet

from benchmarks.figures import BENCHMARKS, figures_of, measured
from benchmarks.timing import spread
from experiments.environment import ROOT
from experiments.figures.drawing.palette import FINGERS, INK, ORANGE, PURPLE

MEASURED = Path(__file__).with_name("performance.json")
PAGE = ROOT / "docs" / "performance.md"
PLOT = ROOT / "docs" / "figures" / "performance.svg"

COMMANDS = """\
    python -m benchmarks --json benchmarks/performance.json     # everything, five runs each
    python -m benchmarks.report                                 # this page and its plot
    python -m benchmarks --quick --only planner                 # one of them, once
    python -m benchmarks --compare                              # exit 1 if something has slipped
    python -m benchmarks.peers --check                          # are the peers right?
"""

WAYS = """\
n is the number of vertices. The planner's seconds are those of a whole plan, those of the other
ways of `sigma_max` alone; all ran in turns in one process. Both other ways are written for this
comparison from the description of the methods
([benchmarks/peers](../benchmarks/peers/question.py)), in Python over compiled libraries.

- *Grid flood, 1/60*: all hands on a grid of four dimensions on which a finger moves by 1/60 of
  the diameter a step. It is off by some steps, to either side: where the error is positive it
  promises a cage that is none.
- *Alpha shapes* answer yes or no for a rigid hand of one size, in the time of the last column:
  from that many random poses in collision, with balls round them that collide, too. `sigma_max`
  is found by bisection. What is proven holds; an error of -50 % says that hardly anything was
  proven. (A rigid hand may stay caged a little above `sigma_max`, so a small positive error would
  be no contradiction.) [Mahler2016] reports three minutes a problem for its own implementation,
  which solves a larger problem, with energies."""


def main() -> int:
    """Write or check."""
    parser = argparse.ArgumentParser(description=__doc__, allow_abbrev=False)
    parser.add_argument("--check", action="store_true", help="compare the page, write nothing")
    options = parser.parse_args()
    document = json.loads(MEASURED.read_text(encoding="utf-8"))
    text = "\n".join(page(document)) + "\n"
    if options.check:
        fresh = PAGE.exists() and PAGE.read_text(encoding="utf-8") == text
        print("the page is what was measured" if fresh else f"{PAGE.name} is out of date")
        return int(not fresh)
    PAGE.write_text(text, encoding="utf-8")
    draw(rows_of_peers(document), PLOT)
    return 0


def rows_of_peers(document: dict[str, Any]) -> list[dict[str, Any]]:
    """Rows of the comparison, none if it was not run."""
    runs = document["benchmarks"].get("peers", [])
    return runs[0]["rows"] if runs else []


def page(document: dict[str, Any]) -> Iterator[str]:
    """Lines of the page."""
    rows = rows_of_peers(document)
    yield "# Performance"
    yield ""
    yield from bottom_line(document, rows)
    if rows:
        yield ""
        yield "![seconds and errors of each way to sigma_max](figures/performance.svg)"
    yield ""
    yield from machine(document)
    if rows:
        yield from side_by_side(rows, document["benchmarks"]["peers"][0].get("memory_MB", {}))
    yield from searches(document["benchmarks"].get("grasps", []))
    yield from how_it_grows(document["benchmarks"].get("growth", []))
    yield from figures(document)
    yield "## Commands"
    yield ""
    yield COMMANDS.rstrip("\n")


def bottom_line(document: dict[str, Any], rows: list[dict[str, Any]]) -> Iterator[str]:
    """What to remember."""
    planner = document["benchmarks"].get("planner", [])
    if planner:
        one, whole = (
            1e3 * float(np.median([run[key] for run in planner]))
            for key in ("sigma_max_query_n100_median", "plan_n100_median")
        )
        yield (
            f"For an outline of 100 vertices `sigma_max` takes {one:.2g} ms and a whole plan, with "
            f"every grasp and puncture, {whole:.2g} ms (medians, warm, one core)."
        )
    alpha, flood = (
        [row for row in rows if row["method"].startswith(method)]
        for method in ("alpha shapes", "grid flood")
    )
    if alpha and flood:
        low, high = (100 * f(row["error"]["median"] for row in alpha) for f in (min, max))
        yield (
            "The comparable published approach, sampled alpha shapes [Mahler2016], takes "
            f"{least(alpha)} to {most(alpha)} times as long on the shipped cases below and is off "
            f"by {low:+.1f} to {high:+.1f} %."
        )
        low, high = (100 * f(row["error"]["median"] for row in flood) for f in (min, max))
        yield (
            f"A flood over a grid takes {least(flood)} to {most(flood)} times as long and is off "
            f"by {low:+.1f} to {high:+.1f} %, to either side. The planner "
            "is exact for point fingers and safe within 1e-4 for discs ([theory](theory.md))."
        )


def least(rows: list[dict[str, Any]]) -> str:
    """Smallest ratio to the planner, to two digits."""
    return _round(min(row["over_planner"]["median"] for row in rows))


def most(rows: list[dict[str, Any]]) -> str:
    """Largest ratio to the planner, to two digits."""
    return _round(max(row["over_planner"]["median"] for row in rows))


def machine(document: dict[str, Any]) -> Iterator[str]:
    """Where and how it was measured."""
    about = document["versions"]
    libraries = ", ".join(
        f"{name} {about[name]}" for name in ("python", "numpy", "scipy", "numba", "mujoco")
    )
    low, high = document["load"]
    busy = ", more than there are cores" if high > document["cores"] else ""
    yield (
        f"Measured on {document['cores']} cores ({about['platform']}; {libraries}) with a load of "
        f"{low:.1f} to {high:.1f} processes{busy}. "
        "Figures are least, median and largest. Seconds are processor seconds unless it says wall; "
        "a *yardstick* is the time in which the same process sorts two million doubles. What is "
        "compared took turns in one run: ratios can be compared between machines, seconds cannot."
    )
    if document["quick"]:
        yield ""
        yield "**A quick run: one pass with fewer trials.** Good for orders of magnitude."
    left_out = [name for name in BENCHMARKS if name not in document["benchmarks"]]
    if left_out:
        yield ""
        yield f"Not measured in this run: {', '.join(left_out)}."
    yield ""


def side_by_side(rows: list[dict[str, Any]], memory: dict[str, float]) -> Iterator[str]:
    """The planner beside its peers."""
    yield "## The same question by other ways"
    yield ""
    yield "| case | n | way | seconds | / planner | sigma_max | error [%] | one answer [s] |"
    yield "|---|---|---|---|---|---|---|---|"
    for row in rows:
        errors = [f"{100 * row['error'][k]:+.2f}" for k in ("min", "max")]
        error = " to ".join(dict.fromkeys(errors)) if row["method"] != "planner" else "0"
        answer = _spread(row["seconds_per_answer"]) if "seconds_per_answer" in row else ""
        yield (
            f"| {row['case']} | {row['n']} | {row['method']} | {_spread(row['seconds'])} | "
            f"{_round(row['over_planner']['median'])} | {row['sigma_max']['median']:.5g} | "
            f"{error} | {answer} |"
        )
    yield ""
    yield WAYS
    yield ""
    if memory:
        each = ", ".join(f"{way} {megabytes:.0f}" for way, megabytes in memory.items())
        yield (
            "Most memory on the largest of these cases, in MB, Python with its libraries included: "
            f"{each}."
        )
        yield ""


def searches(runs: list[Any]) -> Iterator[str]:
    """What a search for grasps takes on each outline."""
    if not runs:
        return
    yield "## The search for grasps"
    yield ""
    yield "| outline | n | point fingers [s] | disc fingers [s] | best score, points | discs |"
    yield "|---|---|---|---|---|---|"
    rows = runs[0]["rows"]
    for name in dict.fromkeys(key.rsplit(", ", 1)[0] for key in rows):
        both = [f"{name}, {fingers}" for fingers in ("points", "discs")]
        seconds = [
            _spread(spread(run["rows"][key]["seconds"] for run in runs)) if key in rows else ""
            for key in both
        ]
        best = [f"{rows[key]['best']:.4g}" if key in rows else "" for key in both]
        vertices = next(rows[key]["vertices"] for key in both if key in rows)
        yield f"| {name} | {vertices} | {' | '.join(seconds + best)} |"
    yield ""
    yield (
        "The ten best grasps with both cores, in seconds of the clock, after Python's imports; a "
        "score is sigma_guaranteed / sigma_0 of the grasp. Discs have 2 % of the diameter."
    )
    yield ""


def how_it_grows(runs: list[Any]) -> Iterator[str]:
    """A plan by both methods against the number of vertices."""
    if not runs:
        return
    yield "## A plan against the number of vertices"
    yield ""
    yield "| n | cells [ms] | contact space [ms] |"
    yield "|---|---|---|"
    of = {
        (row["method"], row["n"]): {key: 1e3 * row["seconds"][key] for key in row["seconds"]}
        for row in runs[0]["rows"]
    }
    for n in dict.fromkeys(row["n"] for row in runs[0]["rows"]):
        yield f"| {n} | {_spread(of['cells', n])} | {_spread(of['contact-space', n])} |"
    exponents = runs[0]["exponent"]
    yield f"| exponent | {_spread(exponents['cells'])} | {_spread(exponents['contact-space'])} |"
    yield ""
    yield (
        "Stars with targets of every kind: medians over the targets, least and largest of the "
        "repeats. The exponent is that of a power of n fitted to the medians."
    )
    yield ""


def figures(document: dict[str, Any]) -> Iterator[str]:
    """Every figure that has a baseline."""
    yield "## Every figure"
    yield ""
    yield "| figure | median | least | largest | unit | better |"
    yield "|---|---|---|---|---|---|"
    for name, runs in document["benchmarks"].items():
        for figure in figures_of(name, runs):
            now = measured(figure, runs)
            if now is not None:
                yield (
                    f"| {name}: {figure.name} | {now['median']:.4g} | {now['min']:.4g} | "
                    f"{now['max']:.4g} | {figure.unit} | {figure.better} |"
                )
    yield ""


def _spread(value: Mapping[str, Any]) -> str:
    low, middle, high = (value[key] for key in ("min", "median", "max"))
    if low == high:
        return f"{middle:.3g}"
    return f"{middle:.3g} ({low:.3g} to {high:.3g})"


def _round(value: float) -> str:
    """Two digits are all that a ratio of times deserves."""
    return f"{float(f'{value:.2g}'):,.10g}"


def draw(rows: list[dict[str, Any]], path: Path) -> None:
    """Error over seconds, a colour for each way and a mark for each case; nothing without rows."""
    if not rows:
        return
    methods = list(dict.fromkeys(row["method"] for row in rows))
    cases = list(dict.fromkeys(row["case"] for row in rows))
    colours = dict(zip(methods, (INK, FINGERS[0], FINGERS[2], FINGERS[1], PURPLE, ORANGE),
                       strict=False))  # fmt: skip
    marks = dict(zip(cases, "os^Dv*", strict=False))
    sheet = Sheet(figsize=(7.2, 3.6), layout="constrained")
    FigureCanvasAgg(sheet)
    axes = sheet.add_subplot()
    for row in rows:
        seconds, error = row["seconds"], row["error"]
        axes.plot(
            seconds["median"], 100 * error["median"], marks[row["case"]],
            color=colours[row["method"]], ms=6,
        )  # fmt: skip
    for method, colour in colours.items():
        axes.plot([], [], "-", lw=4.0, color=colour, label=method)
    for case, mark in marks.items():
        axes.plot([], [], mark, color="none", markeredgecolor=INK, label=case)
    axes.axhline(0.0, color=INK, lw=0.5)
    axes.set(xscale="log", xlabel="seconds", ylabel="error of sigma_max [%]")
    axes.spines[["top", "right"]].set_visible(False)
    sheet.legend(frameon=False, fontsize=8, loc="outside right upper")
    with matplotlib.rc_context({"svg.hashsalt": "icage"}):
        sheet.savefig(path, metadata={"Date": None})


if __name__ == "__main__":
    sys.exit(main())
