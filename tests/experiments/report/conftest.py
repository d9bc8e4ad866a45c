"""Outputs of runs, made once by the commands themselves, and their pages."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest

from experiments.cli import main
from experiments.io.parquet_files import read_table, words_of, write_table
from tests.experiments.small import t_case, write_case
from tests.in_browser import Opened, browser, watched  # noqa: F401

DATA = Path(__file__).parent / "data"
JAMS = Path(__file__).parents[3] / "docs" / "jams.json"

KINDS = ("replay", "failed", "study", "regress.json", "escape.json", "shake.json", "jams.json")


@pytest.fixture(scope="session")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with an output of every kind; ``failed`` is a replay in which trials failed."""
    folder = tmp_path_factory.mktemp("runs")
    case = str(write_case(t_case(), folder / "t.case"))
    made = (
        ("replay", case, "--trials", "8", "--no-video", "--out", str(folder / "replay")),
        ("study", case, "--vary", "friction=0:0.8", "--vary", "place_xy=normal:3%", "--trials",
         "40", "--out", str(folder / "study")),
        ("shake", case, "--json", str(folder / "shake.json")),
    )  # fmt: skip
    for words in made:
        assert main(words) == 0
    for name in ("escape.json", "regress.json"):
        shutil.copy(DATA / name, folder / name)
    jams = json.loads(JAMS.read_text())
    jams["cases"] = jams["cases"][:2]
    (folder / "jams.json").write_text(json.dumps(jams))
    spoil(folder / "replay", folder / "failed")
    return folder


def spoil(source: Path, folder: Path) -> None:
    """A replay as it would be had trials 2 and 5 jammed, with a video that is one by name."""
    shutil.copytree(source, folder)
    document = json.loads((folder / "replay.json").read_text())
    table = read_table(folder / "trials.parquet")
    outcome = np.array(table["outcome"].to_pylist(), dtype=object)
    outcome[[2, 5]] = "jammed"
    place = table.schema.get_field_index("outcome")
    kind = table["outcome"].type  # type: ignore[attr-defined]
    column = pa.array(outcome.tolist()).cast(kind)
    write_table(
        table.set_column(place, "outcome", column), folder / "trials.parquet", words_of(table)
    )
    for run in (document, document["runs"][0]):
        run["target"] -= 2
        run["jammed"] += 2
        run["failures"] = ["T, guaranteed set: 2 of 8 did not end in the target grasp (2 jammed)"]
    document["passed"] = False
    (folder / "replay.json").write_text(json.dumps(document))
    (folder / "replay.mp4").write_bytes(b"\0\0\0\x18ftypmp42" + bytes(1000))


def page_of(path: Path, out: Path) -> str:
    """The page of an output, as the command writes it."""
    assert main(("report", str(path), "--out", str(out))) == 0
    return out.read_text(encoding="utf-8")


@pytest.fixture(scope="session")
def pages(runs: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """The page of every kind."""
    folder = tmp_path_factory.mktemp("pages")
    found = {kind: folder / f"{kind}.html" for kind in KINDS}
    for kind, path in found.items():
        page_of(runs / kind, path)
    return found


@pytest.fixture
def opened(browser: Any) -> Iterator[Opened]:  # noqa: F811
    """Opens a page from the disk; fails if it complains or asks any host for anything."""
    with watched(browser) as open_page:

        def open_file(path: Path, wide: int = 1280, tall: int = 900, **more: Any) -> Any:
            address = path.as_uri()
            own = lambda url: url == address or url.startswith("data:")  # noqa: E731
            return open_page(address, own, wide, tall, **more)

        yield open_file
