"""Short films: every scene, the same layout with and without a camera, whole files or none."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import imageio_ffmpeg
import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from experiments.commands import video as command
from experiments.figures.drawing.canvas import Canvas
from experiments.replay.film_page import HEIGHT, MAIN, WIDTH
from experiments.video import attack_scene, run
from experiments.video.pictures import Gif, Sheet
from experiments.video.plan_scene import plan_scene, way_out
from experiments.video.run import SCENES, SIZES, Outputs, write_film
from experiments.video.subject import Subject
from icage.cage import CageStatus
from icage.cells.membership import query
from icage.errors import InputError
from models import CASES
from sim.camera.renderer import find_backend
from sim.grip.shake import HELD_SHIFT
from sim.grip.shake_recording import record_shake
from tests.experiments.commands.runner import here
from tests.experiments.small import t_case, write_case

FRAMES = 10

Picture = NDArray[np.uint8]


def silent(stage: str, done: int, total: int) -> None:
    assert 0 <= done <= total, stage


@pytest.fixture(scope="module", autouse=True)
def few() -> Iterator[None]:
    """Two attacks are enough here."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(attack_scene, "TRIES", 2)
        yield


@pytest.fixture(scope="module")
def subject() -> Subject:
    return Subject.of(t_case(), 0, FRAMES, camera=False)


@pytest.fixture(scope="module")
def drawn(subject: Subject) -> dict[str, list[Picture]]:
    """All frames of every scene, half as large as usual."""
    found: dict[str, list[Picture]] = {}
    for name, scene in SCENES.items():
        canvas = Canvas(WIDTH, HEIGHT, 0.5)
        found[name] = [canvas.pixels.copy() for _ in scene(subject, canvas)]
    return found


