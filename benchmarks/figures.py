"""Which numbers of which benchmark count, which way is better, and how far they may slip.

A figure is looked up in the JSON that its benchmark writes. A path is keys with `` > `` between
them; ``key=value&other=value`` takes the row of a list that has these. Whatever is found may be a
number, a ``Spread`` or three numbers (least, median, largest).
"""

from __future__ import annotations

import math
import statistics
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from benchmarks.timing import Spread
from icage.planner import METHODS

HERE = Path(__file__).parent
STEP = " > "


@dataclass(frozen=True)
class Figure:
    """A number that is compared with its baseline."""

    name: str
    path: str
    unit: str
    better: Literal["lower", "higher", "not judged"]
    tolerance: float
    """[1] How much worse than the baseline, as a share of it, is still no slip."""
    over: str = ""
    """Path of what it is divided by, in the same document."""


@dataclass(frozen=True)
class Benchmark:
    """A module that is run as ``python -m benchmarks.MODULE --json FILE``."""

    title: str
    figures: tuple[Figure, ...]
    quick: tuple[str, ...] = ()
    """Options of a quick run."""
    repeats: bool = False
    """It repeats by itself and writes the spread; the others are run five times."""


def _per_yardstick(name: str, path: str, tolerance: float = 0.25) -> Figure:
    return Figure(name, path, "yardsticks", "lower", tolerance, "yardstick")


def _closing(target: str) -> tuple[Figure, ...]:
    return (
        Figure(f"{target}: a step / a bare step", f"{target}_us_per_step", "1", "lower", 0.15,
               f"{target}_us_per_bare_step"),
        _per_yardstick(f"{target}: a closing", f"{target}_seconds_per_closing"),
    )  # fmt: skip


def _start(name: str) -> tuple[Figure, ...]:
    return tuple(
        Figure(f"{name}, {kind}", f"seconds > {name} > {kind}", "s", "lower", slip)
        for kind, slip in (("wall", 0.5), ("processor", 0.3))
    )


def _peer(case: str, method: str) -> tuple[Figure, ...]:
    row = f"rows > case={case}&method={method}"
    return (
        Figure(
            f"{case}, {method}: seconds / planner's", f"{row} > over_planner", "1", "higher", 0.4
        ),
    )


PEER_CASES = ("L", "T", "pliers, points", "pliers, discs", "saw, discs")
PEER_METHODS = ("grid flood, 1/30", "grid flood, 1/60", "alpha shapes, 20000 samples")

BENCHMARKS: dict[str, Benchmark] = {
    "planner": Benchmark(
        "Planner, warm, 100 vertices",
        (
            _per_yardstick("one sigma_max, median target", "sigma_max_query_n100_median"),
            _per_yardstick("one sigma_max, slowest target", "sigma_max_query_n100_max", 0.5),
            _per_yardstick("whole plan", "plan_n100_median"),
            _per_yardstick("caging regions", "regions_n100_median"),
            _per_yardstick("100,000 placements asked", "membership_100k_n100_median"),
            Figure("memory at 300 vertices", "peak_memory_n300_MB", "MB", "lower", 0.1),
        ),
    ),
    "growth": Benchmark(
        "How a plan grows with the number of vertices, 20 to 600",
        (
            *(
                Figure(f"{method}: exponent of n", f"exponent > {method}", "1", "lower", 0.15)
                for method in METHODS
            ),
            *(
                _per_yardstick(f"{method}, n = {n}", f"rows > method={method}&n={n} > seconds", 0.3)
                for method in METHODS
                for n in (20, 150, 600)
            ),
        ),
        quick=("--largest", "150", "--targets", "3", "--repeats", "1"),
        repeats=True,
    ),
    "round_objects": Benchmark(
        "Round objects, where hands tie",
        tuple(
            _per_yardstick(f"{name}, {method}", f"round_{name}_{method}_seconds", 0.3)
            for name, method in (
                ("regular_99", "cells"),
                ("regular_99", "contact-space"),
                ("regular_199", "cells"),
                ("regular_500", "cells"),
                ("regular_1000", "cells"),
                ("gear_240", "cells"),
                ("ellipse_200", "cells"),
            )
        )
        + (Figure("regular_1000, memory", "round_regular_1000_cells_MB", "MB", "lower", 0.1),),
        quick=("--only", "regular_99"),
        repeats=True,
    ),
    "whole_sublevels": Benchmark(
        "All minima and merges of a hand",
        tuple(
            _per_yardstick(f"{name}, both cores", f"sublevels_{name}_seconds_clock", 0.4)
            for name in ("star_80", "star_300", "comb_300", "spur_300")
        )
        + (Figure("star_300, memory", "sublevels_star_300_MB", "MB", "lower", 0.15),),
        quick=("--only", "star_80"),
        repeats=True,
    ),
    "discs": Benchmark(
        "Disc fingers against point fingers",
        tuple(
            Figure(f"a plan, discs / {what}, n = {n}", f"rows > n={n} > {key}", "1", "lower", 0.3)
            for n in (20, 40, 60)
            for what, key in (
                ("points", "ratio"),
                ("points on the grown outline", "ratio_grown"),
            )
        ),
        quick=("--outlines", "3"),
    ),
    "start": Benchmark(
        "Whole commands",
        (
            *_start("cold plan, point fingers"),
            *_start("plan, point fingers"),
            *_start("plan, disc fingers"),
            *_start("--help"),
        ),
        quick=("--runs", "1"),
        repeats=True,
    ),
    "closing": Benchmark(
        "Closings in MuJoCo",
        tuple(f for target in ("T", "L", "pliers", "saw", "triangle") for f in _closing(target)),
        quick=("--trials", "50", "--passes", "2"),
    ),
    "study": Benchmark(
        "Studies",
        (
            Figure("share of a bare loop's speed", "share of the bare loop's steps per second", "1",
                   "higher", 0.1),
            *(
                Figure(f"{name}, against fixed shapes", f"{name}: trials per second and core", "1",
                       "higher", 0.25, "fixed shapes: trials per second and core")
                for name in ("friction, 0 to 0.1", "a radius each", "an outline each")
            ),
        ),
        quick=("--trials", "100", "--passes", "1"),
    ),
    "grasps": Benchmark(
        "Search for grasps, ten each",
        tuple(
            _per_yardstick(f"{name}, {fingers}", f"rows > {name}, {fingers} > seconds", 0.5)
            for fingers in ("points", "discs")
            for name in ("claw_hammer", "hedge_shears", "pliers", "star_120", "blob_200")
        ),
        quick=("--only", "claw_hammer"),
    ),
    "two_engines": Benchmark(
        "Both methods of the planner",
        tuple(
            Figure(f"contact space / cells, n = {n}", f"{n} > contact_space_median", "1", "lower",
                   0.4, f"{n} > cells_median")
            for n in (40, 100, 320)
        ),
        quick=("--count", "3"),
    ),
    "peers": Benchmark(
        "Other ways to sigma_max",
        tuple(f for case in PEER_CASES for method in PEER_METHODS for f in _peer(case, method)),
        quick=("--quick",),
        repeats=True,
    ),
}  # fmt: skip


