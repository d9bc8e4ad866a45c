"""What is no run's output, or a broken one, is one line; no page is made of it."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.experiments.commands.runner import here

VOID = {"meta", "img", "input", "br", "link"}


ODD = (None, True, -1, 0, 1e308, 10**30, "", "<b>", [], {}, [[]], [{}], [1, 2], 0.5, 2**63)


def broken(text: str, key: str, value: Any) -> str:
    """A document with another value of a key, wherever it first is (``A/B``: in A)."""

    def changed(part: Any) -> bool:
        if isinstance(part, dict):
            if key in part:
                part[key] = value
                return True
            return any(changed(one) for one in part.values())
        return isinstance(part, list) and any(changed(one) for one in part)

    document = json.loads(text)
    above, _, key = key.rpartition("/")
    assert changed(document[above] if above else document), key
    return json.dumps(document)


@pytest.mark.parametrize(
    ("kind", "key", "value"),
    [
        ("escape.json", "attackers", []), ("escape.json", "escapes", 10**9),
        ("escape.json", "attacks", -1), ("escape.json", "seed", "0"),
        ("escape.json", "penetration_max", None), ("escape.json", "failures", "all"),
        ("escape.json", "format", ["icage-escape/1"]), ("escape.json", "unit", 3),
        ("shake.json", "criterion", {}), ("shake.json", "pushes", [1]),
        ("shake.json", "held", "yes"), ("shake.json", "versions", {"icage": 1}),
        ("regress.json", "level", "hopeful"), ("regress.json", "cases", {}),
        ("regress.json", "attacks", {"verdict": "ok"}), ("regress.json", "seed", 1.5),
        ("jams.json", "target", 10**6), ("jams.json", "config", None),
        ("jams.json", "residual", True), ("jams.json", "format", "icage-jams/2"),
        ("replay/replay.json", "runs", []), ("replay/replay.json", "runs/trials", 9),
        ("replay/replay.json", "runs/diameter", "wide"),
        ("replay/replay.json", "runs/diameter", 0), ("shake.json", "criterion/displacement", 0),
        ("replay/replay.json", "runs/sigma_0", 0), ("escape.json", "diameter", -1),
        ("replay/replay.json", "runs/plan", None), ("regress.json", "case", {}),
        ("study/study.json", "found", None), ("study/study.json", "config", {}),
        ("study/study.json", "finished", False), ("study/study.json", "outcomes", {"target": 40}),
        ("study/study.json", "independent", {"trials": 1, "closed": 2, "target": 3}),
        ("study/study.json", "variables", {"nothing": {"bins": []}}),
        ("study/study.json", "seed", 77), ("study/study.json", "failed", 30),
    ],
)  # fmt: skip
def test_a_broken_document_is_one_line(
    kind: str, key: str, value: Any, runs: Path, tmp_path: Path, capsys: Any
) -> None:
    folder, _, name = kind.rpartition("/")
    place = tmp_path / "run"
    if folder:
        shutil.copytree(runs / folder, place)
    else:
        place.mkdir()
    (place / name).write_text(broken((runs / kind).read_text(), key, value))
    before = sorted(p.name for p in place.iterdir())
    here(capsys, "report", str(place / name)).error_line()
    assert sorted(p.name for p in place.iterdir()) == before


def test_what_is_no_output_is_one_line(runs: Path, tmp_path: Path, capsys: Any) -> None:
    def line(*words: str) -> str:
        return here(capsys, "report", *words).error_line()

    assert "is not there" in line(str(tmp_path / "none"))
    assert "holds no output" in line(str(tmp_path))
    (tmp_path / "x.json").write_text("{")
    assert "not valid JSON" in line(str(tmp_path / "x.json"))
    assert "holds no output" in line(str(tmp_path))
    for name in ("escape.json", "shake.json"):
        shutil.copy(runs / name, tmp_path / name)
    assert "several documents" in line(str(tmp_path))
    assert "ending in .html" in line(str(runs / "replay"), "--out", "a.txt")
    (tmp_path / "escape.html").write_text("<p>mine")
    assert "is there and no report" in line(str(tmp_path / "escape.json"))
    assert (tmp_path / "escape.html").read_text() == "<p>mine"


def test_a_table_of_another_run_is_refused(runs: Path, tmp_path: Path, capsys: Any) -> None:
    for name, other in (("replay", "failed"), ("study", "replay"), ("replay", "study")):
        place = tmp_path / f"{name}-{other}"
        shutil.copytree(runs / name, place)
        shutil.copy(runs / other / "trials.parquet", place / "trials.parquet")
        here(capsys, "report", str(place)).error_line()
    place = tmp_path / "cut"
    shutil.copytree(runs / "study", place)
    table = (place / "trials.parquet").read_bytes()
    (place / "trials.parquet").write_bytes(table[: len(table) // 2])
    assert "damaged" in here(capsys, "report", str(place)).error_line()


@pytest.mark.parametrize("kind", ["escape.json", "shake.json", "regress.json", "jams.json"])
def test_any_value_of_a_document_may_be_another(
    kind: str, runs: Path, tmp_path: Path, capsys: Any
) -> None:
    """A page, or one line; never our fault."""
    rng = np.random.default_rng(1)
    whole, file = (runs / kind).read_text(), tmp_path / "x.json"
    for _ in range(25):
        document = json.loads(whole)
        part: Any = document
        while True:
            keys = list(part) if isinstance(part, dict) else list(range(len(part)))
            key = keys[rng.integers(len(keys))]
            if not (isinstance(part[key], dict | list) and part[key]) or rng.random() < 0.15:
                break
            part = part[key]
        part[key] = ODD[rng.integers(len(ODD))]
        file.write_text(json.dumps(document))
        result = here(capsys, "report", str(file))
        assert result.code == 0 or result.error_line(), (key, part[key])
