"""Does the tree still give the answers that it gave before? Every case, to the last bit.

    python -m benchmarks.same_answers record out/before     # in a checkout of the older commit
    python -m benchmarks.same_answers record out/after      # in the newer one
    python -m benchmarks.same_answers compare out/before out/after

Only the commands of the contract are used, so that a checkout of any layout can be asked: plans of
every shipped case by both methods with their regions, answers to a thousand placements each,
closings, attacks and shakes of every case (``regress``), the grasps of one tool, and two studies.
``compare`` prints every key that differs and exits with 1 if there is one. Takes some 15 minutes.
"""

from __future__ import annotations

import argparse
import csv
import json
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq

MODELS = Path("models")
CALL = "import sys; from experiments.cli import main; sys.exit(main())"
PLACEMENTS = 1000
STUDIES = {
    "friction": ["pliers", "--vary", "friction=0:0.3", "--vary", "place_x=-4:4mm"],
    "shapes": ["saw", "--vary", "outline_noise=0:0.002", "--vary", "finger_radius=-0.2:0.2mm"],
}
TRIALS = "200"
IGNORED = frozenset({"versions", "seconds"})
"""Keys that tell of the run and not of its answer."""


def icage(*arguments: str) -> None:
    """One command, in the checkout this is run from."""
    done = subprocess.run([sys.executable, "-c", CALL, *arguments], check=False)
    if done.returncode not in (0, 1):
        raise SystemExit(f"icage {' '.join(arguments)}: exit {done.returncode}")


def every_case() -> dict[str, Path]:
    """Shipped case files by a name of their own."""
    folders = [MODELS / "cases", MODELS / "hard", *sorted((MODELS / "objects").glob("*/cases"))]
    return {
        f"{path.parts[-3] if path.parts[-2] == 'cases' else path.parts[-2]}-{path.stem}": path
        for folder in folders
        for path in sorted(folder.glob("*.json"))
    }


def placements(plan: dict[str, Any], seed: int) -> list[list[float]]:
    """Hands near the target and hands anywhere over the object."""
    rng = np.random.default_rng(seed)
    a, b = np.array(plan["contacts"][:2])
    sigma, theta = np.hypot(*(b - a)), np.arctan2(*(b - a)[::-1])
    near = np.column_stack([
        a + 0.1 * sigma * rng.normal(size=(PLACEMENTS // 2, 2)),
        theta + 0.2 * rng.normal(size=PLACEMENTS // 2),
        sigma * rng.uniform(0.95, 1.4, PLACEMENTS // 2),
    ])  # fmt: skip
    far = np.column_stack([
        a + plan["diameter"] * rng.uniform(-0.7, 0.7, (PLACEMENTS // 2, 2)),
        rng.uniform(-np.pi, np.pi, PLACEMENTS // 2),
        sigma * rng.uniform(0.5, 2.5, PLACEMENTS // 2),
    ])  # fmt: skip
    return [list(map(float, row)) for row in np.vstack([near, far])]


def record(out: Path) -> None:
    """Ask everything and keep the answers."""
    cases = every_case()
    folder = out / "cases"
    folder.mkdir(parents=True)
    for number, (name, path) in enumerate(cases.items()):
        for method in ("cells", "contact-space"):
            target = out / f"plan-{method}-{name}.json"
            icage("plan", str(path), "--method", method, "--json", str(target))
        plan = json.loads((out / f"plan-cells-{name}.json").read_text())
        shutil.copy(path, folder / f"{name}.json")
        if plan["verdict"] == "not_a_cage":
            continue
        table = out / f"placements-{name}.csv"
        with table.open("w", newline="", encoding="utf-8") as file:
            rows = placements(plan, number)
            csv.writer(file).writerows([["x", "y", "theta", "sigma"], *rows])
        icage("query", str(path), str(table), "--json", str(out / f"query-{name}.json"))
    icage("grasps", "wrench", "--finger-radius", "4", "--json", str(out / "grasps-wrench.json"))
    for name, options in STUDIES.items():
        more = ["--trials", TRIALS, "--seed", "0", "--out", str(out / f"study-{name}")]
        icage("study", *options, *more)
    icage("regress", "--fast", "--cases", str(folder), "--out", str(out / "closings"),
          "--json", str(out / "regress.json"))  # fmt: skip


def differences(before: Any, after: Any, where: str = "") -> Iterator[str]:
    """Paths of the values that are not the same; new keys are none."""
    if isinstance(before, dict) and isinstance(after, dict):
        for key, value in before.items():
            if key not in IGNORED:
                found = after.get(key, "gone")
                yield from differences(value, found, f"{where}/{key}")
    elif isinstance(before, list) and isinstance(after, list) and len(before) == len(after):
        for k, (one, other) in enumerate(zip(before, after, strict=True)):
            yield from differences(one, other, f"{where}/{k}")
    elif before != after:
        yield f"{where}: {str(before)[:60]} -> {str(after)[:60]}"


def table_differences(before: Path, after: Path) -> Iterator[str]:
    """Columns of two tables that are not the same."""
    one, other = pq.read_table(before), pq.read_table(after)
    for name in one.column_names:
        if name not in other.column_names:
            yield f"column {name}: gone"
        elif one[name].to_pylist() != other[name].to_pylist():
            yield f"column {name}"


def compare(before: Path, after: Path) -> int:
    """Print what differs; the exit code."""
    different = same = 0
    for path in sorted([*before.glob("*.json"), *before.rglob("*.parquet")]):
        name = path.relative_to(before)
        other = after / name
        if not other.exists():
            lines = ["missing"]
        elif path.suffix == ".json":
            texts = (json.loads(p.read_text(encoding="utf-8")) for p in (path, other))
            lines = list(differences(*texts))
        else:
            lines = list(table_differences(path, other))
        different, same = different + bool(lines), same + (not lines)
        for line in lines[:20]:
            print(f"{name}: {line}")
        if len(lines) > 20:
            print(f"{name}: {len(lines) - 20} more")
    print(f"{same} answers the same, {different} not")
    return int(different > 0 or same == 0)


def main() -> int:
    """Record or compare."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.same_answers")
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("record").add_argument("out", type=Path)
    both = commands.add_parser("compare")
    both.add_argument("before", type=Path)
    both.add_argument("after", type=Path)
    options = parser.parse_args()
    if options.command == "record":
        record(options.out)
        return 0
    return compare(options.before, options.after)


if __name__ == "__main__":
    sys.exit(main())
