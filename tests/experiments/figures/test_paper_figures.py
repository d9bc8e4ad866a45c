"""``icage figures``: every figure of a case is drawn, or nothing is."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pytest
import shapely
from matplotlib.text import Text

from experiments.figures.paper import (
    FIGURES,
    equilibria,
    grasps,
    obstacles,
    parallelogram,
    search,
    sigma,
)
from experiments.figures.paper.page import SETTINGS
from experiments.figures.paper.study import Study
from experiments.figures.paper.tunnel import NONE
from icage.contact_space.kernels.explore import SEAM
from icage.formats.case_json import read_case
from icage.planner import plan
from models import CASES
from tests.experiments.commands.runner import here

GOLDEN, T = str(CASES / "tunnel_golden.json"), str(CASES / "T_best.json")
LARGEST = 2_000_000
"""Bytes of a vector figure."""


def study_of(name: str) -> Study:
    return Study.of(read_case(CASES / f"{name}.json"))


@pytest.mark.parametrize(
    "name",
    [
        "sectors",
        "sigma",
        *(pytest.param(n, marks=pytest.mark.slow) for n in ("contact_space", "search", "grasps")),
    ],
)
def test_a_figure_of_the_golden_case(name: str, tmp_path: Path, capsys: Any):
    result = here(capsys, "figures", GOLDEN, "--out", str(tmp_path / "new"), "--only", name)
    assert (result.code, result.err) == (0, "")
    (file,) = (tmp_path / "new").iterdir()
    assert file.name == f"{name}.svg"
    assert str(file) in result.out
    assert b"<svg" in file.read_bytes()[:1000]
    assert 2000 < file.stat().st_size < LARGEST


@pytest.mark.slow
@pytest.mark.parametrize(
    ("case", "kind"),
    [
        (GOLDEN, "pdf"),
        (GOLDEN, "svg"),
        (str(CASES / "disc_Y.json"), "svg"),
    ],
)
def test_all_figures_of_a_case(case: str, kind: str, tmp_path: Path, capsys: Any):
    result = here(capsys, "figures", case, "--out", str(tmp_path), "--format", kind)
    assert (result.code, result.err) == (0, "")
    assert {p.name for p in tmp_path.iterdir()} == {f"{name}.{kind}" for name in FIGURES}
    assert all(2000 < p.stat().st_size < LARGEST for p in tmp_path.iterdir())
    assert len(result.out.splitlines()) == len(FIGURES)


def test_the_same_case_gives_the_same_bytes(tmp_path: Path, capsys: Any):
    for folder in ("one", "two"):
        out = str(tmp_path / folder)
        assert here(capsys, "figures", GOLDEN, "--out", out, "--only", "tunnel").code == 0
    one, two = ((tmp_path / folder / "tunnel.svg").read_bytes() for folder in ("one", "two"))
    assert one == two


def test_no_tunnel_edge_is_said(tmp_path: Path, capsys: Any):
    result = here(capsys, "figures", T, "--out", str(tmp_path), "--only", "tunnel")
    assert NONE in result.out
    assert (tmp_path / "tunnel.svg").stat().st_size > 2000


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("figures", GOLDEN), "--out"),
        (("figures", GOLDEN, "--out", "o", "--only", "poem"), "invalid choice: 'poem'"),
        (("figures", GOLDEN, "--out", "o", "--format", "gif"), "invalid choice: 'gif'"),
        (("figures", GOLDEN, "--out", "file"), "'file' is a file; a folder is needed"),
        (("figures", GOLDEN, "--out", "file/o"), "is a file; a folder is needed"),
        (("figures", "none.json", "--out", "o"), "does not exist"),
        (
            ("figures", str(CASES / "stretching_not_a_cage.json"), "--out", "o"),
            "the figures need an immobilizing grasp; no equilibrium",
        ),
    ],
)
def test_what_cannot_be_drawn(
    arguments: tuple[str, ...], message: str, tmp_path: Path, monkeypatch: Any, capsys: Any
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_text("")
    assert message in here(capsys, *arguments).error_line()
    assert [p.name for p in tmp_path.iterdir()] == ["file"]


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_a_folder_that_may_not_be_written(tmp_path: Path, capsys: Any):
    tmp_path.chmod(0o500)
    line = here(capsys, "figures", GOLDEN, "--out", str(tmp_path / "o")).error_line()
    assert "cannot be written to: Permission denied" in line


@pytest.mark.slow
@pytest.mark.parametrize("name", ["T_best", "tunnel_golden", "disc_Y"])
def test_no_text_leaves_the_page_and_no_titles_overlap(name: str):
    study = study_of(name)
    for module in (grasps, obstacles, equilibria, parallelogram, search, sigma):
        with matplotlib.rc_context(SETTINGS):
            figure, _ = module.draw(study)
            figure.draw_without_rendering()
            page = shapely.box(*figure.bbox.extents).buffer(1.0)
            titles = [a.get_title(loc="left") for a in figure.axes]
            boxes = []
            for text in figure.findobj(Text):
                if not (text.get_text() and text.get_visible()):
                    continue
                box = shapely.box(*text.get_window_extent().extents)
                if text.get_text() in titles:
                    assert page.contains(box), (module.__name__, text.get_text())
                    boxes.append(box)
            for k, box in enumerate(boxes):
                assert not any(box.intersects(other) for other in boxes[:k]), module.__name__


def test_the_way_out_in_contact_space_joins_target_and_pinch():
    study = study_of("tunnel_golden")
    graph = search._Graph(study)
    ways = [graph._way(pair) for pair in range(3)]
    count = len(study.found.way_out())
    assert sum(len(way) for way in ways) == count + 1
    assert (study.found.edges[:, 3] != SEAM).sum() == 1
    first = int(study.found.regions[0, 0])
    assert any(
        np.hypot(*(way[0] - place)).min() <= 1e-9
        for way in ways[first]
        for place in study.places(study.target, first)
    )
    for pair in range(3):
        for way in ways[pair]:
            s = np.array(way)
            assert s.min() >= -1e-9
            assert s.max() <= study.boundary.perimeter + 1e-9


@pytest.mark.parametrize(
    "path",
    [
        CASES / "disc_hammer.json",
        CASES / "cross_multi.json",
        CASES.parent / "objects" / "pliers" / "cases" / "4_with_rest.json",
    ],
    ids=lambda path: path.stem,
)
def test_levels_and_punctures_drawn_are_those_of_the_plan(path: Path):
    case = read_case(path)
    cage = plan(case.outline, case.contacts, case.finger_radius)
    with matplotlib.rc_context(SETTINGS):
        figure, note = sigma.draw(Study.of(case))
    wanted = {level for level in (cage.sigma_0, cage.sigma_first, cage.sigma_max) if level}
    along, over = figure.axes
    for axes in (along, over):
        across = [np.asarray(line.get_ydata()) for line in axes.lines]
        drawn = {float(y[0]) for y, line in zip(across, axes.lines, strict=True)
                 if len(y) == 2 and y[0] == y[1] and line.is_dashed()}  # fmt: skip
        assert drawn == wanted
    squares = [line for line in along.lines if line.get_marker() == "s"]
    assert [float(line.get_ydata()[0]) for line in squares] == [p.sigma for p in cage.punctures]
    assert note is not None
    assert all(f"{p.sigma:.9g}" in note for p in cage.punctures)


def test_with_discs_the_caption_says_what_is_drawn(tmp_path: Path, capsys: Any):
    case = str(CASES / "disc_hammer.json")
    result = here(capsys, "figures", case, "--out", str(tmp_path), "--only", "tunnel")
    assert "one polygon, the inner offset with 2 chords a quadrant" in result.out
    assert "sigma_max are the plan's" in result.out
    result = here(capsys, "figures", GOLDEN, "--out", str(tmp_path), "--only", "tunnel")
    assert "chords" not in result.out


def test_places_on_the_seam_are_shown_twice():
    study = study_of("T_best")
    contacts = study.target.copy()
    contacts[0] = study.boundary.start[0]
    assert len(study.places(contacts, 0)) == 2
    assert not len(study.places(contacts + 0.01, 0))
