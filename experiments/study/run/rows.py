"""Trials as rows of a table: what is kept of each."""

from __future__ import annotations

from typing import Any

import numpy as np
import pyarrow as pa

from experiments.io.arrow_table import Column, Table
from experiments.study.run.shard import STUDY_OUTCOMES, Ran, Study
from icage.arrays import BoolArray, FloatArray
from icage.cells.membership import VERDICTS
from sim.closing.judge import OUTCOMES, TARGET


def table_of(study: Study, ran: Ran) -> Table:
    """A row per trial. Lengths in the case's unit, angles in [rad], forces in [closing force]."""
    count, sizes = len(ran.trials), ran.sizes
    closings, answers = ran.closings.closings, ran.answers
    lost = np.ones(count, dtype=np.bool_)
    lost[ran.done] = ran.outcome[ran.done] == OUTCOMES.index("diverged")

    def of_closings(values: Any) -> Column:
        whole = np.zeros(count, dtype=np.asarray(values).dtype)
        whole[ran.done] = values
        return pa.array(whole, mask=lost)

    columns: dict[str, Any] = {
        "trial": ran.trials,
        "seed": np.full(count, study.config.seed, dtype=np.uint64),
        **_pose("meant", ran.meant),
        **_pose("start", ran.starts),
        **{name: ran.values[name] for name in study.design.names},
        "verdict": pa.array([VERDICTS[k] for k in answers.verdict], pa.string()),
        "in_cage": answers.in_cage,
        "margin": _known(answers.margin),
        "target_margin": _known(answers.target_margin),
        "outcome": pa.array([STUDY_OUTCOMES[k] for k in ran.outcome], pa.string()),
        "grasp_id": ran.grasp_id,
        **{
            f"end_{name}": of_closings(closings.end[:, k])
            for k, name in enumerate(("x", "y", "theta", "sigma"))
        },
        "position_error": _known(ran.errors[:, 0] * sizes),
        "angle_error": _known(ran.errors[:, 1]),
        "peak_force": of_closings(ran.closings.peak_force),
        "penetration_max": of_closings(closings.penetration_max * sizes[ran.done]),
        "penetration_rest": of_closings(closings.penetration_rest * sizes[ran.done]),
        "steps": of_closings(closings.steps),
    }
    table: Table = pa.table(columns).cast(schema_of(study))
    return table


def schema_of(study: Study) -> Any:
    """Names and types of the columns, in their order."""
    pose = ("x", "y", "theta", "sigma")
    kinds = {
        "trial": pa.int64(), "seed": pa.uint64(), "verdict": pa.string(), "in_cage": pa.bool_(),
        "outcome": pa.string(), "grasp_id": pa.int64(), "steps": pa.int64(),
    }  # fmt: skip
    names = (
        "trial", "seed", *(f"meant_{k}" for k in pose), *(f"start_{k}" for k in pose),
        *study.design.names, "verdict", "in_cage", "margin", "target_margin", "outcome", "grasp_id",
        *(f"end_{k}" for k in pose), "position_error", "angle_error", "peak_force",
        "penetration_max", "penetration_rest", "steps",
    )  # fmt: skip
    return pa.schema([(name, kinds.get(name, pa.float64())) for name in names])


def _pose(prefix: str, placements: FloatArray) -> dict[str, Any]:
    names = ("x", "y", "theta", "sigma")
    return {
        f"{prefix}_{name}": np.ascontiguousarray(placements[:, k]) for k, name in enumerate(names)
    }


def _known(values: FloatArray) -> Column:
    """Numbers, null where there is none."""
    return pa.array(np.ascontiguousarray(values), mask=np.isnan(values))


def target_trials(table: Table) -> BoolArray:
    """(n,) whether each trial ended in the target."""
    words = table["outcome"].to_pylist()
    return np.array([word == OUTCOMES[TARGET] for word in words], dtype=np.bool_)
