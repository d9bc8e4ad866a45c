"""One trial of a study, run again from its number, compared with its row, and filmed."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from experiments.io.progress import stage_bar
from experiments.io.versions import versions
from experiments.replay.recorded_trial import RecordingError
from experiments.replay.what_is_filmed import filmed_alone
from experiments.study.run.document import fingerprint, study_of
from experiments.study.run.folder import StudyFolder, read_document
from experiments.study.run.rows import schema_of, table_of
from experiments.study.run.shard import Ran, Study, run_trials
from experiments.study.run.worlds import worlds_of
from icage.arrays import FloatArray
from icage.formats.whole_files import whole_file
from sim.closing.judge import OUTCOMES
from sim.closing.varied import Worlds, own_model, settings
from sim.world.scene import Scene


@dataclass(frozen=True, slots=True, eq=False)
class StudyRerun:
    """A recorded trial, run again; ``differences`` are (what, recorded, now)."""

    index: int
    study: Study
    ran: Ran
    recorded: dict[str, Any]
    now: dict[str, Any]
    differences: tuple[tuple[str, Any, Any], ...]
    other_versions: dict[str, tuple[str, str]]


def rerun_trial(folder: Path, index: int) -> StudyRerun:
    """Run trial ``index`` of the study in a folder again; it need not be finished.

    Raises
    ------
    RecordingError:
        The trial is not there.
    """
    document = read_document(folder)
    if document is None:
        raise RecordingError(f"{str(folder)!r} holds no study")
    study = study_of(document)
    recorded = _row(StudyFolder(folder, fingerprint(document), schema_of(study)), index)
    ran = run_trials(study, np.array([index]))
    now: dict[str, Any] = table_of(study, ran).to_pylist()[0]
    found = tuple((n, recorded.get(n), v) for n, v in now.items() if recorded.get(n) != v)
    return StudyRerun(index, study, ran, recorded, now, found, _versions(document))


def _versions(document: Mapping[str, Any]) -> dict[str, tuple[str, str]]:
    was, here = document.get("versions", {}), versions()
    names = sorted({*was, *here})
    pairs = {n: (was.get(n, "none"), here.get(n, "none")) for n in names}
    return {n: pair for n, pair in pairs.items() if pair[0] != pair[1]}


def _row(folder: StudyFolder, index: int) -> dict[str, Any]:
    """The recorded row of a trial, from the table or from a shard."""
    row = folder.row(index)
    if row is None:
        raise RecordingError(
            f"{str(folder.path)!r} has no trial {index}; it has {folder.count()}, counted from 0"
        )
    return row


def film_rerun(done: StudyRerun, path: Path, camera: bool | None = None) -> None:
    """Film the trial, free travel included; ``camera`` as in ``experiments.replay.video.film``.

    Raises
    ------
    RecordingError:
        The trial was never closed.
    """
    from experiments.figures.plan import figure_regions
    from experiments.replay.video import film_alone

    study, ran = done.study, done.ran
    if not len(ran.done):
        raise RecordingError(
            f"trial {done.index} was not closed ({done.now['outcome']}): there is nothing to film"
        )
    variant = ran.variants[int(ran.which[0])]
    scene = filmed_scene(variant.scene, worlds_of(ran.values, ran.starts, ran.sizes))
    one = filmed_alone(
        done.index,
        study.case.name,
        study.cage,
        scene,
        ran.closings.closings.start[0],
        OUTCOMES[int(ran.outcome[0])],
        done.now["verdict"],
        done.now["in_cage"],
    )
    with stage_bar() as report, whole_file(path) as part:
        film_alone(one, figure_regions(study.cage), part, report, camera)


def filmed_scene(scene: Scene, worlds: Worlds) -> Scene:
    """A scene whose own model is that of one trial: settings that the engine reads are in it, and
    the force with which it is closed.
    """
    force, speed = float(worlds.force[0]), float(worlds.speed[0])
    config = replace(
        scene.config,
        drive_force=scene.config.drive_force * force,
        finger_damping=scene.config.finger_damping * force / speed,
    )
    stronger = Scene(scene.outline, scene.hand, scene.finger_radius, config, scene.instrumented)
    changes = list(settings(stronger, _over(worlds, force)))
    mine = copy.copy(stronger)
    object.__setattr__(mine, "model", own_model(stronger.model, changes, 0))
    return mine


def _over(worlds: Worlds, force: float) -> Worlds:
    """The same world told in units of a closing force that is larger; speed and force are in it."""
    ones: FloatArray = np.ones(1)
    return replace(
        worlds,
        table_friction=worlds.table_friction / force,
        gravity_x=worlds.gravity_x / force,
        gravity_y=worlds.gravity_y / force,
        speed=ones,
        force=ones,
    )


def outcome_words(done: StudyRerun) -> str:
    """The outcome with the grasp, for a reader."""
    word = str(done.now["outcome"]).replace("_", " ")
    grasp = done.now["grasp_id"]
    return f"{word} (grasp {grasp})" if done.now["outcome"] == OUTCOMES[1] else word
