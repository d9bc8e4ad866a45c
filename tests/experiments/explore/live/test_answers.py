"""What the live page is told: the planner's and the simulation's own answers."""

from __future__ import annotations

import json
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

import icage
from experiments.explore.live.answers import MOST_PROPOSALS, MOST_SECONDS, track_of
from experiments.explore.live.server import LiveServer
from icage.case import Case
from icage.errors import InputError
from icage.formats.json_out import json_text
from icage.formats.load import load
from icage.outline import Outline
from icage.sampling import draw_starts
from tests.experiments.explore.live.asking import ask, of_case, served
from tests.experiments.explore.placements import cage_of

CASE = load("pliers")

T = [[0, 0], [3, 0], [3, 1], [2, 1], [2, 3], [1, 3], [1, 1], [0, 1]]


def refusal(server: LiveServer, path: str, question: Any) -> str:
    answer = ask(server, path, question)
    assert list(answer) == ["error"], answer
    assert "internal" not in answer["error"], answer
    return answer["error"]


def test_contacts_that_hold_are_told_so(pliers: LiveServer) -> None:
    found = ask(pliers, "/api/standing", of_case(CASE))
    assert found["holds"]
    assert found["why"] is None
    assert found["grasp"]["contacts"] == pytest.approx(np.array(CASE.contacts), abs=1e-9)


def test_contacts_pulled_off_are_told_why_and_where_the_grasp_is(pliers: LiveServer) -> None:
    track = shapely.LinearRing(track_of(CASE.outline, CASE.finger_radius))
    contacts = CASE.contacts.copy()
    at = track.project(shapely.Point(contacts[1]))
    contacts[1] = track.interpolate(at + 0.01 * CASE.outline.diameter).coords[0]
    found = ask(pliers, "/api/standing", {"radius": 6.0, "contacts": contacts.tolist()})
    assert not found["holds"]
    assert found["why"].startswith("no equilibrium")
    grasp = np.array(found["grasp"]["contacts"])
    assert 0.0 < found["grasp"]["moved"] < 0.02 * CASE.outline.diameter
    assert icage.plan(CASE.with_grasp(grasp)).status == "cage"


def test_levels_are_those_of_the_plan(pliers: LiveServer) -> None:
    found, cage = ask(pliers, "/api/levels", of_case(CASE)), cage_of("pliers")
    for key in ("sigma_0", "sigma_first", "sigma_max"):
        assert found[key] == getattr(cage, key)
    assert found["verdict"] == "cage"


def test_the_document_is_that_of_the_page_in_a_file(pliers: LiveServer) -> None:
    from experiments.explore.document import explore_document
    from icage.cells.query_tables import query_tables
    from icage.friction.jam import JamTolerance

    cage, tolerance = cage_of("pliers"), JamTolerance()
    friction = icage.friction_levels(cage, [0.0, 0.2], tolerance)
    wanted = explore_document(cage, query_tables(cage), CASE.name, CASE.unit, friction, tolerance)
    found = ask(pliers, "/api/document", of_case(CASE))
    assert found == json.loads(json_text(wanted))


def test_closing_from_the_guaranteed_set_ends_in_the_target(pliers: LiveServer) -> None:
    cage = cage_of("pliers")
    starts = draw_starts(cage, "guaranteed", 3, np.random.default_rng(5)).placements
    for start in starts.tolist():
        found = ask(pliers, "/api/close", of_case(CASE, placement=start))
        assert found["outcome"] == "target"
        assert found["position_error"] < 1e-4 * cage.outline.diameter
        assert found["angle_error_deg"] < 0.06
        assert 0.0 < found["penetration_max"] < 1e-3 * cage.outline.diameter
        assert found["placements"][0] == pytest.approx(start, abs=1e-9)
        sizes = np.array(found["placements"])[:, 3]
        assert sizes.max() == sizes[0]
        assert found["end"] == pytest.approx(cage.target_placement.as_array().tolist(), abs=1e-2)
        assert (found["friction"], found["time_step"]) == (0.0, 1e-3)
        assert found["engine"].startswith("MuJoCo ")
        assert len(found["time"]) == len(found["placements"]) <= 400


