"""Outcomes by pose: targets, others, plateaus, and what is never a success."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from icage.arrays import FloatArray
from icage.hand import Placement
from sim.closing.judge import OUTCOMES, judge, trial_records
from sim.closing.outcome import ClosingOutcomes
from sim.closing.step_check import ENDINGS
from tests.sim.grasps import KnownGrasp, t_shape

GRASP = t_shape()
SETTLED = ENDINGS.index("settled")


def closings(ends: list[FloatArray], endings: list[str] | None = None) -> ClosingOutcomes:
    count = len(ends)
    names = endings or ["settled"] * count
    zeros = np.zeros(count)
    return ClosingOutcomes(
        start=np.array(ends),
        end=np.array(ends),
        ending=np.array([ENDINGS.index(name) for name in names]),
        steps=np.full(count, 7),
        penetration_max=zeros.copy(),
        penetration_rest=zeros.copy(),
        shape_error_max=zeros.copy(),
        sigma_rise_max=zeros.copy(),
        finger_forces=np.zeros((count, 3)),
        contacts=np.full(count, 3),
    )


def turned_about_centroid(place: FloatArray, angle: float) -> FloatArray:
    """The hand turned about the object's centroid: a pure rotation of the object in the hand."""
    c = complex(*GRASP.outline.centroid)
    d = c + (complex(*place[:2]) - c) * np.exp(1j * angle)
    return np.array([d.real, d.imag, place[2] + angle, place[3]])


def names(found: ClosingOutcomes, grasps: list[KnownGrasp], friction: bool = False) -> list[str]:
    verdicts = judge(found, grasps, GRASP.outline, friction=friction)
    return [OUTCOMES[int(code)] for code in verdicts.outcome]


def test_target_within_its_tolerances_only() -> None:
    at, unit = GRASP.target.as_array(), GRASP.outline.diameter
    ends = [
        at,
        at + np.array([0.9e-4 * unit, 0, 0, 0]),
        at + np.array([1.1e-4 * unit, 0, 0, 0]),
        turned_about_centroid(at, 0.9e-3),
        turned_about_centroid(at, -1.1e-3),
        at + np.array([0, 0, 2 * np.pi, 0]),
    ]
    wanted = ["target", "target", "unmatched", "target", "unmatched", "target"]
    assert names(closings(ends), [GRASP]) == wanted
    verdicts = judge(closings(ends), [GRASP], GRASP.outline)
    np.testing.assert_allclose(verdicts.position_error[1:3], [0.9e-4, 1.1e-4], rtol=1e-9)
    np.testing.assert_allclose(verdicts.position_error[3:5], 0.0, atol=1e-12)
    np.testing.assert_allclose(verdicts.angle_error[3:5], [0.9e-3, 1.1e-3], rtol=1e-9)


def test_what_moves_at_rest_nowhere_is_jammed_only_with_friction() -> None:
    off = closings([turned_about_centroid(GRASP.target.as_array(), 0.1)])
    assert names(off, [GRASP]) == ["unmatched"]
    assert names(off, [GRASP], friction=True) == ["jammed"]


def test_endings_that_are_never_a_success_even_at_the_target() -> None:
    at = GRASP.target.as_array()
    kinds = ["pinched", "timed_out", "diverged", "settled"]
    found = names(closings([at] * 4, kinds), [GRASP])
    assert found == ["escaped", "timed_out", "diverged", "target"]


def test_diverged_rows_may_hold_anything() -> None:
    end = np.full(4, np.nan)
    verdicts = judge(closings([end], ["diverged"]), [GRASP], GRASP.outline)
    assert OUTCOMES[int(verdicts.outcome[0])] == "diverged"
    assert np.isnan(verdicts.position_error[0])


def test_nearest_of_several_grasps_wins_and_has_its_own_tolerance() -> None:
    place = turned_about_centroid(GRASP.target.as_array(), 0.5)
    other = replace(GRASP, contacts=GRASP.hand.fingers(place), id=4)
    ends = [turned_about_centroid(place, 0.9e-3), turned_about_centroid(place, 1.1e-3)]
    found = closings([*ends, GRASP.target.as_array()])
    verdicts = judge(found, [GRASP, other], GRASP.outline)
    assert [OUTCOMES[int(k)] for k in verdicts.outcome] == ["other_grasp", "unmatched", "target"]
    assert verdicts.grasp_id.tolist() == [4, -1, 0]
    assert verdicts.counts() == {
        **dict.fromkeys(OUTCOMES, 0), "target": 1, "other_grasp": 1, "unmatched": 1,
    }  # fmt: skip


def test_two_near_grasps_are_told_apart_by_distance_not_by_tolerance() -> None:
    place = turned_about_centroid(GRASP.target.as_array(), 4e-4)
    twin = replace(GRASP, contacts=GRASP.hand.fingers(place), id=2)
    ends = [turned_about_centroid(GRASP.target.as_array(), angle) for angle in (1e-4, 3e-4)]
    verdicts = judge(closings(ends), [GRASP, twin], GRASP.outline)
    assert verdicts.grasp_id.tolist() == [0, 2]


def test_plateau_is_matched_along_its_whole_length() -> None:
    at = GRASP.target.as_array()
    unit = GRASP.outline.diameter
    slide = np.array([0.2 * unit, 0.1 * unit, 0.0, 0.0])
    ends = GRASP.hand.fingers(at), GRASP.hand.fingers(at + slide)
    far = replace(GRASP, contacts=ends[0] + 10.0 * unit)
    plateau = replace(GRASP, contacts=ends[0], id=3, plateau=ends)
    middle = at + 0.6 * slide
    beside = middle + np.array([-slide[1], slide[0], 0.0, 0.0]) / np.hypot(*slide[:2]) * 2e-3 * unit
    beyond = at + 1.02 * slide
    verdicts = judge(closings([at, middle, beside, beyond]), [far, plateau], GRASP.outline)
    assert verdicts.grasp_id.tolist() == [3, 3, -1, -1]
    np.testing.assert_allclose(verdicts.grasp_position_error[:3], [0, 0, 2e-3], atol=1e-12)


def test_records_repeat_the_arrays() -> None:
    at = GRASP.target.as_array()
    found = closings([at, at], ["settled", "pinched"])
    rows = trial_records(found, judge(found, [GRASP], GRASP.outline))
    assert [row.outcome for row in rows] == ["target", "escaped"]
    assert [row.trial for row in rows] == [0, 1]
    assert rows[0].end == Placement(*at.tolist())
    assert rows[0].steps == 7


@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_judgement_does_not_depend_on_the_unit(scale: float) -> None:
    grasp = t_shape()
    outline = type(grasp.outline)(grasp.outline.vertices * scale)
    big = replace(grasp, outline=outline, contacts=grasp.contacts * scale)
    end = big.target.as_array() + np.array([0.5e-4 * outline.diameter, 0, 0, 0])
    verdicts = judge(closings([end]), [big], outline)
    assert verdicts.position_error[0] == pytest.approx(0.5e-4, rel=1e-6)
