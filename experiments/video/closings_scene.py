"""Closings from random placements, as a replay films them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from experiments.figures.drawing.canvas import Canvas
from experiments.replay.clips import Clip, clip_of_length
from experiments.replay.video import closing_frames
from experiments.replay.what_is_filmed import Filmed, headline
from experiments.video.subject import Subject
from icage.sampling import draw_starts
from sim.closing.batch import close_many
from sim.closing.judge import OUTCOMES, judge

_SHORTEST = 45
"""Frames of a closing: a shorter one is not understood."""

MOST = 6


def closings_scene(subject: Subject, canvas: Canvas) -> Iterator[None]:
    """A frame of the film on the canvas at every step.

    Raises
    ------
    SamplingError:
        The guaranteed set is too small to be drawn from.
    """
    cage, scene = subject.cage, subject.scene
    count = min(max(subject.frames // _SHORTEST, 1), MOST)
    rng = np.random.default_rng([subject.seed, 0, 0])
    starts = draw_starts(cage, "guaranteed", count, rng).placements
    verdicts = judge(close_many(scene, starts, 0), cage.grasps, cage.outline)
    words, fine = headline(verdicts.counts(), True)
    ends = np.linspace(0, subject.frames, count + 1).round().astype(int)
    clips: list[Clip] = []
    for k, frames in enumerate(np.diff(ends).tolist()):
        outcome = OUTCOMES[int(verdicts.outcome[k])]
        filmed = Filmed(
            subject.name, "closings", cage, scene, starts[k], outcome, outcome == "target",
            f"start {k + 1} of {count}, {subject.about_fingers}", words, words, fine, False,
        )  # fmt: skip
        clips.append(clip_of_length(filmed, frames))
    regions = {subject.name: subject.regions}
    for _ in closing_frames(canvas, clips, subject.name, regions, subject.camera):
        yield
