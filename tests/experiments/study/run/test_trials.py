"""Trials of a study, one by one: where the hand stands, what the object is, what it is called."""

from __future__ import annotations

import functools
import json
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from experiments.study.inputs.config import study_config
from experiments.study.inputs.distributions import Distribution
from experiments.study.inputs.placements import BLOCK, Intended, moved
from experiments.study.inputs.variables import VARIABLES
from experiments.study.inputs.variants import boundary_noise
from experiments.study.run.document import study_document, study_of
from experiments.study.run.rows import table_of
from experiments.study.run.shard import (
    STUDY_OUTCOMES,
    Ran,
    Study,
    _judged,
    run_trials,
)
from experiments.study.run.worlds import worlds_of
from icage.arrays import FloatArray
from icage.cage import Cage
from icage.case import Case
from icage.cells.membership import TARGET, query
from icage.errors import IcageError
from icage.formats.case_json import read_case
from icage.geometry.contact_types import supports
from icage.hand import HandShape, Placement
from icage.outline import Outline
from icage.planner import plan
from models import case_paths
from sim.closing.judge import grasp_errors
from sim.closing.outcome import ClosingOutcomes
from sim.closing.step_check import SETTLED
from tests.experiments.small import cage_of, t_case
from tests.sim.grasps import l_shape

DRIVE, DAMPING = 900.0, 300.0
"""Of ``SimConfig``: the closing force and the object's damping."""


@functools.cache
def case_of(name: str) -> Case:
    if name == "T":
        return t_case()
    if name == "L":
        grasp = l_shape()
        return Case("L", "mm", grasp.outline, grasp.radius, grasp.contacts)
    return read_case(case_paths(name)[0])


@functools.cache
def planned(name: str) -> Cage:
    case = case_of(name)
    return cage_of("T") if name == "T" else plan(case.outline, case.contacts, case.finger_radius)


def study(name: str = "T", **table: Any) -> Study:
    case = case_of(name)
    return Study(study_config({"case": name, **table}, case), case, planned(name))


def run(count: int = 4, name: str = "T", **table: Any) -> Ran:
    return run_trials(study(name, **table), np.arange(count))


def outcomes(ran: Ran) -> list[str]:
    return [STUDY_OUTCOMES[int(code)] for code in ran.outcome]


def held(name: str = "T", opening: float = 1.0) -> list[float]:
    """The target's placement, opened about the middle of its fingers."""
    cage = planned(name)
    x, y, theta, sigma = cage.target_placement.as_array().tolist()
    wider = (opening - 1.0) * sigma * np.exp(1j * theta) * cage.hand.z.mean()
    return [x - wider.real, y - wider.imag, theta, opening * sigma]


def middles(hand: HandShape, placements: FloatArray) -> FloatArray:
    """Mean of the fingers, (n, 2)."""
    return hand.fingers(placements).mean(axis=-2)


def errors_at(rows: FloatArray, **errors: Any) -> tuple[FloatArray, FloatArray]:
    """Fingers (n, 3, 2) of intended placements, and of the ones with these errors."""
    cage = planned("T")
    values = {name: np.full(len(rows), one.nominal) for name, one in VARIABLES.items()}
    values |= {name: np.broadcast_to(value, len(rows)) for name, value in errors.items()}
    true = moved(rows, values, cage, np.full(len(rows), complex(cage.hand.z.mean())))
    return cage.hand.fingers(rows), cage.hand.fingers(true)


@pytest.fixture
def rows() -> FloatArray:
    return np.random.default_rng(1).uniform([-3, -3, -4, 0.2], [3, 3, 4, 3], (20, 4))


# ---------------------------------------------------------------------------- placements


def test_frictionless_guaranteed_starts_all_reach_the_target():
    for name in ("T", "L"):
        ran = run(30, name)
        assert outcomes(ran) == ["target"] * 30
        assert ran.errors[:, 0].max() <= 1e-4
        assert ran.errors[:, 1].max() <= 1e-3
        assert (ran.answers.verdict == TARGET).all()
        np.testing.assert_allclose(ran.starts, ran.meant, atol=1e-14)
        assert (ran.grasp_id == planned(name).grasps[0].id).all()


