"""Facets that no hand can reach: what boxes say, by the corners of sums of sets."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest

from icage.cells.kernels.boxes import out_of_reach
from icage.cells.kernels.facet import Facet
from tests.oracles.geometry import Floats

pytestmark = pytest.mark.usefixtures("plain")


class Drawn(NamedTuple):
    """Three pieces (n, 2) each, of fingers 0, 1 and 2, as the kernel reads them."""

    x: Floats
    y: Floats
    ptr: Floats
    slot_vertex: Floats
    scale: float

    @classmethod
    def of(cls, *pieces: Floats, scale: float = 1.0) -> Drawn:
        """In another order than their vertices."""
        points = np.concatenate([np.asarray(p, float) for p in pieces])
        place = np.random.default_rng(len(points)).permutation(len(points))
        x, y = np.empty((2, len(points)))
        x[place], y[place] = points.T
        ptr = np.cumsum([0, *map(len, pieces)])
        return cls(x, y, ptr, place, scale)

    def corners(self, piece: int) -> Floats:
        v = self.slot_vertex[self.ptr[piece] : self.ptr[piece + 1]]
        return self.x[v] + 1j * self.y[v]

    def facet(self, i: int) -> Facet:
        """Finger i on the first edge of its piece."""
        j, k = (i + 1) % 3, (i + 2) % 3
        start, end = self.slot_vertex[self.ptr[i] : self.ptr[i] + 2]
        return Facet(i, start, end, j, j, k, k)


def box(points: Floats) -> Floats:
    return np.array([points.real.min(), points.real.max(), points.imag.min(), points.imag.max()])


def apart(one: Floats, other: Floats) -> Floats:
    """How far two boxes are apart along x and y, below 0 where they overlap."""
    return np.array([max(one[a] - other[a + 1], other[a] - one[a + 1]) for a in (0, 2)])


def clear(drawn: Drawn, z: Floats, i: int, cap: float) -> float:
    """By how much a facet is out of reach, by boxes; below 0: it may not be."""
    ends, at = drawn.corners(i)[:2], z @ [1.0, 1j]
    most = -np.inf
    for j, k in (((i + 1) % 3, (i + 2) % 3), ((i + 2) % 3, (i + 1) % 3)):
        ratio = (at[k] - at[i]) / (at[j] - at[i])
        own = box(drawn.corners(k))
        foretold = ((1.0 - ratio) * ends[:, None] + ratio * drawn.corners(j)[None]).ravel()
        gap = np.maximum(0.0, apart(own, box(ends)))
        far = np.hypot(*gap) - cap * abs(at[k] - at[i])
        most = max(most, apart(own, box(foretold)).max(), far)
    return float(most)


@pytest.mark.parametrize("seed", range(4))
def test_a_facet_is_told_by_its_boxes_and_by_nothing_else(seed: int) -> None:
    rng = np.random.default_rng(seed)
    told = [0, 0]
    for _ in range(150):
        spread, size = rng.choice([0.5, 1.5, 4.0]), rng.choice([0.2, 1.0])
        pieces = [spread * rng.normal(size=2) + size * rng.normal(size=(n, 2)) for n in
                  rng.integers(3, 6, size=3)]  # fmt: skip
        drawn, z, i = Drawn.of(*pieces), rng.normal(size=(3, 2)), int(rng.integers(3))
        cap = float(rng.choice([0.3, 1.0, 5.0]))
        margin = clear(drawn, z, i, cap)
        if abs(margin) > 1e-6:
            found = out_of_reach(drawn, z, drawn.facet(i), cap)
            assert found == (margin > 0.0)
            told[int(found)] += 1
    assert min(told) > 20


@pytest.mark.parametrize("seed", range(4))
def test_no_facet_is_told_that_holds_a_hand(seed: int) -> None:
    """A hand drawn, the pieces round its fingers; cap no more than it takes."""
    rng = np.random.default_rng(seed)
    for _ in range(60):
        z, i = rng.normal(size=(3, 2)), int(rng.integers(3))
        w, d = rng.normal(size=(2, 2)) @ [1.0, 1j]
        pieces = []
        for f, p in enumerate(d + w * (z @ [1.0, 1j])):
            share = rng.dirichlet([1.0, 1.0]) if f == i else rng.dirichlet(np.ones(4))
            ring = rng.normal(size=(4, 2)) * rng.choice([1e-3, 0.1, 1.0])
            ring += [p.real, p.imag] - share @ ring[: len(share)]
            pieces.append(ring)
        drawn = Drawn.of(*pieces)
        assert not out_of_reach(drawn, z, drawn.facet(i), abs(w))


SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
FAR = 1e9


@pytest.mark.parametrize("i", range(3))
@pytest.mark.parametrize(("scale", "size"), [(1.0, 1.0), (1e3, 1.0), (1.0, 1e3)])
@pytest.mark.parametrize("turns", range(4))
def test_boxes_that_touch_are_not_apart(i: int, scale: float, size: float, turns: int) -> None:
    """Finger 3 is beside finger 2 by as much as that one is beside the first; quarter turns on.

    What is spared is more than rounding of the diameter and of the boxes, and not much more.
    """
    z = np.roll(np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]), i, axis=0)
    unit = max(scale, size)

    def asked(off: float, cap: float = FAR) -> bool:
        """The first two at 0 to 1 and 3 to 4: the third one at 5 to 8 ends where its piece does."""
        rings = [SQUARE @ [1.0, 1j] + x for x in (0.0, 3.0, 8.0 + off * unit / size)]
        turned = [size * 1j**turns * rings[(k - i) % 3] for k in range(3)]
        drawn = Drawn.of(*(np.column_stack([r.real, r.imag]) for r in turned), scale=scale)
        return bool(out_of_reach(drawn, z, drawn.facet(i), cap))

    assert not asked(0.0)
    assert not asked(1e-9)
    assert asked(3e-8)
    # finger 3 is 7 away from the first edge, and cap times 2 from finger 1
    near = 3.5 * size
    assert not asked(0.0, near)
    assert not asked(0.0, near - 0.5e-9 * unit)
    assert asked(0.0, near - 3e-8 * unit)


def test_a_hand_that_is_tall_and_touches_is_not_out_of_reach() -> None:
    """Three times as high as it is wide, at the corner of its third finger's piece."""
    z = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 3.0]])
    for scale in (1.0, 1e3):
        for off, told in ((0.0, False), (3e-8 * scale, True)):
            corner = np.array([1.0 + off, 8.0])
            drawn = Drawn.of(SQUARE, SQUARE + [3.0, 0.0], SQUARE + corner, scale=scale)
            assert out_of_reach(drawn, z, drawn.facet(0), FAR) == told