def test_closing_from_outside_the_cage_may_end_elsewhere(pliers: LiveServer) -> None:
    free = [400.0, 400.0, 0.0, 50.0]
    found = ask(pliers, "/api/close", of_case(CASE, placement=free))
    assert found["outcome"] == "escaped"
    assert found["placements"][-1][3] < 0.1


def test_what_cannot_be_closed_is_said(pliers: LiveServer) -> None:
    inside = [90.0, 60.0, 0.0, 50.0]
    assert "inside the object" in refusal(pliers, "/api/close", of_case(CASE, placement=inside))
    far = [1e9, 0.0, 0.0, 50.0]
    assert "diameters from" in refusal(pliers, "/api/close", of_case(CASE, placement=far))
    for wrong in ([1, 2, 3], "x", None, [1, 2, 3, "4"], [1, 2, 3, -4]):
        refusal(pliers, "/api/close", of_case(CASE, placement=wrong))
    question = of_case(CASE, placement=inside, friction=-1)
    assert "friction" in refusal(pliers, "/api/close", question)


def test_points_are_not_closed(pliers: LiveServer) -> None:
    question = {**of_case(CASE), "radius": 0, "placement": [0.0, 0.0, 0.0, 50.0]}
    assert "need a radius" in refusal(pliers, "/api/close", question)


def test_other_fingers_keep_the_grasp(pliers: LiveServer) -> None:
    found = ask(pliers, "/api/fingers", of_case(CASE, to=5.0))
    assert found["track"] == track_of(CASE.outline, 5.0).tolist()
    thinner = replace(CASE, finger_radius=5.0, target=np.array(found["contacts"]))
    assert icage.plan(thinner).status == "cage"
    found = ask(pliers, "/api/fingers", of_case(CASE, to=60.0))
    assert found["contacts"] is None
    assert "no grasp of the same kind" in found["why"]
    bare = ask(pliers, "/api/fingers", {"to": 2.0, "contacts": None})
    assert (bare["contacts"], bare["why"]) == (None, None)
    for wrong in (-1, "x", None, 1e9):
        refusal(pliers, "/api/fingers", {"to": wrong, "contacts": None})


@pytest.mark.parametrize(
    ("question", "why"),
    [
        ({}, "no key 'radius'"),
        ({"radius": 6}, "no key 'contacts'"),
        ({"radius": -1, "contacts": []}, "radius is -1"),
        ({"radius": "6", "contacts": []}, "a number is needed"),
        ({"radius": True, "contacts": []}, "a number is needed"),
        ({"radius": 6, "contacts": [[0, 0]]}, "1 points"),
        ({"radius": 6, "contacts": [[0, 0]] * 17}, "17 points"),
        ({"radius": 6, "contacts": [[0, 0], [1, 1]]}, "shape (2, 2)"),
        ({"radius": 6, "contacts": [[0, 0]] * 4}, "shape (4, 2)"),
        ({"radius": 6, "contacts": [[0, 0], [1, 1], [2]]}, "a pair of numbers"),
        ({"radius": 6, "contacts": [[0, 0], [20, 20], [40, 40]]}, "line"),
        ({"radius": 6, "contacts": [[500, 0], [600, 0], [550, 90]]}, "away"),
        ({"radius": 6, "contacts": CASE.contacts[::-1].tolist()}, "clockwise"),
        ({"radius": 1e9, "contacts": CASE.contacts.tolist()}, "allowed"),
    ],
)
def test_no_hand_is_one_line(question: Any, why: str, pliers: LiveServer) -> None:
    for path in ("/api/standing", "/api/levels"):
        assert why in refusal(pliers, path, question)