def test_no_error_moves_nothing(rows: FloatArray):
    meant, true = errors_at(rows)
    np.testing.assert_allclose(true, meant, atol=1e-14)


def test_place_noise_moves_the_middle(rows: FloatArray):
    x, y = np.random.default_rng(2).normal(0.0, 0.3, (2, len(rows)))
    meant, true = errors_at(rows, place_x=x, place_y=y)
    np.testing.assert_allclose(true - meant, np.column_stack([x, y])[:, None] + np.zeros((3, 1)),
                               atol=1e-13)  # fmt: skip


def test_place_noise_turns_about_the_middle_and_opens_about_it(rows: FloatArray):
    rng = np.random.default_rng(3)
    turn, wider = rng.normal(0.0, 0.4, len(rows)), rng.uniform(0.0, 0.5, len(rows))
    meant, true = errors_at(rows, place_theta=turn, place_sigma=wider)
    about = meant.mean(axis=1, keepdims=True)
    np.testing.assert_allclose(true.mean(axis=1, keepdims=True), about, atol=1e-13)
    arms = (meant - about) @ np.array([1.0, 1j])
    seen = (true - about) @ np.array([1.0, 1j])
    expected = arms * (np.exp(1j * turn) * (1.0 + wider / rows[:, 3]))[:, None]
    np.testing.assert_allclose(seen, expected, atol=1e-13)


def test_the_hand_is_right_for_the_object_as_it_was_seen(rows: FloatArray):
    """The true object, moved by the bias (turned about its centroid, then shifted), is the object
    that was seen; from there the hand stands where it was meant to.
    """
    rng = np.random.default_rng(4)
    x, y, turn = rng.normal(0.0, 0.3, (3, len(rows)))
    meant, true = errors_at(rows, bias_x=x, bias_y=y, bias_theta=turn)
    centre = case_of("T").outline.centroid
    for i in range(len(rows)):
        cos, sin = np.cos(turn[i]), np.sin(turn[i])
        rotation = np.array([[cos, -sin], [sin, cos]])
        back = (true[i] - centre - [x[i], y[i]]) @ rotation + centre  # in the seen object's axes
        np.testing.assert_allclose(back, meant[i], atol=1e-13)


def test_intended_placements_hang_on_their_number_only():
    for starts in ("guaranteed", "cage"):
        one = study(starts=starts)
        numbers = np.arange(BLOCK - 3, BLOCK + 3)
        streams = np.array([0, 1, 0, 1, 0, 1])
        whole = one.intended.placements(numbers, streams)
        again = Intended(one.config, one.cage)
        back = [again.placements(numbers[k : k + 1], streams[k : k + 1]) for k in range(6)[::-1]]
        assert np.concatenate(back[::-1]).tobytes() == whole.tobytes()
        assert len(np.unique(whole[:, 0])) == 6
        assert query(one.cage, whole).in_cage.all()


def test_the_nominal_placement_has_room():
    one = study(vary={"place_xy": "normal:1%"})
    (nominal,) = one.intended.placements(np.array([3]), np.array([0]))
    answers = query(one.cage, nominal[None, :])
    assert answers.verdict[0] == TARGET
    assert answers.target_margin[0] > 0.2 * (one.cage.sigma_first - one.cage.sigma_0)
    assert nominal.tobytes() == study(vary={"place_x": 0.0}).intended.nominal.tobytes()


# ---------------------------------------------------------------------------- no closing at all


