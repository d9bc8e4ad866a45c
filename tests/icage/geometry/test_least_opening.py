"""The least opening on given edges, followed where fingers leave them, and the way it may slide."""

from __future__ import annotations

import numpy as np
import pytest

from icage.geometry.least_opening import (
    NoOpeningError,
    followed_opening,
    least_opening,
    sliding_room,
)
from icage.hand import HandShape
from icage.outline import Outline
from tests.oracles.geometry import Floats, Ring
from tests.oracles.targets import random_target

BAR = Outline([[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [0.0, 1.0]])
ON_BAR = np.array([[1.2, 0.0], [2.8, 0.0], [2.0, 1.0]])


def supports(ring: Ring, contacts: Floats, within: float) -> list[tuple[int, int]]:
    """Fingers with the edges that they touch."""
    ends = np.roll(ring.vertices, -1, axis=0)
    held = []
    for k, p in enumerate(contacts):
        for j, (a, b) in enumerate(zip(ring.vertices, ends, strict=True)):
            t = np.clip((p - a) @ (b - a) / ((b - a) @ (b - a)), 0.0, 1.0)
            if np.hypot(*(a + t * (b - a) - p)) < within:
                held.append((k, j))
    return held


def test_a_grasp_is_found_from_a_part_of_its_supports() -> None:
    """A finger in a corner that is told of one of its edges only reaches into the other one."""
    whole = part = 0
    for seed in range(40):
        target = random_target(np.random.default_rng([seed, 5]))
        outline, ring = Outline(target.vertices), Ring.of(target.vertices)
        hand = HandShape.from_contacts(target.contacts)
        size = outline.diameter
        held = supports(ring, target.contacts, 1e-9 * size)
        finger, edge = np.array(held).T
        found = least_opening(outline, hand, finger, edge, target.contacts, 0.0)
        assert found == pytest.approx(target.contacts, abs=1e-6 * size)
        again, *same = followed_opening(outline, hand, finger, edge, target.contacts, 0.0)
        assert again == pytest.approx(found, abs=1e-9 * size)
        assert [a.tolist() for a in same] == [finger.tolist(), edge.tolist()]
        whole += 1
        for k in range(len(held)):
            if len(held) == 3 or sum(f == held[k][0] for f, _ in held) < 2:
                continue
            less = np.delete(np.array(held), k, axis=0)
            try:
                at, fingers, edges = followed_opening(outline, hand, *less.T, target.contacts, 0.0)
            except NoOpeningError:
                continue
            if (held[k][0], held[k][1]) in zip(fingers.tolist(), edges.tolist(), strict=True):
                assert at == pytest.approx(target.contacts, abs=1e-6 * size)
                part += 1
    assert whole == 40
    assert part >= 5


def test_a_finger_beyond_the_end_of_its_edge_rolls_on_to_the_next() -> None:
    """The triangle from a triangle with its corner cut off: the finger was told the wrong side."""
    root = 3.0**0.5
    outline = Outline([[0.0, 0.0], [1.0, 0.0], [0.9, 0.1 * root], [0.5, 0.5 * root]])
    middles = np.array([[0.5, 0.0], [0.75, 0.25 * root], [0.25, 0.25 * root]])
    hand = HandShape.from_contacts(middles)
    finger = np.array([0, 1, 2])
    found, _, edge = followed_opening(outline, hand, finger, np.array([0, 1, 3]), middles, 0.0)
    assert edge.tolist() == [0, 2, 3]
    assert found == pytest.approx(middles, abs=1e-9)


def test_edges_that_hold_no_hand_are_refused() -> None:
    hand = HandShape.from_contacts(ON_BAR)
    with pytest.raises(NoOpeningError, match="close to a point"):
        least_opening(BAR, hand, np.array([0, 1]), np.array([0, 0]), ON_BAR, 0.0)
    finger, edge = np.array([0, 0]), np.array([0, 2])
    with pytest.raises(NoOpeningError, match="no hand of this shape"):
        least_opening(BAR, hand, finger, edge, ON_BAR, 0.0)


@pytest.mark.parametrize("radius", [0.0, 0.25])
def test_a_hand_on_a_bar_slides_until_a_finger_is_at_its_end(radius: float) -> None:
    contacts = ON_BAR + radius * np.array([[0.0, -1.0], [0.0, -1.0], [0.0, 1.0]])
    finger, edge = np.array([0, 1, 2]), np.array([0, 0, 2])
    room = sliding_room(BAR, finger, edge, contacts, radius)
    assert room is not None
    ends = sorted(room, key=lambda at: at[0, 0])
    assert ends[0] == pytest.approx(contacts - [1.2, 0.0])
    assert ends[1] == pytest.approx(contacts + [1.2, 0.0])
    # a finger beside an edge of its own that it does not press on stops it there
    block = Outline([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [3.0, 3.0], [3.0, 1.0], [0.0, 1.0]])
    room = sliding_room(block, np.array([0, 1, 2, 2]), np.array([0, 0, 4, 3]), ON_BAR, 0.0)
    assert room is not None
    assert max(at[2, 0] for at in room) == pytest.approx(3.0)
    assert min(at[2, 0] for at in room) == pytest.approx(0.8)


def test_what_is_held_firmly_does_not_slide() -> None:
    root = 3.0**0.5
    triangle = Outline([[0.0, 0.0], [1.0, 0.0], [0.5, 0.5 * root]])
    middles = np.array([[0.5, 0.0], [0.75, 0.25 * root], [0.25, 0.25 * root]])
    assert sliding_room(triangle, np.arange(3), np.arange(3), middles, 0.0) is None
