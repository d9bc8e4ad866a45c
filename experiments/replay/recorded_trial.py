"""A recorded trial: read back from the folder of a replay and closed once more.

A row of ``trials.parquet`` has the start, ``replay.json`` the object, the hand and the settings of
its run, in doubles that read back as the same bits. So on the same versions and the same kind of
machine a trial repeats to the last bit, alone or among a thousand.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, ParamSpec, TypeVar, cast

import shapely

from experiments.io.arrow_table import Table
from experiments.io.own_files import own_json
from experiments.io.parquet_files import read_table, rows_and_words, words_of
from experiments.io.versions import versions
from icage.arrays import FloatArray
from icage.cage import Cage, CageStatus, GraspMinimum
from icage.cells.regions import FingerRegion
from icage.checks import a_count, a_number, an_instance
from icage.errors import InputError
from icage.formats.json_text import points
from icage.hand import HandShape, Placement
from icage.outline import Outline
from icage.staging import sweep
from sim.closing.batch import close_many
from sim.closing.judge import OUTCOMES, Verdicts, judge
from sim.closing.outcome import ClosingOutcomes
from sim.world.config import SimConfig
from sim.world.scene import Scene

JSON, TRIALS = "replay.json", "trials.parquet"

STUDY: Final = "study.json"
"""What a study writes, beside a table of the same name as ours."""

FORMAT: Final = "icage-replay/1"
TABLE_FORMAT: Final = b"icage-trials/1"

_POSE = ("x", "y", "theta", "sigma")

_COLUMNS: Final = (
    "run", "grasp", "set", "trial", "seed", "verdict", "outcome", "grasp_id", "steps",
    *(f"start_{name}" for name in _POSE), *(f"end_{name}" for name in _POSE),
    "position_error", "angle_error", "penetration_max", "penetration_rest",
)  # fmt: skip
"""Of a trial, as far as it is closed again and compared."""

_BEFORE: Final = {"remains": 0.0, "computed_contacts": 0}
"""Settings that a replay recorded before there were such did not have."""

_LARGEST: Final = 1_000_000_000
"""[byte] Largest file read."""


class RecordingError(InputError):
    """A folder does not hold a recorded replay that can be run again."""


@dataclass(frozen=True, slots=True)
class RecordedTrial:
    """One row of a replay, with everything needed to close it again.

    Attributes
    ----------
    index:
        Row in the whole table.
    row:
        The table's columns; None where a diverged closing left no number.
    run:
        The run's document in ``replay.json``.
    recorded_versions:
        Versions that recorded it.
    """

    index: int
    row: dict[str, Any]
    run: dict[str, Any]
    recorded_versions: dict[str, str]
    outline: Outline
    hand: HandShape
    config: SimConfig

    @property
    def start(self) -> Placement:
        """Where the hand stood."""
        return Placement(*(self.row[f"start_{name}"] for name in _POSE))

    @property
    def unit(self) -> str:
        """Of lengths, as the case has it."""
        return an_instance(self.run["unit"], str, "unit")

    @property
    def scene(self) -> Scene:
        """Object and hand, compiled afresh."""
        return Scene(self.outline, self.hand, self.run["plan"]["finger_radius"], self.config)

    @property
    def grasps(self) -> tuple[GraspMinimum, ...]:
        """The grasps of the recorded plan, the target first."""
        sigma_0 = a_number(self.run["plan"]["sigma_0"], "sigma_0")
        return tuple(_grasp(grasp, sigma_0) for grasp in self.run["plan"]["grasps"])

    @property
    def other_versions(self) -> dict[str, tuple[str, str]]:
        """Name to (recorded, here) of the versions that differ."""
        now = versions()
        names = sorted({*now, *self.recorded_versions})
        pairs = {n: (self.recorded_versions.get(n, "none"), now.get(n, "none")) for n in names}
        return {n: pair for n, pair in pairs.items() if pair[0] != pair[1]}


@dataclass(frozen=True, slots=True)
class Rerun:
    """A recorded trial, closed again; ``differences`` are (what, recorded, now)."""

    trial: RecordedTrial
    scene: Scene
    closings: ClosingOutcomes
    verdicts: Verdicts
    differences: tuple[tuple[str, Any, Any], ...]

    @property
    def other_versions(self) -> dict[str, tuple[str, str]]:
        """Versions that differ from the recorded ones."""
        return self.trial.other_versions

    @property
    def identical(self) -> bool:
        """Whether everything recorded came out again, bit for bit."""
        return not self.differences


def read_trial(folder: Path, index: int) -> RecordedTrial:
    """Row ``index`` (0-based, over all runs) of the replay in a folder.

    Raises
    ------
    RecordingError:
        No replay is there, it was recorded before outlines were kept, or it has no such row.
    """
    sweep(folder)  # a replay that died while its files took their places
    document = _document(folder / JSON)
    table = _table(folder / TRIALS)
    if not 0 <= index < table.num_rows:
        raise RecordingError(
            f"{str(folder)!r} has no trial {index}; it has {table.num_rows}, counted from 0"
        )
    missing = [name for name in _COLUMNS if name not in table.column_names]
    if missing:
        raise RecordingError(f"{str(folder / TRIALS)!r} has no column {missing[0]!r}")
    row: dict[str, Any] = table.slice(index, 1).to_pylist()[0]
    try:
        run = document["runs"][row["run"]]
        if "outline" not in run or "config" not in run:
            raise RecordingError(
                f"{str(folder / JSON)!r} was recorded before outline and settings were kept in it; "
                "replay the case once more"
            )
        kept: dict[str, Any] = {
            **_BEFORE,
            **run["config"],
            "solimp": tuple(run["config"]["solimp"]),
        }
        config = SimConfig(**kept)
        x, y = run["plan"]["hand"]["unit_fingers"][2]
        trial = RecordedTrial(
            index, row, run, dict(document["versions"]),
            Outline(run["outline"]["vertices"]), HandShape(complex(x, y)), config,
        )  # fmt: skip
        # what is wrong with what is made of it later is said here
        if not trial.grasps:
            raise RecordingError(f"{str(folder / JSON)!r} is not a replay: a run without grasps")
        _ = trial.start, a_number(run["plan"]["finger_radius"], "finger_radius"), trial.unit
        _ = recorded_cage(trial), recorded_regions(trial)
        return trial
    except RecordingError:
        raise
    except InputError as error:
        raise RecordingError(f"{str(folder / JSON)!r} is not a replay: {error}") from error
    except (KeyError, IndexError, TypeError, ValueError, shapely.errors.ShapelyError) as error:
        raise RecordingError(f"{str(folder / JSON)!r} is not a replay: {error!r}") from error


def rerun(trial: RecordedTrial) -> Rerun:
    """Close and judge the trial again, and compare with what was recorded."""
    scene = trial.scene
    closings = close_many(scene, trial.start.as_array()[None, :], threads=1)
    friction = trial.config.friction > 0.0
    verdicts = judge(closings, trial.grasps, trial.outline, friction=friction)
    return Rerun(trial, scene, closings, verdicts, tuple(_differences(trial, closings, verdicts)))


def _differences(
    trial: RecordedTrial, closings: ClosingOutcomes, verdicts: Verdicts
) -> Iterator[tuple[str, Any, Any]]:
    """What is not the same to the last bit."""
    row, size = trial.row, trial.outline.diameter
    outcome = OUTCOMES[int(verdicts.outcome[0])]
    now: dict[str, Any] = {
        "outcome": outcome,
        "grasp_id": int(verdicts.grasp_id[0]),
        "steps": int(closings.steps[0]),
    }
    if outcome != "diverged":  # what a diverged closing leaves means nothing
        now |= {f"end_{n}": float(v) for n, v in zip(_POSE, closings.end[0], strict=True)}
        now |= {
            "position_error": float(verdicts.position_error[0] * size),
            "angle_error": float(verdicts.angle_error[0]),
            "penetration_max": float(closings.penetration_max[0] * size),
            "penetration_rest": float(closings.penetration_rest[0] * size),
        }
    for name, value in now.items():
        if row[name] != value:
            yield name, row[name], value


def recorded_cage(trial: RecordedTrial) -> Cage:
    """The recorded answer as a ``Cage`` for drawing; it answers no queries."""
    plan = trial.run["plan"]
    return Cage(
        outline=trial.outline,
        hand=trial.hand,
        finger_radius=plan["finger_radius"],
        contacts=_contacts(plan["contacts"]),
        status=CageStatus(plan["verdict"]),
        why=plan.get("why"),
        sigma_0=a_number(plan["sigma_0"], "sigma_0"),
        sigma_first=_level(plan, "sigma_first"),
        sigma_max=_level(plan, "sigma_max"),
        grasps=trial.grasps,
    )


def recorded_regions(trial: RecordedTrial) -> tuple[FingerRegion, ...]:
    """The caging regions kept with the plan."""
    plan = trial.run["plan"]
    highest = _level(plan, "sigma_max")
    return tuple(
        FingerRegion(
            a_count(region["finger"], "finger of a region"),
            an_instance(region["level"], str, "level of a region"),
            math.inf if highest is None else highest,
            region["bound"],
            a_number(region["area_gap"], "area_gap of a region"),
            shapely.MultiPolygon([(p["outer"], p["holes"]) for p in region["polygons"]]),
        )
        for region in plan["regions"]
    )


def _grasp(grasp: Any, sigma_0: float) -> GraspMinimum:
    grasp = cast("dict[str, Any]", an_instance(grasp, dict, "a grasp"))
    ends = grasp.get("plateau")
    return GraspMinimum(
        id=a_count(grasp["id"], "id of a grasp", 0),
        target=an_instance(grasp["target"], bool, "target of a grasp"),
        sigma=a_number(grasp["sigma_0"], "sigma_0 of a grasp"),
        contacts=_contacts(grasp["contacts"]),
        plateau=None if ends is None else (_contacts(ends[0]), _contacts(ends[1])),
        free_fingers=tuple(a_count(k, "a free finger") for k in grasp["free_fingers"]),
        joined_at=sigma_0,
    )


def _level(plan: dict[str, Any], name: str) -> float | None:
    return None if plan[name] is None else a_number(plan[name], name)


def _contacts(rows: Any) -> FloatArray:
    return points(rows, "contacts", least=3, most=3)


def _document(path: Path) -> dict[str, Any]:
    document = own(own_json, path, _LARGEST)
    found = document.get("format")
    if found != FORMAT:
        raise RecordingError(f"{str(path)!r} has format {found!r}; {FORMAT!r} is needed")
    return document


def _table(path: Path) -> Table:
    table = own(read_table, path)
    if words_of(table).get(b"format") != TABLE_FORMAT:
        raise RecordingError(f"{str(path)!r} is no table of a replay")
    return table


Given = ParamSpec("Given")
Found = TypeVar("Found")


def own(read: Callable[Given, Found], *given: Given.args, **named: Given.kwargs) -> Found:
    """What is read of a file of a replay; whatever is wrong with it is the recording's fault.

    Raises
    ------
    RecordingError:
        It cannot be read, or is not as it was written.
    """
    try:
        return read(*given, **named)
    except InputError as error:
        raise RecordingError(str(error)) from error


def check_kind(option: str, folder: Path, names: Sequence[str]) -> None:
    """Refuse a folder in which a replay would take the place of anything but a replay.

    ``names`` are the files that it writes there.

    Raises
    ------
    InputError:
        One of them is there without a replay's document, or with a table that is of no replay.
    """
    there = [name for name in (STUDY, *names) if os.path.lexists(folder / name)]
    if not there:
        return
    if STUDY in there or JSON not in there:
        raise InputError(
            f"{option} {str(folder)!r} holds {there[0]}, which no replay has written; name another "
            "folder, or move it away"
        )
    _document(folder / JSON)
    if TRIALS in there:
        _, words = own(rows_and_words, folder / TRIALS)
        if words.get(b"format") != TABLE_FORMAT:
            raise InputError(
                f"{option} {str(folder)!r} holds {TRIALS}, which no replay has written; name "
                "another folder, or move it away"
            )