def test_a_start_in_collision_is_recorded_where_it_is():
    deep = held(opening=0.7)
    ran = run(3, nominal=deep)
    assert outcomes(ran) == ["collision"] * 3
    np.testing.assert_allclose(ran.starts, np.tile(deep, (3, 1)), atol=1e-14)
    assert len(ran.done) == 0
    table = table_of(study(nominal=deep), ran).to_pydict()
    assert table["verdict"] == ["collision"] * 3
    assert table["start_sigma"] == pytest.approx([deep[3]] * 3)
    empty = ("end_x", "peak_force", "penetration_max", "steps", "position_error", "angle_error")
    for name in empty:
        assert table[name] == [None] * 3
    assert table["grasp_id"] == [-1] * 3
    skipped = run(3, nominal=deep, uncaged="skip")
    assert outcomes(skipped) == ["collision"] * 3


def test_a_hand_smaller_than_shut_is_in_collision():
    ran = run(2, vary={"place_sigma": -9.0})
    assert outcomes(ran) == ["collision"] * 2
    assert (ran.starts[:, 3] < 0.0).all()


def test_some_starts_collide_and_the_others_are_closed():
    """Noise takes some fingers into the object: those are named, none is drawn again."""
    ran = run(40, vary={"place_xy": "normal:8%"})
    hit = np.array(outcomes(ran)) == "collision"
    assert 4 < hit.sum() < 36
    assert ran.done.tolist() == np.flatnonzero(~hit).tolist()
    assert (np.array(outcomes(ran))[~hit] != "collision").all()
    off = middles(planned("T").hand, ran.starts) - middles(planned("T").hand, ran.meant)
    drawn = np.column_stack([ran.values["place_x"], ran.values["place_y"]])
    np.testing.assert_allclose(off, drawn, atol=1e-12)


def test_uncaged_starts_are_closed_or_skipped_as_asked():
    wide = held(opening=2.2)
    assert wide[3] > planned("T").sigma_max
    for uncaged, closed in (("close", 3), ("skip", 0)):
        ran = run(3, nominal=wide, uncaged=uncaged)
        assert not ran.answers.in_cage.any()
        assert len(ran.done) == closed
        assert set(outcomes(ran)) == ({"not_caged"} if uncaged == "skip" else {"target"})


def test_a_hand_far_away_has_let_the_object_escape():
    far = [40.0, 0.0, 0.2, 2.0]
    assert outcomes(run(2, nominal=far)) == ["escaped"] * 2


# ---------------------------------------------------------------------------- true objects


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
    ran = run_trials(one, np.array([53]))
    assert outcomes(ran) == ["unmatched"]
    assert ran.answers.verdict.tolist() == [TARGET]
    (variant,) = ran.variants
    assert variant.finger_radius < one.case.finger_radius - 1.5
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


# ---------------------------------------------------------------------------- worlds


def test_downhill_is_told_in_the_objects_axes():
    """A hand wide open and slow: seen from the object, the hand drifts uphill."""
    start = held(opening=6.0)
    directions = (0.0, 70.0, 200.0)
    vary = {
        "tilt": "30deg", "weight": "10%", "speed": 0.02, "mass": "grid:1,2",
        "tilt_direction": "grid:" + ",".join(f"{a}deg" for a in directions),
        "place_theta": 0.5,
    }  # fmt: skip
    time = 0.1
    one = study(nominal=start, vary=vary, max_time=0.02 * time)  # slower hands have longer
    ran = run_trials(one, np.arange(6))
    assert set(outcomes(ran)) == {"timed_out"}
    before = middles(one.cage.hand, ran.starts)
    drift = middles(one.cage.hand, ran.closings.closings.end) - before
    speed = 0.1 * np.sin(np.pi / 6.0) * DRIVE / DAMPING * one.case.outline.diameter
    angle = ran.values["tilt_direction"]
    mass = ran.values["mass"]
    late = time - mass / DAMPING  # it takes this long to get going
    expected = -late * speed * mass * np.array([np.cos(angle), np.sin(angle)])
    np.testing.assert_allclose(drift, expected.T, rtol=0.01, atol=1e-3 * np.abs(expected).max())


