"""Exact pieces of the outlines that ship and of outlines that are nasty."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from icage.outline import Outline
from models import CASES
from sim.world.convex_pieces import MAX_PIECE_EDGES, convex_pieces
from tests.sim.grasps import case_outline

NAMES = sorted(file.stem for file in CASES.glob("*.json"))


def comb(teeth: int) -> Outline:
    """A base line with sharp, thin teeth."""
    top = [[x / 2 + 0.25 * (k % 2), 2.0 if k % 2 else 0.1] for k, x in enumerate(range(teeth))]
    return Outline([[0.0, 0.0], [teeth / 2, 0.0], *top[::-1]])


@pytest.mark.parametrize("name", NAMES)
def test_pieces_cover_the_outline_of_every_case(name: str) -> None:
    outline, _, _ = case_outline(name)
    pieces = [shapely.Polygon(piece) for piece in convex_pieces(outline)]
    assert sum(piece.area for piece in pieces) == pytest.approx(outline.area, rel=1e-14)
    assert shapely.union_all(pieces).symmetric_difference(outline.polygon).area < 1e-12
    given = {tuple(v) for v in outline.vertices.tolist()}
    for piece in pieces:
        assert piece.exterior.is_ccw
        assert piece.convex_hull.area == pytest.approx(piece.area, rel=1e-14)
        assert len(piece.exterior.coords) - 1 <= MAX_PIECE_EDGES
        assert {tuple(v) for v in np.array(piece.exterior.coords).tolist()} <= given


def test_pieces_of_a_comb() -> None:
    outline = comb(21)
    pieces = convex_pieces(outline)
    assert sum(shapely.Polygon(p).area for p in pieces) == pytest.approx(outline.area, rel=1e-14)
    assert len(pieces) < len(outline)
