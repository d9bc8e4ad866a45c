"""The minimum nearest to a hand, slides and cells that are lowest: by the cells all round."""

from __future__ import annotations

import numpy as np
import pytest

from icage.cells.free_space import FreeSpace
from icage.cells.kernels import minimum as module
from icage.cells.kernels.facet import facet_of
from icage.cells.kernels.minimum import _nearest_on, _shift, _slid_to, _turn, nearest_minimum
from icage.cells.kernels.near import Hand
from icage.cells.kernels.passes import new_room, pass_value
from icage.cells.kernels.plateau import plateau_through
from icage.cells.kernels.tree import births, lowest_cells
from icage.hand import HandShape
from icage.outline import Outline
from tests.icage.cells.setting import Setting

pytestmark = pytest.mark.usefixtures("plain")


def test_a_hand_slides_along_the_longest_chord_of_its_translations(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    corners = {
        "none": np.empty((0, 2)), "one": np.array([[2.0, 3.0]]),
        "chord": np.array([[0.0, 0.0], [2.0, 1e-9], [4.0, 2.0], [2.0, 1.0]]),
    }  # fmt: skip
    to = Hand(3.0, -1.0, 1.0, 0.0)
    for name, known in (("none", (9.0, 8.0)), ("one", (2.0, 3.0)), ("chord", (2.0, 1.0))):
        monkeypatch.setattr(module, "translations", lambda *_, name=name: corners[name])
        assert _slid_to(None, None, None, 9.0, 8.0, 1.0, 0.0, to) == pytest.approx(known)
        beyond = to._replace(d_x=30.0)
        found = _slid_to(None, None, None, 0.1, 0.0, 1.0, 0.0, beyond)
        if name == "chord":
            assert found == pytest.approx((4.0, 2.0))


def test_moves_and_turns_of_hands() -> None:
    rng = np.random.default_rng(3)
    z = np.array([[0.0, 0.0], [1.0, 0.0], [0.3, 0.9]])
    for _ in range(20):
        a, b = rng.normal(size=(2, 4))
        fingers = [complex(*h[:2]) + complex(*h[2:]) * (z @ [1.0, 1j]) for h in (a, b)]
        far = np.abs(fingers[0] - fingers[1]).max()
        assert _shift(z, *a, Hand(*b)) == pytest.approx(far)
        turn = abs(np.angle(complex(*b[2:]) / complex(*a[2:])))
        assert _turn(*a[2:], Hand(*b)) == pytest.approx(turn)
        p, q, w = rng.normal(size=(3, 2))
        t = np.clip((w - p) @ (q - p) / ((q - p) @ (q - p)), 0.0, 1.0)
        assert _nearest_on(*p, *q, *w) == pytest.approx(tuple(p + t * (q - p)))
    assert _turn(0.0, 0.0, Hand(0.0, 0.0, 1.0, 1.0)) == 0.0
    assert _turn(1.0, 1.0, Hand(0.0, 0.0, 0.0, 0.0)) == 0.0
    assert _turn(0.0, 1.0, Hand(0.0, 0.0, 1.0, 0.0)) == pytest.approx(0.5 * np.pi)
    assert _turn(1.0, 0.0, Hand(0.0, 0.0, 0.0, 1.0)) == pytest.approx(0.5 * np.pi)
    assert _nearest_on(1.0, 2.0, 1.0, 2.0, 5.0, 5.0) == (1.0, 2.0)


@pytest.mark.parametrize("size", [1.0, 40.0, 0.05])
def test_the_nearest_minimum_on_a_plateau_is_where_it_was_asked_for(size: float) -> None:
    """A bar between two fingers below and one above: along it nothing changes."""
    outline = Outline(size * np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [0.0, 1.0]]))
    contacts = size * np.array([[1.2, 0.0], [2.8, 0.0], [2.0, 1.0]])
    s = Setting(0)
    s.space = FreeSpace.around(outline, HandShape.from_contacts(contacts))
    space = s.space
    at = (contacts - space.origin) @ [1.0, 1j]
    for off in (0.0, 0.4 * size, -0.5 * size):
        wanted = Hand(at[0].real + off, at[0].imag, (at[1] - at[0]).real, 0.0)
        found = nearest_minimum(
            space.pieces, space.z, wanted, 1e-6, 1e-6, space.cap, space.worst, 10**6
        )
        assert found.row >= 0
        assert found.near[found.row, :4] == pytest.approx(np.array(wanted), abs=1e-9 * size)
        assert found.near[found.row, 4] == pytest.approx(1.6 * size)
        assert found.plateau.long
        ends = sorted([found.plateau.a_x, found.plateau.b_x])
        # finger 1 from the lower left corner to where finger 2 is at the lower right one
        assert ends == pytest.approx(
            [-space.origin[0], 2.4 * size - space.origin[0]], abs=1e-6 * size
        )
        again = plateau_through(
            space.pieces, space.z, wanted, 1.6 * size, space.cap, space.worst, 10**6
        )
        assert sorted([again.a_x, again.b_x]) == pytest.approx(ends, abs=1e-9 * size)
    turned = wanted._replace(w_y=0.01 * size)
    none = nearest_minimum(space.pieces, space.z, turned, 0.1, 1e-3, space.cap, space.worst, 10**6)
    assert none.row == -1
    turned = nearest_minimum(space.pieces, space.z, turned, 0.1, 0.1, space.cap, space.worst, 10**6)
    assert turned.row >= 0
    assert turned.near[turned.row, 6] == pytest.approx(np.arctan2(0.01, 1.6), rel=1e-3)
    none = nearest_minimum(space.pieces, space.z, wanted, 0.1, 0.1, space.cap, space.worst, 0)
    assert none.row == -1
    assert none.total > 0


