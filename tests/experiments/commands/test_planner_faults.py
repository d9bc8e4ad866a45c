"""Inputs that once ended in an exception or in two answers."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.experiments.commands.runner import here

INPUTS = Path(__file__).parents[3] / "tests" / "inputs"


@pytest.mark.parametrize(
    ("name", "words"),
    [("needle_2e10", "no area"), ("tiny_1e-160", "the diameter 5e-159; at least")],
)
@pytest.mark.filterwarnings("error")
def test_too_thin_and_too_small(name: str, words: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert words in here(capsys, "plan", str(INPUTS / f"{name}.json")).error_line()


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("method", ["cells", "contact-space", "both"])
def test_both_methods_cut_depths_alike(method: str, capsys: pytest.CaptureFixture[str]) -> None:
    path = str(INPUTS / "disagree_needle_1e4.json")
    result = here(capsys, "plan", path, "--method", method, "--json", "-")
    assert result.code == 0, result
    assert json.loads(result.out)["verdict"] == "not_a_cage"


def test_grasps_tell_what_failed(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("icage.discs.true_curve._TRIES", 0)
    path = str(INPUTS / "slot_disc_grasps.json")
    result = here(capsys, "grasps", path, "--finger-radius", "2", "--top", "1", "--json", "-")
    assert result.code == 0, result
    document = json.loads(result.out)
    assert len(document["grasps"]) == 1
    failed = len(document["failed"])
    assert failed >= 1
    assert document["triples_left_out"] == document["searches_broken_off"] == 0
    assert (
        f"candidates that are no grasps of these fingers: {failed} ({failed} a finger leaves"
        in result.err
    )
