"""Laws of the plan that hold for any object: valid shapes crossed with both methods and frames."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from icage.agreement import disagreements
from icage.contact_space.method import ContactSpace
from icage.outline import Outline
from icage.planner import plan
from tests.oracles.geometry import unit_hand
from tests.oracles.path_check import path_facts
from tests.oracles.polygons import rotated
from tests.zoo.shapes import VALID
from tests.zoo.specimens import EXACT, ROUNDING, Specimen, specimen


def _outline(one: Specimen) -> None:
    x, y = (one.outline.vertices - one.outline.vertices[0]).T
    assert np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) > 0.0
    again = Outline(one.outline.vertices)
    assert again.vertices.tobytes() == one.outline.vertices.tobytes()
    assert not one.outline.vertices.flags.writeable
    assert 0.0 < one.outline.area < one.size**2
    assert repr(one.outline).startswith("<Outline: ")


def _plan(one: Specimen) -> None:
    for cage in one.cages:
        assert cage.status in ("cage", "never_escapes")
        top = cage.sigma_largest if cage.sigma_max is None else cage.sigma_max
        assert top is not None
        first = top if cage.sigma_first is None else cage.sigma_first
        assert 0.0 < cage.sigma_0 <= first <= top
        if cage.sigma_max_upper is not None and cage.sigma_max is not None:
            assert cage.sigma_max <= cage.sigma_max_upper
        levels = [p.sigma for p in cage.punctures]
        assert levels == sorted(levels)
        if cage.status == "cage":
            assert cage.punctures[-1].sigma == cage.sigma_max
            assert cage.punctures[0].sigma == cage.sigma_first
        assert cage.adjusted_by <= 1e-5 * one.size
        for grasp in cage.grasps:
            assert cage.sigma_max is None or grasp.sigma < cage.sigma_max
            assert grasp.target == (grasp.id == 0)
            for p in grasp.contacts:
                assert one.ring.depth(p, cage.finger_radius) <= ROUNDING * one.size


def _both_methods(one: Specimen) -> None:
    other = plan(one.outline, one.cage.contacts, method=ContactSpace())
    assert disagreements(one.cage, other) == []
    assert len(other.grasps) == len(one.cage.grasps)


def _turned_shape(one: Specimen) -> None:
    """About a vertex, so that no digits are lost far from the origin."""
    for cage in one.cages:
        pivot = one.outline.vertices[0]
        ring = rotated(one.outline.vertices - pivot, 2.0)
        contacts = rotated(cage.contacts - pivot, 2.0)
        other = plan(Outline(ring), contacts, cage.finger_radius)
        # a million diameters away a coordinate keeps ten digits of the object, else sixteen
        lost = 1e-15 * float(np.abs(one.outline.vertices).max()) / one.size
        assert disagreements(cage, other, EXACT + 100.0 * lost) == []
        assert len(other.grasps) == len(cage.grasps)


def _relabelled_hand(one: Specimen) -> None:
    for first in (1, 2):
        other = plan(one.outline, np.roll(one.cage.contacts, -first, axis=0))
        for name in ("sigma_first", "sigma_max"):
            a, b = getattr(one.cage, name), getattr(other, name)
            assert (a is None) == (b is None)
            if a is not None:
                assert b / other.sigma_0 == pytest.approx(a / one.cage.sigma_0, rel=EXACT)


def _escape_path(one: Specimen) -> None:
    for cage in one.cages:
        if cage.status == "never_escapes":
            assert cage.escape_path is None
            continue
        assert cage.escape_path is not None
        hand = unit_hand(cage.contacts)
        facts = path_facts(one.ring, hand, cage.escape_path, cage.contacts, cage.finger_radius)
        level = cage.sigma_max_upper if cage.finger_radius else cage.sigma_max
        assert level is not None
        assert facts.sigma_max <= level * (1.0 + EXACT)
        assert facts.sigma_end == 0.0
        assert facts.start_gap <= ROUNDING * one.size
        assert facts.depth <= ROUNDING * one.size
        assert cage.min_finger_gap is not None
        assert cage.min_finger_gap <= facts.finger_gap + ROUNDING * one.size


LAWS: dict[str, Callable[[Specimen], None]] = {
    "Outline": _outline,
    "plan": _plan,
    "plan by contact space": _both_methods,
    "plan of the turned shape": _turned_shape,
    "plan of a relabelled hand": _relabelled_hand,
    "escape path": _escape_path,
}
"""A new function is one line: its name and a check of one specimen."""


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("name", [shape.name for shape in VALID])
def test_law(name: str, law: str) -> None:
    LAWS[law](specimen(name))
