"""Apexes over round stretches: the pieces still cover the free plane once, and no level moves."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from icage.arrays import FloatArray
from icage.cells.free_space import FreeSpace, search
from icage.cells.target import contacts_as_configuration, find_target
from icage.geometry.exterior import Pieces, exterior_pieces
from icage.geometry.round_chains import stretches, with_apexes
from icage.hand import HandShape
from icage.outline import Outline


def circle(n: int) -> FloatArray:
    angle = 2.0 * np.pi * np.arange(n) / n
    return np.column_stack([np.cos(angle), np.sin(angle)])


def facing_ends(slot: float) -> FloatArray:
    """Two round ends face each other over a slot; an apex is some 0.01 high."""
    back = shapely.LineString([(-1.0, 0.0), (-1.0, 1.0), (1.0, 1.0), (1.0, 0.0)])
    tips = [
        shapely.LineString([(k, 0.0), ((0.3 + 0.5 * slot) * k, 0.0)]).buffer(0.3, 40)
        for k in (-1.0, 1.0)
    ]
    body = shapely.union_all([back.buffer(0.1, cap_style="flat", join_style="mitre"), *tips])
    assert isinstance(body, shapely.Polygon)
    return shapely.get_coordinates(shapely.orient_polygons(body).exterior)[:-1]


def polygons(pieces: Pieces) -> list[shapely.Polygon]:
    slots = [pieces.slot_vertex[a:b] for a, b in zip(pieces.ptr[:-1], pieces.ptr[1:], strict=True)]
    return [shapely.Polygon(np.column_stack([pieces.x[v], pieces.y[v]])) for v in slots]


@pytest.mark.parametrize("ring", [circle(99), circle(300) * [1.0, 0.4], facing_ends(0.002)])
def test_pieces_cover_the_free_plane_once(ring: FloatArray) -> None:
    outline = Outline(ring)
    pieces, origin = exterior_pieces(outline, HandShape(0.5 + 0.8j))
    parts = polygons(pieces)
    assert all(p.convex_hull.area - p.area <= 1e-12 * p.area for p in parts)
    box = shapely.box(*shapely.total_bounds(parts))
    free = box.area - outline.polygon.area
    assert sum(p.area for p in parts) == pytest.approx(free, rel=1e-13)
    body = shapely.Polygon(outline.vertices - origin)
    assert max(p.intersection(body).area for p in parts) < 1e-12
    known = pieces.slot_neighbour >= 0
    owner = np.repeat(np.arange(pieces.total), np.diff(pieces.ptr))
    pairs = set(zip(owner[known].tolist(), pieces.slot_neighbour[known].tolist(), strict=True))
    assert all((b, a) in pairs for a, b in pairs)


def test_apexes_stand_clear_of_everything_else() -> None:
    ring = facing_ends(0.002)
    coarse, apexes, fans = with_apexes(ring)
    assert 0 < len(apexes) < len(stretches(facing_ends(0.2)))
    outer = shapely.Polygon(np.vstack([ring, apexes])[coarse])
    assert outer.is_valid
    covered = sum(shapely.Polygon(np.vstack([ring, apexes])[f]).area for f in fans)
    assert outer.area == pytest.approx(shapely.Polygon(ring).area + covered, rel=1e-12)


def test_angular_outlines_have_none() -> None:
    rng = np.random.default_rng(4)
    angle = np.sort(rng.uniform(0.0, 2.0 * np.pi, 60))
    star = np.column_stack([np.cos(angle), np.sin(angle)]) * rng.uniform(0.35, 1.0, 60)[:, None]
    assert stretches(star) == []
    assert stretches(circle(24)) == []


@pytest.mark.parametrize("n", [60, 99])
def test_levels_are_those_of_the_plain_pieces_from_fewer_cells(n: int) -> None:
    ring = circle(n)
    first = np.array([0, n // 3, 2 * n // 3])
    contacts = 0.5 * (ring[first] + ring[first + 1])
    outline, hand = Outline(ring), HandShape.from_contacts(contacts)
    found = []
    for apexes in (True, False):
        pieces, origin = exterior_pieces(outline, hand, apexes=apexes)
        space = FreeSpace.of_pieces(outline, hand, pieces, origin)
        target = find_target(space, contacts_as_configuration(space, contacts))
        assert target is not None
        found.append(search(space, target.cell, target.sigma_0))
    with_them, without = found
    assert with_them.level == pytest.approx(without.level, rel=1e-13)
    assert with_them.sigma_first() == pytest.approx(without.sigma_first(), rel=1e-13)
    assert len(with_them.nodes) < len(without.nodes)
