"""``study.json``: a study as it can be run again, by another process or another machine."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Final

from experiments.cases.with_discs import physical_case
from experiments.io.changes import changes
from experiments.io.versions import CODE, versions
from experiments.study.inputs.config import StudyConfig, config_of
from experiments.study.run.shard import Study
from icage.case import Case
from icage.cells.membership import VERDICTS, query
from icage.errors import InputError
from icage.formats.case_json import parse_case

FORMAT: Final = "icage-study/1"

_MAY_GROW: Final = ("trials", "until_half_width")
"""A study may be resumed with other values of these: its trials are the same ones."""


def study_document(study: Study) -> dict[str, Any]:
    """Everything that decides the numbers of a study, JSON-ready."""
    case = study.case
    return {
        "format": FORMAT,
        "name": case.name,
        "unit": case.unit,
        "case": {
            "outline": {"vertices": case.outline.vertices.tolist()},
            "finger_radius": case.finger_radius,
            "contacts": case.contacts.tolist(),
        },
        "diameter": case.outline.diameter,
        "config": study.config.document(),
        "nominal": _nominal(study),
        "versions": versions(),
    }


def _nominal(study: Study) -> dict[str, Any] | None:
    """The placement that is meant and what the planner says of it; None if many are meant."""
    nominal = study.intended.nominal
    if nominal is None:
        return None
    answers = query(study.cage, nominal[None, :])
    margin = float(answers.margin[0])
    return {
        **dict(zip(("x", "y", "theta", "sigma"), nominal.tolist(), strict=True)),
        "verdict": VERDICTS[int(answers.verdict[0])],
        "in_cage": bool(answers.in_cage[0]),
        "margin": None if math.isnan(margin) else margin,
    }


def study_of(document: Mapping[str, Any], trials: int | None = None) -> Study:
    """The study of a document, planned afresh; with another number of trials if one is given.

    Raises
    ------
    InputError:
        It is no study's document, or its case is one that no study is made of: no cage, no discs.
    """
    case, config = parsed_document(document, trials)
    if not case.finger_radius:
        raise InputError("not a study's document: finger_radius 0; a study's case has discs")
    physical = physical_case(case)
    return Study(config, physical.case, physical.cage)


def parsed_document(
    document: Mapping[str, Any], trials: int | None = None
) -> tuple[Case, StudyConfig]:
    """Case and config of a document, every value checked as in a case file and in a TOML file.

    Raises
    ------
    InputError:
        A key is missing or unknown, or its value is not allowed.
    """
    check_format(document)
    try:
        given = document["case"]
        case = parse_case(
            {
                "format": "icage-case/1",
                "name": document["name"],
                "unit": document["unit"],
                "outline": {"vertices": given["outline"]["vertices"]},
                "finger_radius": given["finger_radius"],
                "grasp": {"contacts": given["contacts"]},
            },
            Path(),
        )
        plain = dict(document["config"])
        if trials is not None:
            plain["trials"] = trials
        config = config_of(plain, case)
        for name, version in document["versions"].items():
            if not isinstance(name, str) or not isinstance(version, str):
                raise InputError(f"versions: {name} is {version!r}; a word is needed")
    except (KeyError, TypeError, ValueError, AttributeError, IndexError) as error:
        raise InputError(f"not a study's document: {error!r}") from error
    return case, config


def check_format(document: Mapping[str, Any]) -> None:
    """Refuse what is no study's document.

    Raises
    ------
    InputError:
        It has another format.
    """
    if document.get("format") != FORMAT:
        raise InputError(f"format {document.get('format')!r}; {FORMAT!r} is needed")


def fingerprint(document: Mapping[str, Any]) -> str:
    """What two shards of one study have in common: config, case and versions, not its length.

    Nor its code: a study goes on with other code if it is told to, and says so.
    """
    config = {k: v for k, v in document["config"].items() if k not in _loose(document)}
    kept = {key: document[key] for key in ("name", "unit", "case")}
    kept["versions"] = {k: v for k, v in document["versions"].items() if k != CODE}
    text = json.dumps({**kept, "config": config}, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()


def _loose(document: Mapping[str, Any]) -> tuple[str, ...]:
    """Fields that may differ: the case is compared itself, not by its name on the disk.

    Saltelli's design hangs on the number of trials.
    """
    grows = () if document["config"]["sampling"] == "saltelli" else _MAY_GROW
    return ("case", "grasp", *grows)


def differences(
    old: Mapping[str, Any], new: Mapping[str, Any], any_code: bool = False
) -> list[str]:
    """Why a study cannot go on with another's shards, in words.

    Raises
    ------
    InputError:
        The old one is no study's document.
    """
    check_format(old)
    lines: list[str] = []
    try:
        lines += _differences(old, new, (CODE,) if any_code else ())
    except (KeyError, TypeError, AttributeError) as error:
        raise InputError(f"not a study's document: {error!r}") from error
    return lines


def _differences(
    old: Mapping[str, Any], new: Mapping[str, Any], free: tuple[str, ...]
) -> Iterator[str]:
    yield from changes(old["config"], new["config"], _loose(new))
    if old["name"] != new["name"]:
        yield f"the case was {old['name']!r}, is {new['name']!r}"
    if old["case"] != new["case"] or old["unit"] != new["unit"]:
        yield "the case is another one"
    yield from changes(old["versions"], new["versions"], free, str)
