"""``replay.mp4``: a film that any player shows, legible, with something on every frame."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import imageio_ffmpeg
import numpy as np
import pytest
from numpy.typing import NDArray

from experiments.figures.drawing.canvas import Canvas
from experiments.figures.drawing.hand_view import window_on
from experiments.figures.drawing.plots import Level, Plot
from experiments.io.outcome_words import END_WORDS
from experiments.replay import clips, film_page, photographs, video
from experiments.replay.files import VIDEO, regions_by_grasp
from experiments.replay.film_page import MAIN
from experiments.replay.run import Replay, replay
from experiments.replay.video import SIZE, film, film_alone
from experiments.replay.what_is_filmed import Filmed, filmed_alone, headline
from sim.camera.renderer import RenderingUnavailable, find_backend
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
        raise RenderingUnavailable("no display")
        yield

    two_short_clips(monkeypatch)
    monkeypatch.setattr(photographs, "render_frames", broken)
    film(done, "T", regions_by_grasp(done), tmp_path / VIDEO, silent, camera=True)
    check_film(tmp_path / VIDEO, (0.9, 1.1))


def test_clips_show_the_trials_that_were_counted(done: Replay):
    (run,) = done.runs
    shown = clips.clips(done)
    assert len(shown) == 3
    for trial, clip in enumerate(shown):
        assert clip.filmed.outcome == "target"
        assert clip.filmed.about == f"guaranteed set, start {trial + 1} of 3"
        assert clip.placements[0] == pytest.approx(run.starts.placements[trial], abs=1e-9)
        assert clip.placements[-1, 3] == pytest.approx(run.cage.sigma_0, rel=5e-3)
        assert np.diff(clip.placements[:, 3]).max() <= 1e-3 * run.cage.sigma_0
        first, last = clip.moving
        assert np.ptp(clip.qpos[: first + 1], axis=0).max() == 0.0
        assert np.ptp(clip.qpos[last:], axis=0).max() == 0.0
        assert (clip.forces[0] == 0.0).all()
        assert (clip.forces[-1] > 0.1).all()


def one_trial(done: Replay, outcome: str, verdict: str = "target", in_cage: bool = True) -> Filmed:
    """The first closing, as if it were trial 4 and had ended so."""
    (run,) = done.runs
    start = run.starts.placements[0]
    return filmed_alone(4, "T", run.cage, run.scene, start, outcome, verdict, in_cage)


@pytest.mark.parametrize("outcome", OUTCOMES)
def test_a_film_of_one_trial_tells_that_trial(done: Replay, outcome: str):
    one = one_trial(done, outcome)
    assert (one.before, one.after) == ("trial 4", f"trial 4: {END_WORDS[outcome]}")
    assert one.good == one.after_good == (outcome == "target")
    assert one.about == "trial 4, by plan: closing can end only in the target"


def test_a_film_of_one_trial_knows_what_the_planner_said(done: Replay):
    one = one_trial(done, "other_grasp", "caged", in_cage=False)
    assert one.about == "trial 4, by plan: in another cage"
    assert one.good


def test_a_film_of_one_trial_tells_its_end_at_the_end_and_holds_the_object(
    done: Replay, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """The words below the picture change once, when the hand stands still, and the badge comes."""
    for module in (clips, video):
        monkeypatch.setattr(module, "FPS", 5)
    one = one_trial(done, "target")
    clip = clips.clip_alone(one)
    path = tmp_path / "trial.mp4"
    film_alone(one, (), path, silent, camera=False)
    _, pictures = frames_of(path)
    frames = np.array([p.copy() for p in pictures]).astype(int)
    words = frames[:, MAIN[1] + 20 : MAIN[1] + 50, 110:600]  # right of "trial 4"
    corner = frames[:, 20:58, 20:44]
    first_end = int((clip.time < 1.0).sum())
    assert 0 < first_end < len(frames) - 1
    assert words[: first_end - 1].min() > 200, "the end is told before it came"
    assert words[first_end + 1 :].min() < 100
    green = (corner[..., 1] - corner[..., 0]).max(axis=(1, 2))
    assert green[: first_end - 1].max() < 40 < green[first_end + 1 :].min()
    view = window_on(one.scene, clip.qpos, *MAIN, whole=True)
    x, y = one.scene.object.vertices.T
    for qpos in clip.qpos:
        cos, sin = np.cos(qpos[5]), np.sin(qpos[5])
        object_ = np.column_stack([cos * x - sin * y + qpos[3], sin * x + cos * y + qpos[4]])
        hand = qpos[:3, None] * one.scene.kinematics.directions
        pixels = view.pixels(np.concatenate([object_, hand]))
        assert (pixels > 0.0).all()
        assert (pixels < MAIN).all()


def test_a_small_hand_does_not_cut_the_object_of_its_own_film(done: Replay):
    (run,) = done.runs
    qpos = np.array([[0.01, 0.01, 0.01, 0.0, 0.0, 0.0]])
    assert window_on(run.scene, qpos, *MAIN).extent < 0.5
    assert window_on(run.scene, qpos, *MAIN, whole=True).extent > 0.5


def test_no_closing_is_called_lost():
    counts = dict.fromkeys(OUTCOMES, 0) | {"jammed": 1}
    text = "0 of 1 closings ended in the target grasp, 0 escaped, 1 jammed"
    assert headline(counts, guaranteed=True) == (text, False)


@pytest.mark.parametrize("outcome", OUTCOMES)
def test_the_badge_holds_its_words(done: Replay, outcome: str):
    canvas = Canvas(400, 80)
    film_page._draw_badge(canvas, one_trial(done, outcome))
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
