"""Friction leaves |theta| <= atan(mu); speed and time step change nothing that counts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from icage.errors import InputError
from sim.config import SimConfig
from sim.friction import SLACK, friction_row, friction_table
from sim.quasi_static import compare, variant_config
from tests.sim.grasps import l_shape, starts_near, t_shape, triangle
from tests.sim.test_shake import skew

BRIEF = replace(SimConfig(), max_time=0.5)


@pytest.mark.parametrize("mu", [0.05, 0.1, 0.2])
def test_a_jammed_three_edge_grasp_is_turned_by_the_angle_of_friction_at_most(mu: float):
    known = triangle()
    starts = starts_near(known, 5, seed=1, opening=1.3, turn=0.4)
    row = friction_row(known.scene(BRIEF), known.contacts, starts, mu)
    assert row.on_edges >= 4
    assert row.holds
    assert row.worst <= row.bound + SLACK
    assert row.worst > 0.3 * row.bound  # it does jam: the bound is not idle


@pytest.mark.slow
@pytest.mark.parametrize("make", [triangle, skew], ids=["equilateral", "skew"])
def test_the_friction_table(make):
    known = make()
    starts = starts_near(known, 40, seed=2, opening=1.3, turn=0.4)
    scene = known.scene(replace(SimConfig(), max_time=1.0))
    rows = friction_table(scene, known.contacts, starts)
    assert [row.mu for row in rows] == [0.0, 0.05, 0.1, 0.2]
    assert all(row.holds for row in rows), rows
    assert rows[0].worst < 1e-6
    assert rows[0].settled == rows[0].on_edges == 40
    assert rows[1].worst < rows[2].worst < rows[3].worst


def test_the_bound_is_for_three_edges():
    known = l_shape()
    starts = starts_near(known, 1, seed=1)
    with pytest.raises(InputError, match="three edges"):
        friction_row(known.scene(BRIEF), known.contacts, starts, 0.1)


@pytest.mark.parametrize("make", [triangle, l_shape, t_shape])
def test_twice_slower_or_half_the_time_step_changes_no_end(make):
    known = make()
    starts = starts_near(known, 3, seed=3, opening=1.3)
    # with half a step some closings creep at a rate just above still_speed: judged by pose
    scene = known.scene(replace(SimConfig(), max_time=1.5))
    for variant in compare(scene, [known], starts, [(0.5, 1.0), (1.0, 0.5)]):
        assert variant.changed == 0
        assert variant.same
        assert variant.position < 1e-6
        assert variant.angle < 1e-5


def test_what_breaks_is_seen():
    """A hundred times the force: the ends are others, and fingers are deep in the object."""
    known = l_shape()
    starts = starts_near(known, 10, seed=3, opening=1.4, turn=0.2)
    scene = known.scene(replace(SimConfig(), max_time=1.0))
    (wild,) = compare(scene, [known], starts, [(300.0, 4.0)])
    assert wild.penetration > 1e-2
    assert not wild.same


def test_a_variant_keeps_what_stillness_means():
    slow = variant_config(SimConfig(), 0.5, 0.5)
    usual = SimConfig()
    assert slow.free_speed == pytest.approx(0.5 * usual.free_speed)
    assert slow.max_steps == 4 * usual.max_steps
    assert slow.still_speed == 0.5 * usual.still_speed
    assert np.isclose(slow.contact_solref, usual.contact_solref)