@pytest.mark.parametrize("name", SCENES)
def test_every_scene_has_its_frames(name: str, drawn: dict[str, list[Picture]]) -> None:
    frames = drawn[name]
    assert len(frames) == FRAMES
    wide, high = MAIN[0] // 2, MAIN[1] // 2
    for frame in frames:
        assert frame.shape == (HEIGHT // 2, WIDTH // 2, 4)
        assert frame[:high, :wide].astype(int).std() > 10.0, "an empty main view"
        assert frame[:high, wide + 2 :].astype(int).std() > 10.0, "empty side panels"
        assert frame[high + 5 :].min() < 110, "no caption"
    first, last = (frames[k][:high, :wide].astype(int) for k in (0, -1))
    assert np.abs(last - first).max() > 60, "nothing moves"


def test_the_command_knows_the_scenes_and_sizes() -> None:
    assert tuple(SCENES) == command.SCENES
    assert tuple(SIZES) == command.SIZES
    for scale in SIZES.values():  # an encoder takes even ones
        assert round(WIDTH * scale) % 2 == round(HEIGHT * scale) % 2 == 0


@pytest.mark.parametrize(
    "name", ["shake", *(pytest.param(n, marks=pytest.mark.slow) for n in ("closings", "attack"))]
)
def test_the_layout_is_the_same_with_a_camera(
    name: str, subject: Subject, drawn: dict[str, list[Picture]]
) -> None:
    if find_backend() is None:
        pytest.skip("no offscreen OpenGL on this machine")
    canvas = Canvas(WIDTH, HEIGHT, 0.5)
    filmed = Subject(subject.physical, subject.regions, 0, FRAMES, True, subject.scene)
    frames = [canvas.pixels.copy() for _ in SCENES[name](filmed, canvas)]
    assert len(frames) == FRAMES
    wide, high = MAIN[0] // 2, MAIN[1] // 2
    for taken, by_hand in zip(frames, drawn[name], strict=True):
        assert (taken[:, wide + 1 :] == by_hand[:, wide + 1 :]).all()
        assert (taken[high + 1 :] == by_hand[high + 1 :]).all()
        assert (taken[:high, :wide] != by_hand[:high, :wide]).any()


def test_the_way_out_leads_from_the_target_out_of_the_cage(subject: Subject) -> None:
    cage, way = subject.cage, way_out(subject)
    assert way[0] == pytest.approx(cage.target_placement.as_array(), abs=1e-6)
    assert way[:, 3].max() == pytest.approx(cage.sigma_max, rel=1e-3)
    assert not query(cage, way[-1:]).in_cage[0]
    fingers = cage.hand.fingers(way)
    assert np.hypot(*np.diff(fingers, axis=0).T).max() < 0.02 * cage.outline.diameter


def test_an_attack_that_escapes_ends_outside(subject: Subject) -> None:
    recorded, opening = attack_scene.escaped(subject)
    assert opening > (subject.cage.sigma_max_upper or 0.0)
    start, end = subject.scene.placements(recorded[[0, -1]])
    assert start == pytest.approx(subject.cage.target_placement.as_array(), abs=1e-6)
    assert not query(subject.cage, end[None]).in_cage[0]
    steps = np.abs(np.diff(recorded, axis=0)).max()
    assert steps < 0.05  # one attack, and not parts of several


def test_a_recorded_shake_holds(subject: Subject) -> None:
    scene = subject.scene
    target = scene.start_positions(subject.cage.target_placement.as_array())[0]
    recorded = record_shake(scene, target, np.random.default_rng(0), 41)
    assert recorded.qpos.shape == (41, 6)
    assert recorded.random_from == 20
    assert np.hypot(*(recorded.qpos[:, 3:5] - target[3:5]).T).max() < HELD_SHIFT
    assert (recorded.qpos[:, :3] == target[:3]).all()
    sizes = np.hypot(*recorded.wrenches[:16, :2].T)
    assert sizes == pytest.approx(sizes[0])  # eight directions, two frames each
    assert (recorded.wrenches[16:20, :2] == 0.0).all()  # then torque both ways


def test_a_larger_canvas_has_the_same_layout(subject: Subject) -> None:
    pictures: list[Picture] = []
    for scale in (1.0, 2.0):
        canvas = Canvas(WIDTH, HEIGHT, scale)
        next(plan_scene(subject, canvas))
        small = Image.fromarray(canvas.pixels[..., :3]).resize((320, 180), Image.Resampling.BOX)
        pictures.append(np.asarray(small).astype(int))
    assert np.abs(pictures[0] - pictures[1]).mean() < 2.0


def test_the_command_writes_all_three(tmp_path: Path, capsys: Any) -> None:
    case = write_case(t_case(), tmp_path / "t.json")
    paths = [tmp_path / name for name in ("a.mp4", "a.png", "a.gif")]
    result = here(
        capsys, "video", str(case), "--scene", "placements", "--seconds", "1", "--size", "360p",
        "--out", str(paths[0]), "--sheet", str(paths[1]), "--gif", str(paths[2]),
    )  # fmt: skip
    assert result.code == 0, result
    reader = imageio_ffmpeg.read_frames(str(paths[0]))
    about = next(reader)
    assert about["size"] == (640, 360)
    assert sum(1 for _ in reader) == 30
    data = paths[0].read_bytes()
    assert data.index(b"moov") < data.index(b"mdat"), "the index must come first"
    with Image.open(paths[1]) as sheet:
        assert sheet.size > (1900, 1100)
    with Image.open(paths[2]) as gif:
        assert gif.size == (640, 360)
        assert gif.n_frames >= 8
        assert gif.info["loop"] == 0
    assert paths[2].stat().st_size < 300_000
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.gif", "a.mp4", "a.png", "t.json"]


def test_a_gif_shows_a_long_film_in_larger_steps() -> None:
    assert Gif(240, 30).every == 3
    assert Gif(3600, 60).every == 30
    gif = Gif(100, 30)
    for k in range(100):
        gif.see(k, np.full((36, 64, 4), k, dtype=np.uint8))
    assert len(gif.kept) == 34
    assert np.asarray(gif.kept[-1]).max() == 99  # the end of the film


def test_a_sheet_has_the_first_frame_and_the_last(tmp_path: Path) -> None:
    sheet = Sheet("a $name$", 31, 30)
    for k in range(31):
        sheet.see(k, np.full((36, 64, 4), 8 * k, dtype=np.uint8))
    assert [number for number, _ in sheet.kept] == [0, 4, 8, 11, 15, 19, 22, 26, 30]
    sheet.save(tmp_path / "s.png")
    with Image.open(tmp_path / "s.png") as picture:
        assert picture.format == "PNG"


@pytest.mark.parametrize("error", [KeyboardInterrupt, MemoryError])
def test_ended_half_way_it_leaves_nothing(
    error: type[BaseException], subject: Subject, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    closed: list[bool] = []

    def half(subject: Subject, canvas: Canvas) -> Iterator[None]:
        try:
            for k in range(FRAMES):
                if k == FRAMES // 2:
                    raise error
                yield
        finally:
            closed.append(True)

    monkeypatch.setattr(run, "SCENES", {"plan": half})
    old = tmp_path / "a.mp4"
    old.write_text("an older film")
    with pytest.raises(error):
        write_film("plan", subject, Outputs(old, tmp_path / "s.png"), "360p", 30, silent)
    assert closed == [True]
    assert [p.name for p in tmp_path.iterdir()] == ["a.mp4"]
    assert old.read_text() == "an older film"


def test_what_is_asked_wrongly_is_one_line(tmp_path: Path, capsys: Any) -> None:
    case = str(write_case(t_case(), tmp_path / "t.json"))

    def line(*words: str) -> str:
        return here(capsys, "video", case, *words).error_line()

    out = str(tmp_path / "a.mp4")
    assert "needs --out" in line("--scene", "plan")
    assert "ending in .mp4" in line("--scene", "plan", "--out", str(tmp_path / "a.avi"))
    assert "invalid choice" in line("--scene", "planets", "--out", out)
    assert "at most 60" in line("--scene", "plan", "--out", out, "--fps", "61")
    assert "two frames" in line("--scene", "plan", "--out", out, "--seconds", "0.01")
    assert "there is no folder" in line("--scene", "plan", "--out", str(tmp_path / "b" / "a.mp4"))
    assert [p.name for p in tmp_path.iterdir()] == ["t.json"]


def test_contacts_that_are_no_cage(tmp_path: Path, capsys: Any) -> None:
    case = str(CASES / "rectangle_notcage.json")
    words = ("--scene", "attack", "--out", str(tmp_path / "a.mp4"))
    assert "not a cage" in here(capsys, "video", case, *words).error_line()
    assert list(tmp_path.iterdir()) == []


def test_what_never_escapes_has_a_plan_and_no_attack(subject: Subject) -> None:
    cage = replace(
        subject.cage, sigma_max=None, sigma_max_upper=None, escape_path=None,
        status=CageStatus.NEVER_ESCAPES, punctures=(),
    )  # fmt: skip
    held = replace(subject, physical=replace(subject.physical, cage=cage))
    canvas = Canvas(WIDTH, HEIGHT, 0.5)
    assert sum(1 for _ in plan_scene(held, canvas)) == FRAMES
    with pytest.raises(InputError, match="never escapes"):
        next(attack_scene.attack_scene(held, canvas))


def test_an_attack_that_does_not_escape_is_said(
    tmp_path: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(attack_scene, "WIDER", ())
    case = str(write_case(t_case(), tmp_path / "t.json"))
    result = here(
        capsys, "video", case, "--scene", "attack", "--seconds", "0.2", "--no-camera",
        "--out", str(tmp_path / "a.mp4"),
    )  # fmt: skip
    assert result.code == 1
    assert "none of 0 attacks" in result.err
    assert [p.name for p in tmp_path.iterdir()] == ["t.json"]
