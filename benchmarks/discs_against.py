"""Plans with disc fingers here and in another checkout, in turn: times, and whether answers differ.

    python -m benchmarks.discs_against OLD_CHECKOUT

Random stars as in ``benchmarks.discs``. Two processes, one in each checkout, plan each of them in
turn; told are medians of processor time [ms] of point and of disc plans, of disc plans here over
there, and the largest difference of a level or contact.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.discs import pair

SIZES = (20, 40, 50, 60)

_WORKER = """
import json, sys, time
from icage.kernels.compiled import machine_code_at_once
from icage.outline import Outline
from icage.planner import plan
machine_code_at_once()
for line in sys.stdin:
    vertices, contacts, radius = json.loads(line)
    outline = Outline(vertices)
    began = time.process_time()
    cage = plan(outline, contacts, radius)
    spent = 1e3 * (time.process_time() - began)
    levels = [[cage.sigma_0, cage.sigma_first, cage.sigma_max]]
    levels += [[one.sigma, *one.contacts.ravel()] for one in (*cage.grasps, *cage.punctures)]
    print(json.dumps([spent, str(cage.status), levels]), flush=True)
"""


def worker(checkout: Path) -> subprocess.Popen[str]:
    """A process that plans what it is sent with the code of a checkout."""
    return subprocess.Popen(
        [sys.executable, "-c", _WORKER], cwd=checkout, stdin=subprocess.PIPE,
        stdout=subprocess.PIPE, text=True,
    )  # fmt: skip


def answer(of: subprocess.Popen[str], asked: str) -> Any:
    """Milliseconds, status and levels of one plan."""
    assert of.stdin is not None
    assert of.stdout is not None
    of.stdin.write(asked + "\n")
    of.stdin.flush()
    return json.loads(of.stdout.readline())


def difference(one: Any, other: Any) -> float:
    """Largest difference of two answers, inf if they are not of one shape."""
    if one[1] != other[1] or [len(r) for r in one[2]] != [len(r) for r in other[2]]:
        return np.inf
    a, b = (np.array([x for row in who[2] for x in row], dtype=float) for who in (one, other))
    return float(np.nan_to_num(np.abs(a - b)).max())


def main() -> int:
    """Command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("old", type=Path, help="the other checkout")
    parser.add_argument("--outlines", type=int, default=12, help="of each size")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    rng = np.random.default_rng(options.seed)
    workers = [worker(options.old), worker(Path(__file__).parents[1])]
    for n in SIZES:
        rows: list[list[float]] = []
        worst = 0.0
        for found in (pair(n, rng) for _ in range(options.outlines)):
            if found is None:
                continue
            outline, *contacts, radius = found
            asked = [
                json.dumps([outline.vertices.tolist(), np.asarray(one).tolist(), r])
                for one, r in zip(contacts, (0.0, radius), strict=True)
            ]
            times: list[list[float]] = []
            for _ in range(options.repeats):
                answers = [answer(who, one) for who in workers for one in asked]
                times.append([one[0] for one in answers])
                worst = max(worst, difference(answers[1], answers[3]))
            rows.append(np.median(times, axis=0).tolist())
        point_old, disc_old, point_new, disc_new = np.array(rows).T
        print(
            f"n {n}: there {np.median(point_old):.2f} and {np.median(disc_old):.2f} ms, here "
            f"{np.median(point_new):.2f} and {np.median(disc_new):.2f} ms, here / there "
            f"{np.median(disc_new / disc_old):.2f}, largest difference {worst:.2g}",
            flush=True,
        )
    for who in workers:
        who.communicate()
    return 0


if __name__ == "__main__":
    sys.exit(main())
