"""One call of ``icage study``: from what was given to results in a folder."""

from __future__ import annotations

import os
import sys
from argparse import Namespace
from collections.abc import Generator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from experiments.cases.case_files import ONE, check_case_files, write_case_files
from experiments.cases.chosen import Chosen, chosen
from experiments.cases.reading import reading_of, say_notes
from experiments.cases.with_discs import physical_case
from experiments.io.arrow_table import Table
from experiments.io.held_folder import held_folder
from experiments.io.options import check_folder
from experiments.io.pieces import cores
from experiments.io.progress import stage_bar
from experiments.io.versions import hint_of_code, said_of_code
from experiments.study.inputs.config import ConfigError, read_toml, study_config
from experiments.study.inputs.fields import DRAWING
from experiments.study.report.summary import sentence, summary
from experiments.study.run.announcement import announcement, warning
from experiments.study.run.document import differences, fingerprint, study_document, study_of
from experiments.study.run.folder import (
    JSON,
    PAGE,
    SHARDS,
    TRIALS,
    StudyFolder,
    read_document,
    write_document,
)
from experiments.study.run.rows import schema_of
from experiments.study.run.shard import Study
from experiments.study.run.shards import ON_A_CLUSTER, Backend, on_threads, run_study, shard_size
from icage.case import Case
from icage.formats.load import is_shipped, load
from icage.formats.whole_files import whole_file

MAP, RATES, INDICES = "map.svg", "rates.svg", "indices.svg"

REPLAY: Final = "replay.json"
"""What a replay writes, beside a table of the same name as ours."""


@dataclass(frozen=True, slots=True)
class Session:
    """A checked study and where it goes."""

    study: Study
    document: dict[str, Any]
    folder: StudyFolder
    shard: int | None
    chosen: Chosen | None = None
    """The grasp that was searched, for an object that came without one."""
    any_code: bool = False
    """What other code of the same version has computed is taken."""


def session_of(
    given: Mapping[str, Any],
    out: str | None,
    resume: bool,
    shard: int | None = None,
    any_code: bool = False,
) -> Session:
    """Check everything before anything runs; hold the folder meanwhile (``held``).

    Raises
    ------
    InputError:
        A field, the folder, or what is in it already does not fit.
    """
    if out is None:
        raise ConfigError("--out DIR is needed")
    path = Path(out)
    table = dict(given)
    drawing = Namespace(**{name: table.pop(name, None) for name in DRAWING})
    found: Chosen | None = None
    instead = table.pop("instead", None)
    if "case" in table and table["case"].lower().endswith(".toml"):
        table = _with_file(Path(table.pop("case")), table)
        if instead is not None:
            table["case"] = instead
    elif instead is not None:
        raise ConfigError(f"--case {instead!r} is for TOML files; CASE names the case")
    old = read_document(path)
    if old is None:
        _check_kind(out, path)
    if old is not None and not resume:
        raise ConfigError(
            f"--out {out!r} holds a study already; --resume goes on with it, or name another folder"
        )
    if old is None and resume and not table.get("case"):
        raise ConfigError(f"--out {out!r} holds no study to go on with")
    if old is not None and not table.get("case"):
        for name, value in vars(drawing).items():
            if value is not None:
                raise ConfigError(f"{name} is given without a CASE; repeat the whole command")
        study = study_of(old, _only_trials(table))
    else:
        if not table.get("case"):
            raise ConfigError("CASE is needed: a case file, a shipped object's name or a TOML file")
        case = _case(table, drawing)
        if case.target is None:
            check_case_files("--out", path, [ONE], case.sources)
            drawing.case = table["case"]
            found = chosen(case, drawing)
            (case,) = found.cases
            table["case"] = str(path / ONE)
        physical = physical_case(case)  # point fingers become discs; their radius bounds errors
        study = Study(study_config(table, physical.case), physical.case, physical.cage)
    document = study_document(study)
    if old is not None:
        lines = differences(old, document, any_code)
        if lines:
            hint = hint_of_code(old["versions"], document["versions"])
            raise ConfigError(f"--out {out!r} holds another study: {'; '.join(lines)}{hint}")
    document |= said_of_code(old, document, any_code)
    folder = StudyFolder(path, fingerprint(document), schema_of(study))
    folder.check()
    kept = folder.beyond(study.design.total)
    if kept:
        raise ConfigError(
            f"trials is {study.config.trials}, but --out {out!r} holds {kept} already, and none is "
            f"thrown away; {kept} or more is needed, or another folder"
        )
    return Session(study, document, folder, shard, found, any_code)


def _only_trials(table: Mapping[str, Any]) -> int | None:
    """What may be said of a study that goes on without being told again."""
    for name in table:
        if name != "trials":
            raise ConfigError(
                f"{name} is given without a CASE: only trials may be; for anything else repeat the "
                "whole command"
            )
    return table.get("trials")


