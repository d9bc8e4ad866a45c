"""The film of one recorded trial: the replay's film with a single clip."""

from __future__ import annotations

from pathlib import Path

from experiments.io.progress import stage_bar
from experiments.replay.recorded import Rerun, recorded_cage, recorded_regions
from experiments.replay.run import Recorded, Replay, Run
from experiments.replay.video import film
from icage.case import Case
from icage.formats.whole_files import whole_file
from icage.sampling import Starts


def film_trial(done: Rerun, path: Path, camera: bool | None = None) -> None:
    """Write the film; ``camera`` as in ``experiments.replay.video.film``.

    Unlike the closing that is compared, the film also simulates the free travel before the first
    touch: its last frame may differ from the record by rounding, about 1e-9 of the diameter.
    """
    trial, row = done.trial, done.trial.row
    cage = recorded_cage(trial)
    case = Case(row["grasp"], trial.run["unit"], trial.outline, cage.finger_radius, cage.contacts)
    starts = Starts(done.closings.start, 1)
    recorded = Recorded(trial.index, row["verdict"], row["set"] != "outside")
    run = Run(
        case, cage, cage, done.scene, row["set"], starts, done.closings, done.verdicts, recorded
    )
    with stage_bar() as report, whole_file(path) as part:
        replay = Replay((run,), row["seed"])
        film(replay, case.name, {case.name: recorded_regions(trial)}, part, report, camera)
