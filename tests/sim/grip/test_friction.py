"""Friction leaves |theta| <= atan(mu) of the guarantee."""

from __future__ import annotations

from dataclasses import replace

import pytest

from icage.errors import InputError
from sim.grip.friction import SLACK, friction_row, friction_table
from sim.world.config import SimConfig
from tests.sim.grasps import l_shape, starts_near, triangle
from tests.sim.grip.test_shake import skew

BRIEF = replace(SimConfig(), max_time=0.5)


@pytest.mark.parametrize("mu", [0.05, 0.1, 0.2])
def test_a_jammed_three_edge_grasp_is_turned_by_the_angle_of_friction_at_most(mu: float):
    known = triangle()
    starts = starts_near(known, 5, seed=1, opening=1.3, turn=0.4)
    row = friction_row(known.scene(BRIEF), known.contacts, starts, mu, threads=1)
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
    rows = friction_table(scene, known.contacts, starts, threads=1)
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
