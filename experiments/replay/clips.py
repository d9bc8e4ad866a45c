"""Closings chosen from a replay and recorded at the frames of a film."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from experiments.replay.run import Replay, Run
from experiments.replay.what_is_filmed import Filmed, filmed_of_run
from icage.arrays import FloatArray
from icage.hand import Placement
from sim.closing.judge import OUTCOMES
from sim.closing.recording import Recording, record

FPS: Final = 30

_SECONDS, _SHORTEST = 15.0, 10.5
"""[s] About the length of a film, and the least."""

_MOST, _ABOUT, _FEWEST = 10, 9, 6
"""Closings shown; fewer than the last would each take too long to watch: a shorter film."""

_WAIT, _HOLD = 0.15, 0.27
"""[1] Share of a clip that the hand rests before it closes, and after."""

_SETTLED = 1e-3
"""[diameter, rad] Nothing is seen of a motion that is this near its end."""

_BLUR = 0.04
"""[1] Share of the motion over which forces are averaged."""


@dataclass(frozen=True, slots=True)
class Clip:
    """F frames of one closing.

    Attributes
    ----------
    time:
        (F,), share of the motion that has passed, 0 to 1.
    qpos, placements:
        (F, 6), (F, 4) as in ``sim.closing.recording.Recording``.
    forces:
        (F, 3), mean force on each finger over the last few frames: impacts ring faster than
        anyone can see.
    """

    filmed: Filmed
    time: FloatArray
    qpos: FloatArray
    placements: FloatArray
    forces: FloatArray

    def __len__(self) -> int:
        return len(self.time)

    @property
    def moving(self) -> tuple[int, int]:
        """First and last frame of the motion; before and after it nothing changes."""
        return int((self.time == 0.0).sum()) - 1, int((self.time < 1.0).sum())


def clips(done: Replay) -> list[Clip]:
    """Some closings of every run: the first, as the starts are random already.

    The last of a run is the first that ended elsewhere than in the target, if one did.
    """
    per_run = max(1, round(_ABOUT / len(done.runs)))
    chosen = [(run, trial) for run in done.runs[:_MOST] for trial in _shown(run, per_run)][:_MOST]
    seconds = max(_SECONDS / max(len(chosen), _FEWEST), _SHORTEST / len(chosen))
    frames = round(FPS * seconds)
    return [
        _clip(filmed_of_run(run, trial, OUTCOMES[int(run.verdicts.outcome[trial])]), frames)
        for run, trial in chosen
    ]


def clip_alone(filmed: Filmed) -> Clip:
    """A closing that is a film of its own."""
    return _clip(filmed, round(FPS * max(_SECONDS / _FEWEST, _SHORTEST)))


def clip_of_length(filmed: Filmed, frames: int) -> Clip:
    """A closing in so many frames."""
    return _clip(filmed, frames)


def _shown(run: Run, count: int) -> list[int]:
    trials = list(range(min(count, len(run.closings))))
    elsewhere = np.flatnonzero(run.verdicts.outcome != OUTCOMES.index("target"))
    if len(elsewhere) and elsewhere[0] not in trials:
        trials[-1] = int(elsewhere[0])
    return trials


def _clip(filmed: Filmed, frames: int) -> Clip:
    start = Placement(*filmed.start.tolist())
    recording = record(filmed.scene, start, frame_time=0.002, max_frames=5000)
    waiting, holding = round(_WAIT * frames), round(_HOLD * frames)
    moving = np.linspace(0.0, 1.0, frames - waiting - holding + 1)[1:]
    share = np.concatenate([np.zeros(waiting), moving, np.ones(holding)])
    at = share * _end_of_motion(recording)
    qpos = _resampled(at, recording.time, recording.qpos)
    return Clip(
        filmed,
        share,
        qpos,
        filmed.scene.placements(qpos),
        _averaged(at, recording.time, recording.finger_forces),
    )


def _end_of_motion(recording: Recording) -> float:
    """When the last visible motion is over, and a little after."""
    left = np.abs(recording.qpos - recording.qpos[-1]).max(axis=1)
    moving = np.flatnonzero(left > _SETTLED)
    last = recording.time[moving[-1]] if len(moving) else 0.0
    return float(min(max(1.15 * last, 0.02), recording.time[-1]))


def _averaged(at: FloatArray, time: FloatArray, rows: FloatArray) -> FloatArray:
    """Means of the rows over the last ``_BLUR`` before each moment: differences of the integral."""
    steps = 0.5 * (rows[1:] + rows[:-1]) * np.diff(time)[:, None]
    integral = np.vstack([np.zeros(rows.shape[1]), np.cumsum(steps, axis=0)])
    span = max(_BLUR * float(at[-1]), 1e-3)
    before = np.maximum(at - span, 0.0)
    mean = _resampled(at, time, integral) - _resampled(before, time, integral)
    mean /= np.maximum(at - before, 1e-12)[:, None]
    still = at >= at[-1]
    mean[still] = rows[-1]
    return mean


def _resampled(at: FloatArray, time: FloatArray, rows: FloatArray) -> FloatArray:
    return np.column_stack([np.interp(at, time, column) for column in rows.T])
