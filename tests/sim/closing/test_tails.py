"""Rest foreseen from an exponential tail: what may be called rest, and what only looks like it."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest

from icage.arrays import FloatArray
from icage.hand import HandShape
from icage.outline import Outline
from sim.closing.batch import close_many
from sim.closing.judge import judge
from sim.closing.outcome import ClosingOutcomes
from sim.closing.step_check import RUNNING, SETTLED, StepCheck
from sim.world.config import SimConfig
from tests.sim.grasps import KnownGrasp, l_shape, starts_near, triangle

STEP = SimConfig().time_step


def told_after(speeds: FloatArray, dof: int = 5) -> int | None:
    """Steps until a hand at its target, whose object moves with these speeds, is called at rest."""
    grasp = triangle()
    scene = grasp.scene()
    qpos = scene.start_positions(grasp.target.as_array())
    check = StepCheck.over(scene, qpos)
    for number, speed in enumerate(speeds.tolist(), start=1):
        qvel = np.zeros((1, 6))
        qvel[0, dof] = speed
        check.observe(np.array([0]), qpos, qvel)
        if check.ending[0] != RUNNING:
            assert check.ending[0] == SETTLED
            return number
    return None


def falling(constant: float, first: float, steps: int = 4000) -> FloatArray:
    return first * np.exp(-np.arange(steps) * STEP / constant)


@pytest.mark.parametrize("constant", [0.03, 0.05, 0.2])
@pytest.mark.parametrize("dof", [3, 5])
def test_an_exponential_tail_is_rest_when_little_is_left(constant: float, dof: int) -> None:
    speeds = falling(constant, 0.02)
    told = told_after(speeds, dof)
    config = SimConfig()
    bound = config.remains
    assert told is not None
    left = speeds[told - 1] * constant
    assert left <= bound
    assert speeds[told - 1] > config.still_speed  # waiting would have taken longer
    sooner = speeds[told - 4] * constant > bound or speeds[told - 4] >= 1e-3
    assert sooner  # and it was told at once


def test_a_contacts_own_tail_is_waited_for() -> None:
    speeds = falling(0.0042, 0.02)
    told = told_after(speeds)
    assert told is not None
    assert speeds[told - 1] < SimConfig().still_speed


@pytest.mark.parametrize(
    "speeds",
    [
        np.full(3000, 4e-5),  # creeps for ever
        np.linspace(9e-4, 2e-5, 3000),  # slows down, but not to an end
        1e-4 / (1.0 + np.arange(3000) * STEP),  # a power of the time
        falling(0.05, 9e-4) + 5e-5,  # creeps on under a tail
        9e-4 * np.exp(-np.arange(300) * STEP / 0.05) + 1e-5 * np.exp(np.arange(300) * STEP / 0.05),
        np.abs(9e-4 * np.cos(np.arange(3000) * STEP * 3.0)) + 2e-5,  # swings
        1e-4 * (1.2 + np.cos(np.arange(3000) * STEP * 30.0)),
    ],
    ids=["creep", "slowing", "power", "under", "unstable", "swing", "pulse"],
)
def test_what_goes_on_is_not_rest(speeds: FloatArray) -> None:
    assert told_after(speeds) is None


def test_a_slower_tail_under_a_faster_is_seen() -> None:
    """What is left of both, when rest is told, is within twice what is allowed."""
    for share in (0.5, 0.1, 0.03, 0.01):
        fast, slow = falling(0.03, 9e-4), falling(0.5, share * 9e-4)
        told = told_after(fast + slow)
        assert told is not None
        left = fast[told - 1] * 0.03 + slow[told - 1] * 0.5
        assert left <= 2.0 * SimConfig().remains


def test_a_tail_needs_all_fingers_and_no_friction() -> None:
    grasp = triangle()
    speeds = falling(0.05, 9e-4, 220)  # not below still_speed yet
    for friction, off, ending in ((0.0, 0.0, SETTLED), (0.0, 1e-4, RUNNING), (0.1, 0.0, RUNNING)):
        scene = grasp.scene(SimConfig(friction=friction))
        qpos = scene.start_positions(grasp.target.as_array())
        qpos[:, 3] += off  # one finger or two let go
        check = StepCheck.over(scene, qpos)
        for speed in speeds.tolist():
            check.observe(np.array([0]), qpos, np.full((1, 6), speed))
        assert check.ending[0] == ending


def test_with_friction_nothing_changes() -> None:
    """Jams creep: their tails are no way to an end."""
    grasp = triangle()
    starts = starts_near(grasp, 10, seed=41, turn=0.3, opening=1.1)
    for mu in (0.02, 0.2):
        foreseen, waited = (
            close_many(grasp.scene(SimConfig(friction=mu, max_time=1.0, remains=r)), starts)
            for r in (5e-6, 0.0)
        )
        for part in fields(ClosingOutcomes):
            assert getattr(foreseen, part.name).tobytes() == getattr(waited, part.name).tobytes()


@pytest.mark.parametrize("grasp", [triangle(), l_shape()], ids=["triangle", "L"])
def test_ends_are_those_of_waiting(grasp: KnownGrasp) -> None:
    starts = starts_near(grasp, 40, seed=42, turn=0.3, opening=1.3)
    foreseen, waited = (close_many(grasp.scene(SimConfig(remains=r)), starts) for r in (5e-6, 0.0))
    verdicts = [judge(one, [grasp], grasp.outline) for one in (foreseen, waited)]
    assert verdicts[0].outcome.tolist() == verdicts[1].outcome.tolist()
    off = np.abs(foreseen.end - waited.end) / [*[grasp.outline.diameter] * 2, 1.0, 1.0]
    assert off[:, [0, 1]].max() <= 2e-5
    assert off[:, 2].max() <= 1e-5
    assert foreseen.penetration_max.tolist() == waited.penetration_max.tolist()
    assert foreseen.penetration_rest.max() <= 1.2 * waited.penetration_rest.max()
    assert (foreseen.steps <= waited.steps).all()
    if len(grasp.outline.vertices) == 3:
        assert foreseen.steps.mean() < 0.9 * waited.steps.mean()


@pytest.mark.parametrize("off", [1e-2, 1e-3, 1e-4, 3e-5])
def test_an_unstable_balance_is_passed(off: float) -> None:
    """Three discs on the three corners: the body hesitates, then turns until its edges lie."""
    outline = Outline([[np.cos(a), np.sin(a)] for a in np.deg2rad([90, 210, 330])])
    radius = 0.03 * outline.diameter
    corners = np.array([[np.cos(a), np.sin(a)] for a in np.deg2rad([90, 210, 330])])
    balance = KnownGrasp(outline, radius, corners * (1.0 + radius))
    assert isinstance(balance.hand, HandShape)
    place = balance.target.as_array()
    middle = balance.hand.z.mean()
    turned, wider = place[2] + off, place[3] * 1.02
    d = -wider * np.exp(1j * turned) * middle
    start = np.array([[d.real, d.imag, turned, wider]])
    ends = [
        close_many(balance.scene(SimConfig(remains=r, computed_contacts=most)), start)
        for r, most in ((5e-6, 3), (5e-6, 0), (0.0, 0))
    ]
    for one in ends:
        assert one.ending[0] == SETTLED
        assert one.end[0, 3] < 0.7 * place[3]  # far below the balance
        np.testing.assert_allclose(one.end, ends[-1].end, atol=1e-4)
