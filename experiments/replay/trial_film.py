"""The film of one recorded trial."""

from __future__ import annotations

from pathlib import Path

from experiments.io.progress import stage_bar
from experiments.replay.recorded_trial import Rerun, recorded_cage, recorded_regions
from experiments.replay.video import film_alone
from experiments.replay.what_is_filmed import Filmed, filmed_alone
from icage.formats.whole_files import whole_file
from sim.closing.judge import OUTCOMES


def filmed(done: Rerun) -> Filmed:
    """What is filmed of a trial that was closed again."""
    trial, row = done.trial, done.trial.row
    return filmed_alone(
        trial.index,
        row["grasp"],
        recorded_cage(trial),
        done.scene,
        done.closings.start[0],
        OUTCOMES[int(done.verdicts.outcome[0])],
        row["verdict"],
        row["set"] != "outside",
    )


def film_trial(done: Rerun, path: Path, camera: bool | None = None) -> None:
    """Write the film; ``camera`` as in ``experiments.replay.video.film``.

    Unlike the closing that is compared, the film also simulates the free travel before the first
    touch: its last frame may differ from the record by rounding, about 1e-9 of the diameter.
    """
    with stage_bar() as report, whole_file(path) as part:
        film_alone(filmed(done), recorded_regions(done.trial), part, report, camera)
