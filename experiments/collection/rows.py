"""Objects as rows of the table: one a grasp, or one that says why there is none."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Final, TypeAlias

import numpy as np
import pyarrow as pa

from experiments.cases.chosen import SEARCHED
from experiments.cases.free_gap import free_gap
from experiments.collection.objects import Readable, Unreadable, reason
from experiments.collection.options import SearchOptions
from experiments.io.arrow_table import Table
from icage.cage import Cage
from icage.grasps.crew import Progress
from icage.grasps.of_case import best_of_case
from icage.grasps.planned import PlannedGrasps

Row: TypeAlias = dict[str, Any]

_CONTACTS: Final = tuple((f"x_{k}", f"y_{k}") for k in (1, 2, 3))

COLUMNS: Final = pa.schema(
    [
        ("file", pa.string()),
        ("digest", pa.string()),
        ("seed", pa.int64()),
        ("name", pa.string()),
        ("unit", pa.string()),
        ("vertices", pa.int32()),
        ("diameter", pa.float64()),
        ("finger_radius", pa.float64()),
        ("rank", pa.int32()),
        ("score", pa.float64()),
        ("sigma_0", pa.float64()),
        ("sigma_first", pa.float64()),
        ("sigma_max", pa.float64()),
        ("verdict", pa.string()),
        ("phi_1_deg", pa.float64()),
        ("phi_2_deg", pa.float64()),
        *((name, pa.float64()) for pair in _CONTACTS for name in pair),
        ("free_gap", pa.float64()),
        ("alike", pa.int32()),
        ("compared", pa.int64()),
        ("triples_left_out", pa.int64()),
        ("searches_broken_off", pa.int64()),
        ("ended", pa.string()),
        ("why", pa.string()),
    ]
)
"""The table's columns, in their order; what a row has not is null."""


def table_of(rows: Iterable[Row]) -> Table:
    """Rows as a table."""
    table: Table = pa.Table.from_pylist(list(rows), schema=COLUMNS)
    return table


def unreadable_row(one: Unreadable) -> Row:
    """The row of a file without an object."""
    return {"file": one.file, "digest": one.digest, "seed": one.seed, "why": one.why}


def searched_rows(
    one: Readable,
    options: SearchOptions,
    progress: Progress | None = None,
) -> list[Row]:
    """The best grasps of an object, as ``icage grasps`` finds them with this seed.

    Raises
    ------
    KeyboardInterrupt:
        The search was interrupted: what it has is not what it would have found.
    """
    case = one.case
    known: Row = {
        "file": one.file, "digest": one.digest, "seed": one.seed, "name": case.name,
        "unit": case.unit, "vertices": len(case.outline), "diameter": case.outline.diameter,
        "finger_radius": case.finger_radius,
    }  # fmt: skip
    rng, most = np.random.default_rng(one.seed), max(SEARCHED, options.top)
    try:
        planned = best_of_case(case, most, options.wanted, rng, 1, progress, options.seconds)
    except Exception as error:
        return [{**known, "why": reason(error)}]
    if planned.ended == "interrupted":
        raise KeyboardInterrupt
    known |= {
        "compared": planned.compared, "triples_left_out": planned.triples_left_out,
        "searches_broken_off": planned.searches_broken_off, "ended": planned.ended,
    }  # fmt: skip
    if not planned.cages:
        return [{**known, "why": _no_cage(planned)}]
    best = zip(planned.cages[: options.top], planned.scores, planned.alike, strict=False)
    return [
        {**known, "rank": rank, "alike": alike, "score": score, **_grasp(cage)}
        for rank, (cage, score, alike) in enumerate(best, 1)
    ]


def _no_cage(planned: PlannedGrasps) -> str:
    return f"none of {planned.compared} grasps compared is a cage ({planned.reason_words()})"


def _grasp(cage: Cage) -> Row:
    places = zip(_CONTACTS, cage.contacts.tolist(), strict=True)
    return {
        "sigma_0": cage.sigma_0,
        "sigma_first": cage.sigma_first,
        "sigma_max": cage.sigma_max,
        "verdict": cage.status,
        **dict(zip(("phi_1_deg", "phi_2_deg"), cage.hand.phi_deg, strict=True)),
        **{name: x for names, point in places for name, x in zip(names, point, strict=True)},
        "free_gap": free_gap(cage),
    }
