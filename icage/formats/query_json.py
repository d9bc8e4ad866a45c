"""Answers about placements as the document ``icage-query/1``, and as lines to read."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from icage.cells.membership import ESCAPES, VERDICTS, Answers

_SHOWN = 20
"""Rows of a summary; the rest is counted."""


def query_document(answers: Answers) -> dict[str, Any]:
    """One result a placement, in order; lengths in the case's unit."""
    columns = zip(
        answers.verdict.tolist(),
        answers.sigma.tolist(),
        answers.margin.tolist(),
        answers.target_margin.tolist(),
        answers.in_cage.tolist(),
        strict=True,
    )
    results = [
        {
            "verdict": VERDICTS[verdict],
            "sigma": sigma,
            "margin": _or_null(margin),
            "target_margin": _or_null(target_margin),
            "grasps": answers.grasps_of(row),
            "in_cage": in_cage,
        }
        for row, (verdict, sigma, margin, target_margin, in_cage) in enumerate(columns)
    ]
    return {"format": "icage-query/1", "results": results}


def query_summary(answers: Answers, unit: str) -> Iterator[str]:
    """How many placements have which verdict, and the first of them."""
    verdicts = [VERDICTS[code] for code in answers.verdict.tolist()]
    counted = ", ".join(f"{verdicts.count(name)} {name}" for name in VERDICTS)
    yield f"{len(verdicts)} placements: {counted}"
    for row, verdict in enumerate(verdicts[:_SHOWN]):
        opening = _opening(answers, row, unit)
        yield f"{row + 1:>6}  {verdict:<9}  sigma {answers.sigma[row]:.6g} {unit}{opening}"
    if len(verdicts) > _SHOWN:
        yield f"   ...  {len(verdicts) - _SHOWN} more (all of them with --json)"


def _opening(answers: Answers, row: int, unit: str) -> str:
    """How much further the hand may open from there: no room for it to stand elsewhere."""
    if answers.verdict[row] >= ESCAPES:
        return ""
    margin, first = float(answers.margin[row]), float(answers.target_margin[row])
    if math.isnan(margin):
        words = ", however far it opens the object cannot escape"
    else:
        words = f", may open by {margin:.6g} {unit} before the object can escape"
    if not math.isnan(first):
        words += f", by {first:.6g} {unit} before closing may end elsewhere"
    return words


def _or_null(value: float) -> float | None:
    return None if math.isnan(value) else value