def there(name: str) -> bool:
    """Is the benchmark in this checkout?"""
    return (HERE / f"{name}.py").exists() or (HERE / name / "__main__.py").exists()


def baseline_path(name: str) -> Path:
    """Committed figures of a benchmark, in the form in which it writes them."""
    return HERE / f"{name}_baseline.json"


def figures_of(name: str, documents: list[Any]) -> tuple[Figure, ...]:
    """The figures of a benchmark; of one that names none every number it wrote, not judged."""
    if BENCHMARKS[name].figures or not documents:
        return BENCHMARKS[name].figures
    return tuple(
        Figure(path, path, "", "not judged", math.inf) for path in _numbers(documents[0], "")
    )


def _numbers(document: Any, path: str) -> Iterator[str]:
    if three(document) is not None and not isinstance(document, bool):
        yield path
    elif isinstance(document, dict):
        for key, value in document.items():
            yield from _numbers(value, f"{path}{STEP}{key}" if path else key)


def found(document: Any, path: str) -> Any:
    """What is at a path, or None.

    >>> rows = {"rows": [{"n": 20, "ratio": 2.0}, {"n": 40, "ratio": [1, 3, 4]}]}
    >>> found(rows, "rows > n=40 > ratio")
    [1, 3, 4]
    >>> found(rows, "rows > n=30 > ratio") is None
    True
    """
    for step in path.split(STEP):
        if isinstance(document, list) and "=" in step:
            wanted = dict(pair.split("=", 1) for pair in step.split("&"))
            matching = (
                row for row in document if all(str(row.get(k)) == v for k, v in wanted.items())
            )
            document = next(matching, None)
        elif isinstance(document, dict):
            document = document.get(step)
        else:
            return None
    return document


def three(value: Any) -> tuple[float, float, float] | None:
    """Least, median, largest of a number or a spread, or None."""
    if isinstance(value, int | float):
        return float(value), float(value), float(value)
    if isinstance(value, dict) and {"min", "median", "max"} <= value.keys():
        return float(value["min"]), float(value["median"]), float(value["max"])
    if isinstance(value, list) and len(value) == len(Spread.__annotations__):
        return float(value[0]), float(value[1]), float(value[2])
    return None


def measured(figure: Figure, documents: Iterable[Any]) -> Spread | None:
    """A figure over the runs of its benchmark, or None if a run does not have it."""
    triples: list[tuple[float, float, float]] = []
    for document in documents:
        value = three(found(document, figure.path))
        divisor = three(found(document, figure.over)) if figure.over else (1.0, 1.0, 1.0)
        if value is None or divisor is None:
            return None
        triples.append((value[0] / divisor[1], value[1] / divisor[1], value[2] / divisor[1]))
    if not triples:
        return None
    lows, medians, highs = zip(*triples, strict=True)
    return {"min": min(lows), "median": statistics.median(medians), "max": max(highs)}


def slipped(figure: Figure, now: float, base: float) -> bool:
    """Worse than the baseline by more than the tolerance?

    >>> slow = Figure("time", "t", "s", "lower", 0.1)
    >>> slipped(slow, 1.05, 1.0), slipped(slow, 1.2, 1.0), slipped(slow, 0.2, 1.0)
    (False, True, False)
    """
    if figure.better == "not judged":
        return False
    if figure.better == "lower":
        return now > base * (1.0 + figure.tolerance)
    return now < base / (1.0 + figure.tolerance)
