"""What a replay leaves behind: replay.json, trials.parquet, regions.svg, replay.mp4.

They are written into a ``whole_folder``, so that a run that fails or is interrupted leaves nothing
behind.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

import numpy as np
import pyarrow as pa

from experiments.figures.plan import draw_plan, figure_regions
from experiments.io.arrow_table import Column, Table
from experiments.io.parquet_files import words_of, write_table
from experiments.io.versions import versions
from experiments.replay.run import Replay, Report, Run, run_document
from icage.cells.membership import VERDICTS, query
from icage.cells.regions import FingerRegion
from icage.formats.json_out import write_json
from icage.formats.plan_json import plan_document
from sim.closing.judge import OUTCOMES

JSON, TRIALS, REGIONS, VIDEO = "replay.json", "trials.parquet", "regions.svg", "replay.mp4"
ALL: Final = (JSON, TRIALS, REGIONS, VIDEO)


def write_results(
    done: Replay, name: str, regions: dict[str, tuple[FingerRegion, ...]], folder: Path
) -> dict[str, Any]:
    """Everything but the video; returns the document of ``replay.json``.

    ``regions`` are those a figure shows, by the name of the grasp.
    """
    first = done.runs[0]
    document = replay_document(done, name, regions)
    write_json(document, str(folder / JSON))
    table = trial_table(done)
    write_table(table, folder / TRIALS, words_of(table))
    draw_plan(
        first.cage, regions[first.case.name], first.case.name, first.case.unit, folder / REGIONS
    )
    return document


def regions_by_grasp(
    done: Replay, report: Report | None = None
) -> dict[str, tuple[FingerRegion, ...]]:
    """The regions a figure shows, once per grasp."""
    cages = {run.case.name: run.cage for run in done.runs}
    regions: dict[str, tuple[FingerRegion, ...]] = {}
    for number, (name, cage) in enumerate(cages.items()):
        if report is not None:
            report("regions", number, len(cages))
        regions[name] = figure_regions(cage)
    return regions


def replay_document(
    done: Replay, name: str, regions: dict[str, tuple[FingerRegion, ...]]
) -> dict[str, Any]:
    """The document ``icage-replay/1``; the keys of the first run stand at the top level too."""
    runs: list[dict[str, Any]] = []
    for run in done.runs:
        level = "all" if run.cage.sigma_max is None else "sigma_max"
        shown = [r for r in regions[run.case.name] if r.level_name == level]
        runs.append(run_document(run, plan_document(run.cage, shown, run.case.name, run.case.unit)))
    return {
        "format": "icage-replay/1",
        "name": name,
        "seed": done.seed,
        "versions": versions(),
        "passed": not done.failures,
        **{**runs[0], "failures": list(done.failures)},
        "skipped": list(done.skipped),
        "runs": runs,
    }


def trial_table(done: Replay) -> Table:
    """A row per trial. Lengths in the case's unit, angles in [rad], in the object's frame."""
    tables = [_run_table(number, run, done.seed) for number, run in enumerate(done.runs)]
    table = pa.concat_tables(tables)
    words = {"format": "icage-trials/1", "unit": done.runs[0].case.unit, **versions()}
    return table.replace_schema_metadata(words)


def _run_table(number: int, run: Run, seed: int) -> Table:
    count, size = len(run.closings), run.case.outline.diameter
    verdict = query(run.cage, run.starts.placements).verdict
    diverged = np.flatnonzero(run.verdicts.outcome == OUTCOMES.index("diverged"))
    columns: dict[str, Any] = {
        "run": np.full(count, number),
        "grasp": pa.array([run.case.name] * count).dictionary_encode(),
        "set": pa.array([run.which] * count).dictionary_encode(),
        "trial": np.arange(count),
        "seed": np.full(count, seed, dtype=np.uint64),
        **_pose("start", run.closings.start, ()),
        "verdict": pa.array([VERDICTS[k] for k in verdict]).dictionary_encode(),
        "outcome": pa.array([OUTCOMES[k] for k in run.verdicts.outcome]).dictionary_encode(),
        "grasp_id": run.verdicts.grasp_id,
        **_pose("end", run.closings.end, diverged),
        "position_error": _known(run.verdicts.position_error * size, diverged),
        "angle_error": _known(run.verdicts.angle_error, diverged),
        "grasp_position_error": _known(run.verdicts.grasp_position_error * size, diverged),
        "grasp_angle_error": _known(run.verdicts.grasp_angle_error, diverged),
        "penetration_max": _known(run.closings.penetration_max * size, diverged),
        "penetration_rest": _known(run.closings.penetration_rest * size, diverged),
        "steps": run.closings.steps,
    }
    return pa.table(columns)


def _pose(prefix: str, placements: np.ndarray, diverged: Any) -> dict[str, Any]:
    names = ("x", "y", "theta", "sigma")
    return {
        f"{prefix}_{name}": _known(column, diverged)
        for name, column in zip(names, placements.T, strict=True)
    }


def _known(values: np.ndarray, diverged: Any) -> Column:
    """The values, null where a diverged closing left none."""
    mask = np.zeros(len(values), dtype=np.bool_)
    mask[list(diverged)] = True
    return pa.array(np.ascontiguousarray(values), mask=mask)