def _with_file(path: Path, over: Mapping[str, Any]) -> dict[str, Any]:
    """The table of a TOML file; what the command line gives replaces it, input by input."""
    table = read_toml(path)
    vary = {**table.get("vary", {}), **over.get("vary", {})}
    merged = {**table, **over, "vary": vary}
    case = merged.get("case")
    if isinstance(case, str) and not is_shipped(case) and not Path(case).is_absolute():
        merged["case"] = str(path.parent / case)
    return merged


def _case(table: Mapping[str, Any], drawing: Namespace | None = None) -> Case:
    name, grasp = table["case"], table.get("grasp", 1)
    if not isinstance(name, str):
        raise ConfigError(f"case is {name!r}; a word is needed")
    which = grasp if isinstance(grasp, int) and not isinstance(grasp, bool) else None
    which = None if which == 1 else which
    if drawing is None:
        return load(name, grasp=which)
    case = load(
        name, grasp=which, finger_radius=drawing.finger_radius, **reading_of(drawing).given()
    )
    say_notes(case)
    return case


@contextmanager
def held(out: str | None) -> Generator[None]:
    """Make the folder of a study and hold it, so that what is checked there stays true.

    Two studies at once would take each other's shards for leftovers.

    Raises
    ------
    InputError:
        There is no such place, it cannot be written to, or another process holds it.
    """
    if out is None:
        raise ConfigError("--out DIR is needed")
    path = Path(out)
    check_folder("--out", path, (JSON, TRIALS, PAGE, MAP, RATES, INDICES))
    check_folder("--out", path / SHARDS)
    with held_folder(path, "study"):
        yield


def _check_kind(out: str, path: Path) -> None:
    """A folder without a study's document holds nothing that a study would take the place of."""
    for name in (TRIALS, REPLAY, PAGE, MAP, RATES, INDICES):
        if os.path.lexists(path / name):
            raise ConfigError(
                f"--out {out!r} holds {name}, but no {JSON}: it is of something else and is not "
                "replaced; name another folder"
            )


def run_session(
    session: Session, threads: int | None, scheduler: str | None, figures: bool
) -> list[str]:
    """Run what is missing and write all results; the lines to print. Inside ``held``."""
    backend = _backend(session, threads, scheduler)
    study, folder = session.study, session.folder
    total = study.design.total
    usual = ON_A_CLUSTER if scheduler else shard_size(total, threads or cores())
    size = session.shard or usual
    print(announcement(study, session.document), flush=True)
    doubt = warning(session.document)
    if doubt is not None:
        print(f"icage: warning: {doubt}", file=sys.stderr, flush=True)
    if session.chosen is not None:
        write_case_files(session.chosen, folder.path, ONE)
    write_document({**session.document, "finished": False}, folder.path)
    with stage_bar() as bar:
        table, length = run_study(
            study, folder, backend, size, lambda done, whole: bar("trials", done, whole)
        )
    found = summary(study.config, study.design, table, study.case.outline.diameter)
    stopped = {"early": length.early, "at": length.at, "why": length.why}
    document = {**session.document, "finished": True, "stopped": stopped, "found": found}
    write_document(document, folder.path)
    _write_page(document, folder.path)
    if figures:
        _draw(study, document, table, folder.path)
    name = study.case.name
    lines = [sentence(found, name)]
    counts = ", ".join(f"{k} {n.replace('_', ' ')}" for n, k in found["outcomes"].items() if k)
    lines.append(f"{length.at} of {total} trials ({length.why}): {counts}")
    lines.append(f"files in {folder.path}")
    return lines


def _backend(session: Session, threads: int | None, scheduler: str | None) -> Backend:
    if scheduler is None:
        return on_threads(threads or cores())
    from experiments.study.run.cluster import on_cluster

    return on_cluster(scheduler, session.document, session.any_code)


def _write_page(document: dict[str, Any], folder: Path) -> None:
    from experiments.study.report.results_md import results_page
    from experiments.study.run.command import command_line

    with whole_file(folder / PAGE) as part:
        part.write_text(results_page(document, command_line(document)), encoding="utf-8")


def _draw(study: Study, document: dict[str, Any], table: Table, folder: Path) -> None:
    from experiments.figures.plan import figure_regions
    from experiments.study.report.rate_figures import draw_indices, draw_map, draw_rates

    regions = figure_regions(study.cage)
    draw_map(document, table, study.cage, regions, folder / MAP)
    if document["found"]["variables"]:
        draw_rates(document, folder / RATES)
    if document["found"].get("indices", {}).get("groups"):
        draw_indices(document, folder / INDICES)
