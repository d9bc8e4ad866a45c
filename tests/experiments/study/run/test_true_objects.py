"""Objects and hands that differ from the planned ones: their targets are their own plan's."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from experiments.study.inputs.distributions import Distribution
from experiments.study.inputs.variants import boundary_noise
from experiments.study.run.rows import table_of
from experiments.study.run.shard import STUDY_OUTCOMES, Ran, Study, _judged, run_trials
from icage.arrays import FloatArray
from icage.cells.membership import TARGET, query
from icage.errors import IcageError
from icage.geometry.contact_types import supports
from icage.hand import HandShape, Placement
from icage.outline import Outline
from icage.planner import plan
from sim.closing.judge import grasp_errors
from sim.closing.outcome import ClosingOutcomes
from sim.closing.step_check import SETTLED
from tests.experiments.study.run.trials import case_of, middles, outcomes, planned, run, study


def test_an_object_and_fingers_of_another_size_are_the_same_case_scaled():
    scale = 1.02
    case, cage = case_of("L"), planned("L")
    vary = {"outline_scale": scale, "finger_radius": (scale - 1.0) * case.finger_radius}
    one = study("L", vary=vary)
    ran = run_trials(one, np.arange(8))
    # a start that is drawn for the smaller object may be inside the larger one
    assert set(outcomes(ran)) == {"target", "collision"}
    assert outcomes(ran).count("target") >= 6
    (variant,) = ran.variants
    centre = case.outline.centroid
    np.testing.assert_allclose(variant.outline.centroid, centre, atol=1e-14)
    assert variant.outline.diameter == pytest.approx(scale * case.outline.diameter)
    (target,) = one.variants.grasps(variant, cage.grasps[:1])
    scaled = centre + scale * (cage.grasps[0].contacts - centre)
    np.testing.assert_allclose(target.contacts, scaled, atol=1e-9)
    assert np.nanmax(ran.errors) <= 1e-5


@pytest.mark.parametrize("name", ["T", "L"])
def test_the_target_of_a_larger_object_is_that_of_its_own_plan(name: str):
    one = study(name, vary={"outline_scale": 1.02})
    ran = run_trials(one, np.arange(8))
    assert set(outcomes(ran)) <= {"target", "collision"}
    assert len(ran.done) >= 6
    (variant,) = ran.variants
    (target,) = one.variants.grasps(variant, one.cage.grasps[:1])
    again = plan(variant.outline, np.array(target.contacts), variant.finger_radius)
    np.testing.assert_allclose(again.grasps[0].contacts, target.contacts, atol=1e-9)
    position, angle = grasp_errors(ran.closings.closings.end, again.grasps[0], variant.outline)
    assert position.max() <= 1e-5
    assert angle.max() <= 1e-5
    np.testing.assert_allclose(position, ran.errors[ran.done, 0], atol=1e-9)
    table = table_of(one, ran).to_pydict()
    off = np.array([v for v in table["position_error"] if v is not None])
    np.testing.assert_allclose(off, position * variant.outline.diameter, atol=1e-9)


def noisy_plans(one: Study, ran: Ran) -> Iterator[tuple[Any, FloatArray]]:
    """(variant, contacts of the target by the planner) wherever all fingers still touch."""
    for variant in ran.variants:
        (target,) = one.variants.grasps(variant, one.cage.grasps[:1])
        try:
            again = plan(variant.outline, np.array(target.contacts), variant.finger_radius)
        except IcageError:
            continue
        np.testing.assert_allclose(again.grasps[0].contacts, target.contacts, atol=1e-8)
        yield variant, again.grasps[0].contacts


@pytest.mark.parametrize("name", ["T", "L"])
def test_the_target_of_a_noisy_object_is_that_of_its_own_plan(name: str):
    """The planner knows nothing of the edges that the study keeps to."""
    one = study(name, vary={"outline_noise": "1%"})
    ran = run_trials(one, np.arange(5))
    assert set(outcomes(ran)) <= {"target", "collision"}
    assert len(ran.variants) == 5
    moves = [
        np.abs(contacts - one.cage.grasps[0].contacts).max()
        for _, contacts in noisy_plans(one, ran)
    ]
    assert len(moves) >= 4
    assert min(moves) > 1e-3 * case_of(name).outline.diameter
    assert ran.errors[ran.done].max() <= 1e-4
    assert len(ran.done) >= 3


@pytest.mark.slow
@pytest.mark.parametrize(("name", "count"), [("L", 16), ("wrench", 4), ("pliers", 5)])
def test_targets_of_many_noisy_objects_are_those_of_their_plans(name: str, count: int):
    one = study(name, vary={"outline_noise": "0.5%"})
    ran = run_trials(one, np.arange(count))
    assert len(list(noisy_plans(one, ran))) >= 0.6 * count


def test_noise_has_the_size_that_was_asked_for_and_no_edge_of_its_own():
    outline = case_of("pliers").outline
    heights = []
    for seed in range(300):
        off = boundary_noise(outline.vertices, 0.7, np.random.default_rng(seed))
        assert off.shape == outline.vertices.shape
        heights.append(np.hypot(*off.T))
    assert np.sqrt(np.mean(np.square(heights))) == pytest.approx(0.7, rel=0.05)
    steps = np.linspace(0.0, 2.0 * np.pi, 500, endpoint=False)
    disc = np.column_stack([np.cos(steps), np.sin(steps)])
    out = (boundary_noise(disc, 0.1, np.random.default_rng(1)) * disc).sum(axis=1)
    assert np.abs(np.diff(out)).max() < 0.1 * 8 * (2.0 * np.pi / 500) * 4.0  # smooth


def test_a_noise_that_makes_the_outline_cross_itself_leaves_no_shape():
    one = study("pliers", vary={"outline_noise": "5%"})
    ran = run_trials(one, np.arange(16))
    none = np.array(outcomes(ran)) == "no_shape"
    assert 0 < none.sum() < 16
    assert not np.isin(np.flatnonzero(none), ran.done).any()
    for i in np.flatnonzero(none).tolist():
        rng = np.random.default_rng([0, 14, 2 * i])
        rms = 0.05 * one.case.outline.diameter
        vertices = one.case.outline.vertices
        with pytest.raises(IcageError):
            Outline(vertices + boundary_noise(vertices, rms, rng))
    table = table_of(one, ran).to_pydict()
    assert [v is None for v in table["end_x"]] == (~np.isin(np.arange(16), ran.done)).tolist()


def test_angles_of_the_hand_are_off_and_its_middle_is_not():
    cage = planned("T")
    one = study(vary={"phi_1": "1deg", "phi_2": "-0.5deg"})
    ran = run_trials(one, np.arange(6))
    (variant,) = ran.variants
    np.testing.assert_allclose(
        np.rad2deg(np.subtract(variant.hand.phi, cage.hand.phi)), [1.0, -0.5], atol=1e-10
    )
    true, meant = middles(variant.hand, ran.starts), middles(cage.hand, ran.meant)
    np.testing.assert_allclose(true, meant, atol=1e-13)
    assert ran.starts[:, 2:].tolist() == ran.meant[:, 2:].tolist()
    assert set(outcomes(ran)) == {"target"}
    (target,) = one.variants.grasps(variant, cage.grasps[:1])
    assert HandShape.from_contacts(target.contacts).phi == pytest.approx(variant.hand.phi)
    for name, error in (("phi_1", -3.0), ("phi_2", 1.05)):  # from far out in a normal's tail
        vary = {name: Distribution("fixed", (error,))}
        none = Study(replace(one.config, vary=vary), one.case, one.cage)
        assert outcomes(run_trials(none, np.arange(2))) == ["no_shape"] * 2


def test_a_hand_that_is_off_holds_its_target_loosely_and_all_that_room_is_the_target():
    """With another angle only one of two corners holds the L; it may slide along an edge."""
    one = study("L", vary={"phi_1": "-3deg"})
    ran = run_trials(one, np.arange(30))
    assert set(outcomes(ran)) == {"target", "collision"}
    assert ran.errors[ran.done].max() <= 1e-5
    (variant,) = ran.variants
    (target,) = one.variants.grasps(variant, one.cage.grasps[:1])
    size, ends = one.case.outline.diameter, ran.closings.closings.end
    room = np.abs(target.plateau[1] - target.plateau[0]).max() / size
    spread = np.hypot(*np.ptp(variant.hand.fingers(ends)[:, 0], axis=0)) / size
    assert 5e-3 < spread <= room * np.sqrt(2.0) + 1e-5


@pytest.mark.slow
def test_fingers_that_roll_on_to_another_edge_are_followed():
    """Thinner discs on the saw leave one of its edges for the next."""
    one = study("saw", vary={"finger_radius": "-0.5%"})
    ran = run_trials(one, np.arange(12))
    assert set(outcomes(ran)) == {"target"}
    assert ran.errors.max() <= 2e-5
    (variant,) = ran.variants
    (target,) = one.variants.grasps(variant, one.cage.grasps[:1])
    places = one.case.outline, np.array(target.contacts), variant.finger_radius
    np.testing.assert_allclose(plan(*places).grasps[0].contacts, target.contacts, atol=1e-6)
    was = supports(one.case.outline, one.cage.grasps[0].contacts, one.cage.finger_radius)
    now = supports(*places)
    assert set(now.edge.tolist()) - set(was.edge.tolist())


def test_fingers_of_another_radius_have_another_target():
    case = case_of("L")
    one = study("L", vary={"finger_radius": "grid:-1%,1%"})
    ran = run_trials(one, np.arange(6))
    assert set(outcomes(ran)) <= {"target", "collision"}
    assert ran.errors[ran.done].max() <= 1e-5
    for variant, sign in zip(ran.variants, (-1.0, 1.0), strict=True):
        radius = case.finger_radius + sign * 0.01 * case.outline.diameter
        assert variant.finger_radius == pytest.approx(radius)
        (target,) = one.variants.grasps(variant, one.cage.grasps[:1])
        again = plan(case.outline, np.array(target.contacts), radius)
        assert sign * (again.sigma_0 - one.cage.sigma_0) > 0.0


def test_a_yielding_linkage_gives_way_in_proportion():
    """By about half of the play on the L.

    [docs/physics.md, Speed, time step, inertia, compliance]
    """
    ran = run(4, "L", vary={"linkage_play": "grid:0.1%,0.2%"})
    assert set(outcomes(ran)) == {"target"}
    off = ran.errors[:, 0]
    np.testing.assert_allclose(off[:2], [0.46e-3, 0.92e-3], rtol=0.05)
    np.testing.assert_allclose(off[2:], off[:2], rtol=1e-3)


def test_a_grasp_of_the_plan_is_found_on_a_variant_whoever_else_is_there():
    """An end is compared with the grasps nearest to it, not to its shard."""
    one = study("wrench", vary={"outline_scale": 1.002})
    ran = run_trials(one, np.arange(4))
    (variant,) = ran.variants
    grasps = one.cage.grasps
    assert len(grasps) == 4
    places = one.variants.grasps(variant, grasps)
    ends = np.array([Placement.from_contacts(g.contacts).as_array() for g in places])
    astray = ends[0] + [0.1 * one.case.outline.diameter, 0.0, 1.0, 0.0]
    ends = np.vstack([ends, astray])
    count = len(ends)
    none, whole = np.zeros(count), np.zeros(count, dtype=np.int64)
    closings = ClosingOutcomes(
        ends.copy(), ends, np.full(count, SETTLED), whole, none, none.copy(), none.copy(),
        none.copy(), np.zeros((count, 3)), whole.copy(),
    )  # fmt: skip
    outcome, grasp_id, errors = _judged(one, variant, closings)
    assert [STUDY_OUTCOMES[k] for k in outcome] == ["target"] + ["other_grasp"] * 3 + ["unmatched"]
    assert grasp_id.tolist() == [*(g.id for g in grasps), -1]
    for k in range(count):
        alone = _judged(one, variant, closings.picked(np.array([k])))
        assert (alone[0][0], alone[1][0]) == (outcome[k], grasp_id[k])
        assert alone[2].tobytes() == errors[k : k + 1].tobytes()


def test_an_end_that_no_plan_has_is_a_grasp_of_the_true_object():
    """As number 218 of ``docs/studies/radius-saw``: fingers 1.7 mm thinner than planned.

    The plan of the fingers as drawn promised the target; that of the true ones does not (this wide
    the object may even escape), and has the grasp that the closing ended in.
    """
    one = study("saw", vary={"finger_radius": "-0.5%:0.5%"})
    numbers = np.arange(1, 311)
    many = run_trials(one, numbers)
    thinner = one.case.finger_radius - 1.5
    found = [
        int(number)
        for number, outcome, which in zip(numbers, outcomes(many), many.which, strict=True)
        if outcome == "unmatched" and many.variants[which].finger_radius < thinner
    ]
    assert found
    for number in found:
        ran = run_trials(one, np.array([number]))
        assert outcomes(ran) == ["unmatched"]
        assert ran.answers.verdict.tolist() == [TARGET]
        (variant,) = ran.variants
        (target,) = one.variants.grasps(variant, one.cage.grasps[:1])
        true = plan(variant.outline, target.contacts, variant.finger_radius)
        said = query(true, ran.starts)
        assert TARGET not in said.verdict
        near = [
            np.max(grasp_errors(ran.closings.closings.end, g, variant.outline)) for g in true.grasps
        ]
        assert min(near) < 1e-4
        ended = true.grasps[int(np.argmin(near))]
        assert not ended.target
        assert ended.sigma < ran.starts[0, 3]
