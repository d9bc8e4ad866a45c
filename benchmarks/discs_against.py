"""Plans with disc fingers here and in another checkout, in turn: times, and whether answers differ.

    python -m benchmarks.discs_against OLD_CHECKOUT [--kinds 600]

Random stars as in ``benchmarks.discs``; with ``--kinds`` so many stars, blobs, gears and L brackets
in turn, of 5 to 70 vertices, with radii of 0.5 to 30 % of the diameter, disc plans alone. Two
processes, one in each checkout, plan each of them in turn; told are medians of processor time [ms]
of point and of disc plans, of disc plans here over there, and the largest difference of a level or
contact; of the kinds, how many answers differ (equal punctures may be shown at other hands).
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.discs import pair, star
from icage.errors import IcageError
from icage.kernels.compiled import machine_code_at_once
from icage.outline import Outline
from icage.planner import plan
from tests.oracles.geometry import Floats, Ring
from tests.oracles.targets import grasp_on

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


def of_kind(kind: int, rng: np.random.Generator) -> tuple[Floats, Floats, float] | None:
    """Vertices of a star, blob, gear or L bracket (0 to 3), contacts, and the discs' radius."""
    n = int(rng.integers(5, 71))
    if kind == 0:
        vertices = star(n, rng)
    elif kind == 3:
        (w, h), turn = rng.uniform(0.5, 2.0, 2), rng.uniform(0.0, 7.0)
        t = rng.uniform(0.15, 0.6) * min(w, h)
        corners = [0.0, w, w + 1j * t, t + 1j * t, t + 1j * h, 1j * h]
        z = np.array(corners) * np.exp(1j * turn)
        vertices = np.column_stack([z.real, z.imag])
    else:
        teeth = max(3, n // 4)
        angle = np.linspace(0.0, 2.0 * np.pi, n if kind == 1 else 4 * teeth, endpoint=False)
        waves = [(k, rng.uniform(0.0, 0.35 / k), rng.uniform(0.0, 7.0)) for k in (2, 3, 4, 5)]
        away = 1.0 + sum(high * np.cos(k * angle + at) for k, high, at in waves)
        if kind == 2:
            lean = rng.uniform(0.0, 0.3) / teeth
            away = np.tile([1.0, 1.0, 0.7, 0.7], teeth)
            angle = angle + np.tile([lean, -lean, 0.0, 0.0], teeth)
        vertices = np.column_stack([away * np.cos(angle), away * np.sin(angle)])
    ring = Ring.of(vertices)
    radius = float(np.exp(rng.uniform(np.log(0.005), np.log(0.3)))) * ring.diameter
    contacts = grasp_on(ring, rng, radius)
    if contacts is None:
        return None
    try:
        plan(Outline(vertices), contacts, radius)
    except IcageError:
        return None  # a contact in a pocket that the fingers cannot enter
    return vertices, contacts, radius


def compare_kinds(workers: list[subprocess.Popen[str]], count: int, seed: int) -> None:
    """Tell how many answers differ, and how far levels and contacts do at most."""
    rng = np.random.default_rng(seed)
    spent = np.zeros(2)
    tally = dict.fromkeys(("targets", "other statuses or counts", "other levels", "other hands"), 0)
    tries = 0
    while tally["targets"] < count and tries < 4 * count:
        found = of_kind(tries % 4, rng)
        tries += 1
        if found is None:
            continue
        vertices, contacts, radius = found
        asked = json.dumps([vertices.tolist(), contacts.tolist(), radius])
        one, other = (answer(who, asked) for who in workers)
        spent += [one[0], other[0]]
        tally["targets"] += 1
        if np.isinf(difference(one, other)):
            tally["other statuses or counts"] += 1
            continue
        heads = [[one[0], one[1], [row[: 3 if k == 0 else 1] for k, row in enumerate(one[2])]]
                 for one in (one, other)]  # fmt: skip
        if difference(*heads) > 1e-9:
            tally["other levels"] += 1
        elif difference(one, other) > 1e-8:
            tally["other hands"] += 1
    print(f"{tally}; there {spent[0] / 1e3:.1f} s, here {spent[1] / 1e3:.1f} s")


def main() -> int:
    """Command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("old", type=Path, help="the other checkout")
    parser.add_argument("--outlines", type=int, default=12, help="of each size")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kinds", type=int, default=0, help="targets of several kinds instead")
    options = parser.parse_args()
    rng = np.random.default_rng(options.seed)
    workers = [worker(options.old), worker(Path(__file__).parents[1])]
    if options.kinds:
        machine_code_at_once()
        compare_kinds(workers, options.kinds, options.seed)
    for n in () if options.kinds else SIZES:
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