@pytest.mark.slow
def test_a_search_proposes_cages_best_first() -> None:
    case = Case("T", "mm", Outline(T), 0.05)
    with served(case) as server:
        found = ask(server, "/api/propose", {"radius": 0.05, "seconds": 2, "top": 4})
        scores = [grasp["score"] for grasp in found["grasps"]]
        assert 1 <= len(scores) <= 4
        assert scores == sorted(scores, reverse=True)
        best = found["grasps"][0]
        cage = icage.plan(case, np.array(best["contacts"]))
        assert cage.sigma_first == pytest.approx(best["sigma_first"], rel=1e-9)
        assert best["score"] == pytest.approx(best["sigma_first"] / best["sigma_0"])
        for question, why in (
            ({"radius": 0.05, "seconds": 0}, "seconds"),
            ({"radius": 0.05, "seconds": MOST_SECONDS + 1}, "seconds"),
            ({"radius": 0.05, "seconds": 1, "top": MOST_PROPOSALS + 1}, "top"),
            ({"radius": 0.05, "seconds": 1, "top": 0}, "top"),
            ({"radius": 4.5, "seconds": 1}, "diameter"),
        ):
            assert why in refusal(server, "/api/propose", question)


@pytest.mark.slow
def test_a_search_that_is_stopped_gives_what_it_has() -> None:
    with served(CASE) as server, ThreadPoolExecutor(1) as thread:
        question = {"radius": 6, "seconds": 120, "top": 2}
        waiting = thread.submit(ask, server, "/api/propose", question)
        time.sleep(2.0)
        assert ask(server, "/api/stop", {}) == {}
        found = waiting.result(100.0)
        assert found["ended"] == "interrupted"
        assert 1 <= len(found["grasps"]) <= 2


def test_the_case_that_is_saved_is_the_case(tmp_path: Path) -> None:
    path = tmp_path / "kept.json"
    with served(CASE, save=path) as server:
        found = ask(server, "/api/save", of_case(CASE))
        assert found["written"] == str(path)
        assert found["file"] == "pliers-1_best.json"
        assert json.loads(path.read_text()) == found["case"]
        assert load(path) == CASE
        assert load(path).contacts.tolist() == CASE.contacts.tolist()
        ask(server, "/api/save", of_case(CASE))  # its own file, again
        path.write_text("somebody's")
        assert "left alone" in refusal(server, "/api/save", of_case(CASE))
        assert path.read_text() == "somebody's"


def test_what_is_no_grasp_of_the_object_is_not_saved(tmp_path: Path) -> None:
    path = tmp_path / "kept.json"
    with served(CASE, save=path) as server:
        refusal(server, "/api/save", {"radius": 6, "contacts": [[0, 0], [9, 0], [5, 9]]})
        assert not path.exists()


def test_nothing_that_is_there_is_written_over(tmp_path: Path) -> None:
    path = tmp_path / "mine.json"
    path.write_text("mine")
    for there in (path, tmp_path):
        with pytest.raises(InputError, match="--save"), served(CASE, save=there):
            pass
    with (
        pytest.raises(InputError, match="no folder"),
        served(CASE, save=tmp_path / "no" / "x.json"),
    ):
        pass
    assert path.read_text() == "mine"


@pytest.mark.parametrize("radius", [0.0, 0.05, 0.4, 3.0])
@pytest.mark.parametrize("shift", [0.0, 1e7])
def test_the_track_is_where_finger_centres_can_be(radius: float, shift: float) -> None:
    outline = Outline(np.array(T) + shift)
    track = track_of(outline, radius)
    off = shapely.distance(outline.polygon.exterior, shapely.points(track)) - radius
    assert np.abs(off).max() < 2e-4 * outline.diameter
    assert shapely.LinearRing(track).is_ccw
    assert not shapely.contains_properly(outline.polygon, shapely.points(track)).any()
