"""Faults planted in either engine: the comparison must see each of them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import icage.cells.free_space
import icage.cells.method
import icage.contact_space.exploration as exploration
import icage.contact_space.surroundings as surroundings
from icage.agreement import disagreements
from icage.contact_space.method import CONTACT_SPACE, ContactSpace
from icage.formats.case_json import read_case
from icage.geometry.exterior import Pieces
from icage.geometry.kernels.pieces import BOX
from icage.planner import plan
from models import CASES

NAMES = ("tunnel_golden", "cross_multi", "rand16_best", "hook_deep_multi", "pliers_best")


def differing(names: tuple[str, ...] = NAMES, method: ContactSpace = CONTACT_SPACE) -> list[str]:
    """Cases on which the two methods disagree."""
    found: list[str] = []
    for name in names:
        case = read_case(CASES / f"{name}.json")
        cells = plan(case.outline, case.contacts)
        if disagreements(cells, plan(case.outline, case.contacts, 0.0, method)):
            found.append(name)
    return found


def test_without_faults_they_agree() -> None:
    assert differing() == []


def test_a_dropped_tunnel_rule_is_seen() -> None:
    assert "tunnel_golden" in differing(method=ContactSpace(tunnels=False))


def test_a_pass_off_by_1e_5_in_contact_space_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    def off(*args: Any, **options: Any) -> Any:
        space, origin = surroundings.surroundings(*args, **options)
        return space._replace(rho=space.rho * np.array([1.0, 1.0 + 1e-5, 1.0])), origin

    monkeypatch.setattr(exploration, "surroundings", off)
    assert differing()


def test_a_pass_off_by_1e_5_in_the_cells_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    explore = icage.cells.free_space.explore

    def off(*args: Any) -> Any:
        found = explore(*args)
        return found._replace(level=found.level * (1.0 + 1e-5))

    monkeypatch.setattr(icage.cells.free_space, "explore", off)
    assert differing() == list(NAMES)


def without_diagonal(exterior: Callable[..., Any], number: int) -> Callable[..., Any]:
    """``exterior_pieces`` with one diagonal shut on both sides."""

    def shut(*args: Any, **options: Any) -> tuple[Pieces, Any]:
        pieces, origin = exterior(*args, **options)
        ends = {}
        for slot, vertex in enumerate(pieces.slot_vertex.tolist()):
            piece = int(np.searchsorted(pieces.ptr, slot, side="right")) - 1
            after = slot + 1 if slot + 1 < pieces.ptr[piece + 1] else int(pieces.ptr[piece])
            ends[slot] = frozenset((vertex, int(pieces.slot_vertex[after])))
        inner = [s for s in ends if pieces.slot_neighbour[s] >= 0]
        diagonals = sorted({tuple(sorted(ends[s])) for s in inner})
        gone = frozenset(diagonals[number % len(diagonals)])
        neighbour = pieces.slot_neighbour.copy()
        neighbour[[s for s in inner if ends[s] == gone]] = BOX
        return pieces._replace(slot_neighbour=neighbour), origin

    return shut


@pytest.mark.parametrize(
    "module", [surroundings, icage.cells.free_space], ids=["contact space", "cells"]
)
def test_a_missing_diagonal_is_seen(module: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    exterior = module.exterior_pieces
    seen = 0
    for number in range(12):
        monkeypatch.setattr(module, "exterior_pieces", without_diagonal(exterior, number))
        seen += bool(differing(("rand16_best", "pliers_best")))
    # many diagonals lie where no way out ever passes; those that matter must show
    assert seen >= 2
