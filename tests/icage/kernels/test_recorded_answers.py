"""Answers on small objects are those that were recorded: what a slip in a kernel changes first.

Elsewhere answers are held against closed forms, brute force and each other; here every number is
held, to more digits than any of these knows. An answer that is meant to change is recorded anew.
"""

from __future__ import annotations

import json
from typing import Any

import pytest

from tests.icage.kernels.answers import RECORDED, answer, questions

KNOWN: dict[str, Any] = json.loads(RECORDED.read_text())
NEAR = 1e-8
"""[1] Of a number, and of objects whose size is about one."""


def differences(found: Any, known: Any, where: str = "") -> list[str]:
    """Where two answers differ, with both numbers."""
    if isinstance(found, list) and isinstance(known, list):
        if len(found) != len(known):
            return [f"{where}: {len(found)} against {len(known)}"]
        pairs = enumerate(zip(found, known, strict=True))
        return [line for k, (a, b) in pairs for line in differences(a, b, f"{where}[{k}]")]
    if isinstance(found, float) and isinstance(known, float | int):
        return (
            []
            if abs(found - known) <= NEAR * max(1.0, abs(known))
            else [f"{where}: {found!r} against {known!r}"]
        )
    return [] if found == known else [f"{where}: {found!r} against {known!r}"]


@pytest.mark.parametrize(("asked", "name"), questions())
def test_an_answer_is_the_recorded_one(asked: str, name: str) -> None:
    found = json.loads(json.dumps(answer(asked, name)))
    assert differences(found, KNOWN[f"{asked} {name}"]) == []


def test_every_answer_is_asked_for_and_a_slip_is_seen() -> None:
    assert sorted(KNOWN) == sorted(f"{asked} {name}" for asked, name in questions())
    known = KNOWN["plan comb-1"]
    wrong = json.loads(json.dumps(known))
    wrong[1] *= 1.0 + 1e-7
    assert differences(known, known) == []
    assert len(differences(wrong, known)) == 1
