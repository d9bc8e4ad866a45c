"""What a study says before it runs: its size, and the planner's word on the nominal placement."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from experiments.io.outcome_words import VERDICT_WORDS
from experiments.study.report.names import number
from experiments.study.run.shard import Study


def announcement(study: Study, document: Mapping[str, Any]) -> str:
    """One line; ``document`` is the study's own."""
    design = study.design
    what = ", ".join(design.names) or "nothing but the start"
    line = f"{study.case.name}: {design.total} trials, varying {what}, seed {study.config.seed}"
    if design.groups:
        base = design.total // (len(design.groups) + 2)
        line += (
            f"; Saltelli's design, {base} base points x ({len(design.groups)} groups + 2) = "
            f"{design.total} runs"
        )
    if document["nominal"] is not None:
        line += f"; nominal placement: {nominal_words(document)}"
    return line


def nominal_words(document: Mapping[str, Any]) -> str:
    """The planner's verdict of the nominal placement, and how far the hand may open from there."""
    one = document["nominal"]
    words = VERDICT_WORDS[one["verdict"]]
    if one["verdict"] in ("escapes", "collision"):
        return words
    if one["margin"] is None:
        return f"{words}; it escapes at no opening"
    opening = f"{number(one['margin'])} {document['unit']}"
    return f"{words}; the hand may open by {opening} before the object can escape"


def warning(document: Mapping[str, Any]) -> str | None:
    """Why the nominal placement is hardly the one that was meant; None if it is in the cage."""
    one = document["nominal"]
    if one is None or one["in_cage"]:
        return None
    return f"the nominal placement is not in the target's cage: {VERDICT_WORDS[one['verdict']]}"
