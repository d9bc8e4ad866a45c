"""The pictures and the page of a small study."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
import pytest

from experiments.figures.plan import figure_regions
from experiments.study.report.rate_figures import draw_indices, draw_map, draw_rates
from experiments.study.report.results_md import results_page
from experiments.study.run.document import study_of
from tests.experiments.commands.runner import here
from tests.experiments.small import t_case, write_case


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    from experiments.cli import main

    place = tmp_path_factory.mktemp("study")
    case = write_case(t_case(), place / "t.json")
    arguments = ["study", str(case), "--trials", "60", "--vary", "place_xy=-8%:8%"]
    arguments += ["--vary", "friction=grid:0,1.2", "--out", str(place / "out")]
    assert main(arguments) == 0
    return place / "out"


def document_of(folder: Path) -> dict[str, Any]:
    return json.loads((folder / "study.json").read_text())


def test_a_study_leaves_its_pictures(folder: Path) -> None:
    names = {path.name for path in folder.iterdir()}
    assert {"study.json", "trials.parquet", "results.md", "map.svg", "rates.svg"} <= names
    assert "shards" not in names
    assert "indices.svg" not in names


def test_the_page_says_the_bottom_line_first(folder: Path) -> None:
    document = document_of(folder)
    page = (folder / "results.md").read_text()
    reached = document["found"]["outcomes"]["target"]
    assert page.splitlines()[2].startswith(f"**{reached} of 60 trials of T ended in the target")
    for words in (
        "## Method",
        "## Command",
        "| friction |",
        "replay-trial",
        "## Friction of the fingers",
        "seed 0",
    ):
        assert words in page
    assert str(folder) not in page


def test_a_page_without_failures_says_what_that_proves(folder: Path) -> None:
    document = document_of(folder)
    found = document["found"]
    closed = found["closed"]
    found |= {"failed": 0, "failed_trials": [], "trials": 60}
    assert f"None of {closed} closings failed" in results_page(document, "icage study t.json")


def test_the_same_study_gives_the_same_bytes(folder: Path, tmp_path: Path) -> None:
    document, table = document_of(folder), pq.read_table(folder / "trials.parquet")
    cage = study_of(document).cage
    draw_map(document, table, cage, figure_regions(cage), tmp_path / "map.svg")
    draw_rates(document, tmp_path / "rates.svg")
    for name in ("map.svg", "rates.svg"):
        assert (tmp_path / name).read_bytes() == (folder / name).read_bytes()


def test_indices_are_drawn_and_told(tmp_path: Path, capsys: Any) -> None:
    case, out = write_case(t_case(), tmp_path / "t.json"), tmp_path / "out"
    arguments = ("--sampling", "saltelli", "--trials", "150", "--vary", "friction=0:0.9")
    done = here(capsys, "study", str(case), *arguments, "--starts", "guaranteed", "--out", str(out))
    assert done.code == 0, done
    assert "64 base points x (2 groups + 2) = 256 runs" in done.out
    document = document_of(out)
    names = {one["name"] for one in document["found"]["indices"]["groups"]}
    assert names == {"friction", "placement"}
    assert "What matters most" in (out / "results.md").read_text()
    draw_indices(document, tmp_path / "again.svg")
    assert (tmp_path / "again.svg").read_bytes() == (out / "indices.svg").read_bytes()