@pytest.mark.parametrize("turn", [0.3, 0.5 * np.pi, 2.0, -1.1])
def test_a_turned_bar_has_its_minimum_where_it_was_asked_for(turn: float) -> None:
    way = np.exp(1j * turn)
    bar, held = ([1.0, 1j] @ np.array(points).T * way for points in (
        [[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [0.0, 1.0]], [[1.2, 0.0], [2.8, 0.0], [2.0, 1.0]],
    ))  # fmt: skip
    contacts = np.column_stack([held.real, held.imag])
    outline = Outline(np.column_stack([bar.real, bar.imag]))
    space = FreeSpace.around(outline, HandShape.from_contacts(contacts))
    w = held[1] - held[0]
    for off in (0.0, 0.6, -0.9, 1.1):
        at = held[0] + off * way - complex(*space.origin)
        wanted = Hand(at.real, at.imag, w.real, w.imag)
        found = nearest_minimum(
            space.pieces, space.z, wanted, 1e-6, 1e-6, space.cap, space.worst, 10**6
        )
        assert found.row >= 0
        assert found.near[found.row, :4] == pytest.approx(np.array(wanted), abs=1e-9)
        assert found.plateau.long


@pytest.mark.parametrize("seed", range(6))
def test_the_nearest_minimum_is_the_target_from_beside_it(seed: int) -> None:
    s = Setting(seed, [1.0, 40.0, 0.05][seed % 3])
    rng = s.rng
    args = (s.space.cap, s.space.worst, 10**6)
    off = 1e-3 * s.size * rng.uniform(-1, 1, 4)
    wanted = Hand(*(np.array(s.hand) + off))
    found = nearest_minimum(s.pieces, s.z, wanted, 0.02, 0.02, *args)
    assert found.row >= 0
    near = found.near[found.row]
    moved = _shift(s.z, *wanted, s.hand) / s.size
    assert near[5] <= moved + 1e-9
    hand = complex(*near[:2]) + complex(*near[2:4]) * (s.z @ [1.0, 1j])
    asked = complex(*wanted[:2]) + complex(*wanted[2:]) * (s.z @ [1.0, 1j])
    assert near[5] == pytest.approx(np.abs(hand - asked).max() / s.size)
    assert (np.diff(found.near[:, 4]) >= 0.0).all()
    assert (found.near[:, 5] <= 0.02).all()
    assert (found.near[:, 6] <= 0.02).all()
    if near[5] > 0.9 * moved:
        assert hand == pytest.approx(s.fingers, abs=1e-7 * s.size)
    less = nearest_minimum(s.pieces, s.z, wanted, near[5] * 0.9, 0.02, *args)
    assert less.row < 0
    more = nearest_minimum(s.pieces, s.z, wanted, near[5] * 1.1, 0.02, *args)
    assert more.near[more.row, 5] == pytest.approx(near[5])


def test_the_lowest_cells_of_a_small_object() -> None:
    """Against all cells and their facets, one by one."""
    s = Setting(1)
    m = len(s.pieces.ptr) - 1
    args = (s.space.cap, s.space.worst)
    every = np.array([(a, b, c) for a in range(m) for b in range(m) for c in range(m)])
    born = births(s.pieces, s.z, every, *args).value[:, 0]
    room = new_room()
    lowest = lowest_cells(s.pieces, s.z, *args, 1e-9, 1e-9)
    table = dict(zip(map(tuple, every.tolist()), born.tolist(), strict=True))
    known_lowest = []
    for cell in every:
        here = table[tuple(cell.tolist())]
        if not 0.0 < here < np.inf:
            continue
        good = True
        for i in range(3):
            for slot in range(s.pieces.ptr[cell[i]], s.pieces.ptr[cell[i] + 1]):
                to = cell.copy()
                to[i] = s.pieces.slot_neighbour[slot]
                if to[i] >= 0 and table[tuple(to.tolist())] < here - 1e-9:
                    facet = facet_of(s.pieces, cell, i, slot)
                    value = pass_value(s.pieces, s.z, facet, here + 2e-9, s.space.worst, room)[0]
                    good = good and value > here + 1e-9
        if good:
            known_lowest.append(cell.tolist())
    assert lowest.cells.tolist() == known_lowest
    for cell, value in zip(lowest.cells.tolist(), lowest.birth, strict=True):
        assert value[0] == table[tuple(cell)]
        assert np.hypot(*value[1:]) == pytest.approx(value[0])