def test_what_friction_holds_is_jammed_and_never_unmatched():
    """High friction on the L: it stops where no frictionless object could."""
    ran = run(40, "L", vary={"friction": "grid:0,0.9"}, max_time=3.0)
    words = np.array(outcomes(ran))
    rough = ran.values["friction"] > 0.0
    assert set(words[~rough]) == {"target"}
    assert "jammed" in words[rough]
    assert "unmatched" not in words
    assert (ran.grasp_id[words == "jammed"] == -1).all()
    stuck = run(4, vary={"table_friction": 1.0})
    assert set(outcomes(stuck)) == {"jammed"}


# ---------------------------------------------------------------------------- rows

MUCH = {
    "place_xy": "normal:2%", "place_theta": "normal:3deg", "bias_theta": "normal:2deg",
    "friction": "truncated:0.1:0.2:0:0.6", "softness": "1:5", "table_friction": "0:0.1",
    "tilt": "0:10deg", "mass": "0.5:2", "inertia": "0.5:2", "com_x": "normal:2%",
    "speed": "0.5:2", "force": "0.5:2",
}  # fmt: skip
SHAPES = {
    "outline_scale": "truncated:1:0.01:0.9:1.1",
    "outline_noise": "0:1%",
    "finger_radius": "-0.5%:0.5%",
    "phi_1": "normal:1deg",
    "linkage_play": "grid:0,0.1%",
}


@pytest.mark.parametrize(
    ("vary", "sampling", "count"),
    [
        (MUCH, "random", 25),
        ({**MUCH, **SHAPES}, "sobol", 14),
        ({"outline_scale": "grid:1,1.01", "friction": "0:0.8"}, "random", 14),
        ({"outline_noise": "1%", "friction": "0:0.4"}, "saltelli", 15),
    ],
    ids=["worlds", "shapes", "one other shape", "saltelli"],
)
def test_a_row_is_the_same_alone_and_in_company(vary: dict[str, str], sampling: str, count: int):
    one = study(vary=vary, sampling=sampling, starts="cage", max_time=1.5)
    whole = table_of(one, run_trials(one, np.arange(count)))
    assert whole.num_rows == count
    assert len(set(whole["outcome"].to_pylist())) > 1
    for first, last in ((0, 1), (7, 8), (count - 1, count), (3, 9)):
        fresh = Study(one.config, one.case, one.cage)
        part = table_of(fresh, run_trials(fresh, np.arange(first, last)))
        assert part.schema == whole.schema
        assert part.equals(whole.slice(first, last - first)), (first, last)


def test_a_row_of_the_table_holds_the_trial():
    one = study(vary={"friction": "0:0.5", "place_x": "normal:1%"}, seed=9)
    ran = run_trials(one, np.arange(5, 12))
    table = table_of(one, ran)
    rows = table.to_pydict()
    assert rows["trial"] == list(range(5, 12))
    assert set(rows["seed"]) == {9}
    assert rows["friction"] == ran.values["friction"].tolist()
    assert "mass" not in rows  # it did not vary
    closings = ran.closings.closings
    assert rows["steps"] == closings.steps.tolist()
    assert rows["end_theta"] == closings.end[:, 2].tolist()
    assert rows["outcome"] == outcomes(ran)
    size = one.case.outline.diameter
    assert rows["penetration_max"] == pytest.approx((closings.penetration_max * size).tolist())
    assert rows["position_error"] == pytest.approx((ran.errors[:, 0] * size).tolist())


def test_a_study_read_from_its_document_runs_the_same_trials():
    one = study(vary={**MUCH, **SHAPES}, seed=3, max_time=1.0)
    again = study_of(json.loads(json.dumps(study_document(one))))
    assert again.config == one.config
    rows = [table_of(s, run_trials(s, np.arange(4))) for s in (one, again)]
    assert rows[0].equals(rows[1])


def test_the_centre_of_mass_is_off_by_a_length_of_the_true_object():
    """Twice as large, an offset of the same length is half as many diameters."""
    values = {name: np.full(2, one.nominal) for name, one in VARIABLES.items()}
    values["com_x"][:] = 0.3
    worlds = worlds_of(values, np.zeros((2, 4)), np.array([2.0, 4.0]))
    assert worlds.com_x.tolist() == [0.15, 0.075]
