"""Pieces of the plane as thin as 1e-8 rad: nothing that gives a little reaches beyond their tips.

The outlines were found by fuzzing (docs/decisions/0020-fuzzing.md); they stand for their kind.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely

from icage.agreement import disagreements
from icage.arrays import FloatArray
from icage.cells.free_space import FreeSpace
from icage.cells.kernels.largest import _holds as holds  # pyright: ignore[reportPrivateUsage]
from icage.cells.kernels.plateau import translations
from icage.contact_space.exploration import Plane
from icage.geometry.exterior import Pieces
from icage.geometry.tips import SHARP, Tips, sharp_tips
from icage.hand import HandShape
from icage.outline import Outline
from icage.planner import plan
from icage.tolerance import SLIDE_GIVE

SPIKED_L = [
    [1.0, 0.0], [2.0, 0.0], [2.000000008746895, -1.6914326113211343e-08], [2.0, 1.0], [0.0, 1.0],
    [0.0, -1.0], [1.0, -1.0],
]  # fmt: skip
ON_L = [[1.711274279380465, 1.0], [0.0, -0.6692143742870347], [1.0, 0.0]]
"""Held to first order: finger 2 on the left, finger 3 in the concave corner."""

CROWN = [
    [0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [2.0, 1.0], [0.0, 2.0],
    [-2.2448737989532235e-09, 2.000000060902411],
]  # fmt: skip
ON_CROWN = [[2.5, 1.25], [0.5, 1.75], [1.375, 0.0]]

HOOK = [
    [0.0, 0.375], [-0.375, 0.375], [-0.625, 0.0], [-0.625, -0.5], [-0.25, -0.875], [0.5, -1.0],
    [0.5, -0.875], [-0.125, -0.75], [-0.5, -0.375], [-0.5, 0.0], [-0.25, 0.25], [0.0, 0.25],
]  # fmt: skip
ON_HOOK = [
    [-0.6250070849784273, -0.12499999999999112], [0.060540865738416716, -0.926763993663286],
    [0.061701579878232604, -0.7873330906869965],
]  # fmt: skip
TINY = 7.08497842655825e-06

SPLIT_STAR = [
    [0.7665865592161866, 0.15642944919805526], [0.2662855181196872, 0.18459231370969081],
    [0.2519631016158469, 0.4267552324563057], [0.2519630833824118, 0.42675521478519857],
    [-0.085360339557639, 0.3572369184110417], [-0.08535829712289376, 0.3572379182544066],
    [-0.3672504270621414, 0.6307657225940796], [-0.6789288883824632, 0.5946007698101037],
    [-0.7026935609780954, -0.030166712115112154], [-0.7360933168553213, -0.26961821112009476],
    [-0.20740184432510933, -0.28030175557692105], [-0.015109459910769507, -0.33249768212824116],
    [0.10665694759429778, -0.7337807690693073], [0.5588032506880506, -0.5233818908109142],
    [0.5956562592639854, -0.2262261171892451],
]  # fmt: skip
ON_STAR = [
    [-0.015109459910769603, -0.332497682128241], [0.2662855181196872, 0.18459231370969081],
    [-0.085360339557639, 0.3572369184110417],
]  # fmt: skip
"""Held at three concave corners, one of them cut by an edge of 2e-6: the hand there can do nothing,
the one beside it is a cage."""


@pytest.mark.parametrize(
    ("ring", "contacts", "radius"),
    [
        (SPIKED_L, ON_L, 0.0),
        (CROWN, ON_CROWN, 0.0),
        (HOOK, ON_HOOK, TINY),
        (SPLIT_STAR, ON_STAR, 0.0),
    ],
    ids=["slide", "region", "discs", "isolated"],
)
def test_methods_agree_where_pieces_are_slivers(
    ring: list[list[float]], contacts: list[list[float]], radius: float
) -> None:
    cells, space = (plan(ring, contacts, radius, method) for method in ("cells", "contact-space"))
    assert cells.status == "cage"
    assert disagreements(cells, space, 1e-9) == []
    assert len(cells.grasps) == len(space.grasps)
    assert not space.warnings


def spiked(angle: float, spin: float) -> tuple[Outline, FloatArray]:
    """The L, its lower right corner drawn out to a needle, and a grasp on it; both turned."""
    ring = np.array(SPIKED_L)
    ring[2] = [2.0 + 0.5 * angle, -angle]
    turn = np.array([[math.cos(spin), math.sin(spin)], [-math.sin(spin), math.cos(spin)]])
    return Outline(ring @ turn), np.array(ON_L) @ turn


@pytest.mark.parametrize("spin", [0.0, 2.9])
@pytest.mark.parametrize("angle", [1e-3, 1e-6, 2e-8])
def test_a_hand_that_slides_stays_beside_its_pieces(angle: float, spin: float) -> None:
    outline, contacts = spiked(angle, spin)
    space = FreeSpace.around(outline, HandShape.from_contacts(contacts))
    at = (contacts - space.origin) @ [1.0, 1j]
    w = at[1] - at[0]
    shapes = shapes_of(space.pieces)
    near = [[k for k, p in enumerate(shapes) if p.distance(shapely.Point(a.real, a.imag)) < 1e-9]
            for a in at]  # fmt: skip
    looked_at = 0
    for cell in np.stack(np.meshgrid(*near, indexing="ij"), axis=-1).reshape(-1, 3):
        for x, y in translations(space.pieces, space.z, cell, w.real, w.imag):
            fingers = complex(x, y) + w * (space.z @ [1.0, 1j])
            for finger, k in zip(fingers, cell, strict=True):
                off = shapes[k].distance(shapely.Point(finger.real, finger.imag))
                assert off <= 3.0 * SLIDE_GIVE * outline.diameter
            looked_at += 1
    assert looked_at


@pytest.mark.parametrize("spin", [0.0, 2.9])
@pytest.mark.parametrize("angle", [1e-3, 1e-6, 2e-8])
def test_regions_of_slivers_keep_the_third_finger_in_them(angle: float, spin: float) -> None:
    outline, contacts = spiked(angle, spin)
    plane = Plane.around(outline, HandShape.from_contacts(contacts))
    space = plane.space
    slivers = np.flatnonzero(np.diff(space.tip_ptr) > 0)
    assert len(slivers)
    shapes = [
        shapely.Polygon(np.column_stack([space.slot_x[a:b], space.slot_y[a:b]]))
        for a, b in zip(space.ptr[:-1], space.ptr[1:], strict=True)
    ]
    looked_at = 0
    for c in slivers.tolist():
        for i, j, k in np.ndindex(3, space.edges, space.edges):
            region = np.array([i, j, k, c])
            for s, u in plane.corners(region):
                third = plane.fingers(plane.hand_at(region, float(s), float(u)))[(i + 2) % 3]
                off = shapes[c].distance(shapely.Point(float(third.real), float(third.imag)))
                assert off <= 25.0 * space.clip
                looked_at += 1
    assert looked_at


def test_a_point_beyond_the_tip_of_a_sliver_is_not_in_it() -> None:
    outline, pieces, tips = spiked_pieces(2e-8)
    give, seen = 1e-9 * outline.diameter, 0
    for k, shape in enumerate(shapes_of(pieces)):
        for tip in range(tips.tip_ptr[k], tips.tip_ptr[k + 1]):
            x, y = tips.tip_x[tip], tips.tip_y[tip]
            nx, ny = tips.tip_nx[tip], tips.tip_ny[tip]
            assert shape.distance(shapely.Point(x, y)) <= 1e-15
            for beyond, held in ((0.5, True), (2.0, False), (1e5, False)):
                px, py = x - beyond * give * nx, y - beyond * give * ny
                assert holds(pieces, k, px, py, give) == held
            seen += 1
    assert seen


def test_tips_are_where_a_piece_is_sharp() -> None:
    _, pieces, tips = spiked_pieces(1e-3)
    for k, shape in enumerate(shapes_of(pieces)):
        ring = shapely.get_coordinates(shape.exterior)[:-1]
        ahead, back = np.roll(ring, -1, axis=0) - ring, np.roll(ring, 1, axis=0) - ring
        way = (ahead @ [1.0, 1j]) / (back @ [1.0, 1j])
        sharp = ring[np.abs(np.angle(way)) < SHARP]
        a, b = tips.tip_ptr[k : k + 2]
        assert np.column_stack([tips.tip_x[a:b], tips.tip_y[a:b]]).tolist() == sharp.tolist()
        inside = (ring[:, None] - np.column_stack([tips.tip_x, tips.tip_y])[a:b]) * np.column_stack(
            [tips.tip_nx, tips.tip_ny]
        )[a:b]
        assert (inside.sum(axis=2) >= 0.0).all()


def spiked_pieces(angle: float) -> tuple[Outline, Pieces, Tips]:
    """The object with its needle, the pieces round it, and their tips."""
    outline, contacts = spiked(angle, 2.9)
    pieces = FreeSpace.around(outline, HandShape.from_contacts(contacts)).pieces
    return outline, pieces, sharp_tips(pieces)


def shapes_of(pieces: Pieces) -> list[shapely.Polygon]:
    """The pieces as polygons."""
    corners = [
        pieces.slot_vertex[a:b] for a, b in zip(pieces.ptr[:-1], pieces.ptr[1:], strict=True)
    ]
    return [shapely.Polygon(np.column_stack([pieces.x[v], pieces.y[v]])) for v in corners]
