"""``replay.mp4``: a film that any player shows, legible, with something on every frame."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import imageio_ffmpeg
import numpy as np
import pytest
from numpy.typing import NDArray

from experiments.figures.drawing import film_page
from experiments.figures.drawing.canvas import Canvas
from experiments.figures.drawing.film_page import MAIN
from experiments.figures.drawing.plots import Level, Plot
from experiments.io.words import END_WORDS
from experiments.replay import clips, video
from experiments.replay.files import VIDEO, regions_by_grasp
from experiments.replay.run import Recorded, Replay, replay
from experiments.replay.video import SIZE, film
from sim.camera.renderer import find_backend
from sim.closing.judge import OUTCOMES
from tests.experiments.commands.runner import here
from tests.experiments.small import t_case, write_case


def silent(stage: str, done: int, total: int) -> None:
    assert 0 <= done <= total, stage


@pytest.fixture(scope="module")
def done() -> Replay:
    return replay([t_case()], 3, 1, 2, silent)


def frames_of(path: Path) -> tuple[dict[str, Any], Iterator[NDArray[np.uint8]]]:
    reader = imageio_ffmpeg.read_frames(str(path))
    about = next(reader)
    width, height = about["size"]
    pictures = (np.frombuffer(raw, np.uint8).reshape(height, width, 3) for raw in reader)
    return about, pictures


def check_film(path: Path, seconds: tuple[float, float]) -> None:
    about, pictures = frames_of(path)
    assert about["size"] == SIZE == (1280, 720)
    assert about["codec"] == "h264"
    assert about["pix_fmt"].startswith("yuv420p")
    assert seconds[0] <= about["duration"] <= seconds[1]
    first, moved, count = None, 0, 0
    for picture in pictures:
        count += 1
        main = picture[: MAIN[1], : MAIN[0]].astype(int)
        side = picture[: MAIN[1], MAIN[0] + 4 :]
        caption = picture[MAIN[1] + 10 :]
        assert main.std() > 10.0, "an empty main view"
        assert side.std() > 10.0, "empty side panels"
        assert caption.min() < 100, "no caption"
        first = main if first is None else first
        moved += np.abs(main - first).max() > 60
    assert count == pytest.approx(about["duration"] * clips.FPS, abs=1)
    assert moved > 0.5 * count, "a film in which nothing moves"
    data = path.read_bytes()
    assert data.index(b"moov") < data.index(b"mdat"), "the index must come first"


def two_short_clips(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(clips, "_SECONDS", 3.0)
    monkeypatch.setattr(clips, "_SHORTEST", 0.0)
    monkeypatch.setattr(clips, "_ABOUT", 2)


def test_a_short_film_without_a_renderer(
    done: Replay, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    two_short_clips(monkeypatch)
    monkeypatch.setattr(video, "find_backend", lambda: None)
    film(done, "T", regions_by_grasp(done), tmp_path / VIDEO, silent)
    check_film(tmp_path / VIDEO, (0.9, 1.1))


@pytest.mark.slow
def test_a_renderer_that_fails_is_replaced(
    done: Replay, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    def broken(*args: Any) -> Iterator[NDArray[np.uint8]]:
        raise video.RenderingUnavailable("no display")
        yield

    two_short_clips(monkeypatch)
    monkeypatch.setattr(video, "render_frames", broken)
    film(done, "T", regions_by_grasp(done), tmp_path / VIDEO, silent, camera=True)
    check_film(tmp_path / VIDEO, (0.9, 1.1))


def test_clips_show_the_trials_that_were_counted(done: Replay):
    (run,) = done.runs
    shown = clips.clips(done)
    assert [clip.trial for clip in shown] == [0, 1, 2]
    for clip in shown:
        assert clip.outcome == "target"
        assert clip.placements[0] == pytest.approx(run.starts.placements[clip.trial], abs=1e-9)
        assert clip.placements[-1, 3] == pytest.approx(run.cage.sigma_0, rel=5e-3)
        assert np.diff(clip.placements[:, 3]).max() <= 1e-3 * run.cage.sigma_0
        first, last = clip.moving
        assert np.ptp(clip.qpos[: first + 1], axis=0).max() == 0.0
        assert np.ptp(clip.qpos[last:], axis=0).max() == 0.0
        assert (clip.forces[0] == 0.0).all()
        assert (clip.forces[-1] > 0.1).all()


def one_trial(done: Replay, outcome: str, recorded: Recorded | None) -> clips.Clip:
    """The first clip, as if it had ended so."""
    (run,) = done.runs
    code = np.array([OUTCOMES.index(outcome)])
    closings = replace(run.closings, **{
        one.name: getattr(run.closings, one.name)[:1] for one in fields(run.closings)
    })  # fmt: skip
    verdicts = replace(run.verdicts, outcome=code)
    run = replace(run, which="study", closings=closings, verdicts=verdicts, recorded=recorded)
    return replace(clips.clips(done)[0], run=run)


@pytest.mark.parametrize("outcome", OUTCOMES)
def test_a_film_of_one_trial_tells_that_trial(done: Replay, outcome: str):
    clip = one_trial(done, outcome, Recorded(4, "target", True))
    words, fine = film_page.headline(clip.run)
    assert words == f"trial 4: {END_WORDS[outcome]}"
    assert fine == (outcome == "target")
    assert film_page._about(clip) == "trial 4, by plan: closing can end only in the target"


def test_a_film_of_one_trial_knows_what_the_planner_said(done: Replay):
    clip = one_trial(done, "other_grasp", Recorded(7, "caged", False))
    assert film_page._about(clip) == "trial 7, by plan: in another cage"
    assert film_page.headline(clip.run)[1]


def test_no_closing_is_called_lost(done: Replay):
    clip = one_trial(done, "jammed", None)
    text = "0 of 1 closings ended in the target grasp, 0 escaped, 1 jammed"
    assert film_page.headline(clip.run) == (text, False)


@pytest.mark.parametrize("outcome", OUTCOMES)
def test_the_badge_holds_its_words(done: Replay, outcome: str):
    canvas = Canvas(400, 80)
    film_page._draw_badge(canvas, one_trial(done, outcome, Recorded(4, "target", True)))
    row = canvas.pixels[40, :, :3].astype(int)
    inside = np.flatnonzero((row != 255).any(axis=1))
    white = np.flatnonzero((canvas.pixels[28:50, 20 : inside.max() + 1, :3] > 200).all(-1).any(0))
    assert inside.max() - (20 + white.max()) >= 8


def test_a_curve_meets_its_levels_and_grows():
    from experiments.figures.drawing.plots import Curve

    plot = Plot((20.0, 30.0, 180.0, 90.0), "t", 1.0, (0.0, 2.0), [Level(1.0, "one")])
    assert plot.at(np.array([0.5]), np.array([1.0])).tolist() == [[100.0, 60.0]]
    canvas = Canvas(240, 120)
    x = np.linspace(0.0, 1.0, 11)
    plot.draw_curve(canvas, Curve(x, np.ones(11), (1.0, 0.0, 0.0)), 0.5)
    red = np.flatnonzero(canvas.pixels[60, :, 1] < 100)
    assert red.min() == pytest.approx(20, abs=2)
    assert red.max() == pytest.approx(100, abs=5)


@pytest.mark.slow
def test_importing_leaves_the_choice_of_opengl_alone():
    code = (
        "import os, experiments.replay.video, experiments.commands.replay; "
        "raise SystemExit('MUJOCO_GL' in os.environ)"
    )
    environment = {key: value for key, value in os.environ.items() if key != "MUJOCO_GL"}
    assert (
        subprocess.run([sys.executable, "-c", code], env=environment, check=False).returncode == 0
    )


@pytest.mark.slow
def test_a_whole_film(done: Replay, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    for module in (clips, video):
        monkeypatch.setattr(module, "FPS", 5)
    if find_backend() is None:
        pytest.skip("no offscreen OpenGL on this machine")
    film(done, "T", regions_by_grasp(done), tmp_path / VIDEO, silent, camera=True)
    check_film(tmp_path / VIDEO, (10.0, 20.0))


@pytest.mark.slow
def test_the_command_makes_a_film(tmp_path: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(video, "find_backend", lambda: None)
    for module in (clips, video):  # a sixth of the frames takes a sixth of the time
        monkeypatch.setattr(module, "FPS", 5)
    case = write_case(t_case(), tmp_path / "t.json")
    result = here(capsys, "replay", str(case), "--out", str(tmp_path / "out"), "--trials", "1")
    assert result.code == 0, result
    check_film(tmp_path / "out" / VIDEO, (10.0, 20.0))
