"""The front door: what a user of Python meets, and what wrong input is told."""

from __future__ import annotations

import inspect
import json
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
import shapely

import icage
from icage.contact_space.method import CONTACT_SPACE
from icage.errors import CaseError, GraspError, HandError, MethodError, OutlineError, PlacementError
from icage.formats.picture import cage_picture, case_picture, way_out_picture
from sim import SimConfig, replay

TRIANGLE = [[0, 0], [1, 0], [0.5, 0.75**0.5]]
CONTACTS = [[0.5, 0], [0.75, 0.1875**0.5], [0.25, 0.1875**0.5]]
NAN, INF = float("nan"), float("inf")


def grown(radius: float) -> list[list[float]]:
    """The contacts moved out by a radius."""
    middle = np.mean(TRIANGLE, axis=0)
    out = np.array(CONTACTS) - middle
    return (np.array(CONTACTS) + radius * out / np.hypot(*out.T)[:, None]).tolist()


@pytest.fixture(scope="module")
def cage() -> icage.Cage:
    return icage.plan(TRIANGLE, CONTACTS)


@pytest.fixture(scope="module")
def case() -> icage.Case:
    return icage.Case("triangle", "mm", icage.Outline(TRIANGLE), 0.05, np.array(grown(0.05)))


WRONG_RADIUS = [-1, -1e-300, NAN, INF, -INF, "1", None.__class__, True, 1j, [0.1], 20.0]


@pytest.mark.parametrize("radius", WRONG_RADIUS)
def test_a_wrong_radius_has_one_clear_error(radius: object) -> None:
    with pytest.raises(GraspError, match="finger_radius") as error:
        icage.plan(TRIANGLE, CONTACTS, radius)  # pyright: ignore[reportArgumentType]
    assert "\n" not in str(error.value)


WRONG_CONTACTS = {
    "empty": ([], GraspError, "shape"),
    "two": (CONTACTS[:2], GraspError, "shape"),
    "four": ([*CONTACTS, [0, 0]], GraspError, "shape"),
    "ragged": ([[0.5, 0], [1], [0, 1]], GraspError, "three finger centres"),
    "three numbers each": ([[*c, 0] for c in CONTACTS], GraspError, "shape"),
    "a string": ("contacts", GraspError, "three finger centres"),
    "strings": ([["a", "b"]] * 3, GraspError, "three finger centres"),
    "a dictionary": ({"x": 1}, GraspError, "three finger centres"),
    "nan": ([[NAN, 0], *CONTACTS[1:]], GraspError, "finite"),
    "inf": ([[INF, 0], *CONTACTS[1:]], GraspError, "finite"),
    "clockwise": (CONTACTS[::-1], HandError, "clockwise"),
    "coincident": ([CONTACTS[0]] * 3, HandError, "coincide"),
    "collinear": ([[0, 0], [0.5, 0], [1, 0]], HandError, "collinear"),
    "inside": ([[0.5, 0.1], *CONTACTS[1:]], GraspError, "inside the outline"),
    "off": ([[0.5, -0.1], *CONTACTS[1:]], GraspError, "from the outline"),
    "a placement": (icage.Placement(0.5, 0.0, 0.0, 0.5), icage.InputError, "Placement"),
}


@pytest.mark.parametrize("name", WRONG_CONTACTS)
@pytest.mark.parametrize("method", ["cells", "contact-space"])
def test_wrong_contacts_have_one_clear_error(name: str, method: str) -> None:
    contacts, kind, words = WRONG_CONTACTS[name]
    with pytest.raises(kind, match=words) as error:
        icage.plan(TRIANGLE, contacts, method=method)  # pyright: ignore
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    "vertices",
    [[], [[0, 0]], TRIANGLE[:2], [[0, 0], [1, 1], [0, 1], [1, 0]], [[NAN, 0], [1, 0], [0, 1]],
     [[0, 0], [1, 0], [10**400, 1]], [[0, 0, 0]] * 3, None, [[0, 0], [1, 0], [2, 0]]],
)  # fmt: skip
def test_wrong_vertices_have_one_clear_error(vertices: object) -> None:
    with pytest.raises(OutlineError) as error:
        icage.plan(vertices, CONTACTS)  # pyright: ignore[reportArgumentType]
    assert "\n" not in str(error.value)


def test_other_wrong_questions() -> None:
    with pytest.raises(icage.InputError, match="method is 'magic'"):
        icage.plan(TRIANGLE, CONTACTS, method="magic")  # pyright: ignore[reportArgumentType]
    with pytest.raises(GraspError, match="no target grasp"):
        icage.plan(TRIANGLE)
    with pytest.raises(CaseError, match="unit"):
        icage.Case("a", "inch", icage.Outline(TRIANGLE))  # pyright: ignore[reportArgumentType]
    with pytest.raises(CaseError, match="name"):
        icage.Case("", "mm", icage.Outline(TRIANGLE))
    with pytest.raises(CaseError, match="printable"):
        icage.Case("a\x1b[2J", "mm", icage.Outline(TRIANGLE))
    with pytest.raises(AttributeError, match="it has"):
        _ = icage.cages  # pyright: ignore[reportAttributeAccessIssue]


BIG = 10**400
WRONG_CALLS = {
    "plan a name": lambda c, g: icage.plan("triangle", CONTACTS),
    "plan with a method None": lambda c, g: icage.plan(c, method=None),
    "plan with a method 5": lambda c, g: icage.plan(c, method=5),
    "plan far contacts": lambda c, g: icage.plan(TRIANGLE, [[0, 0], [1, 0], [0, BIG]]),
    "regrasp nothing": lambda c, g: icage.regrasp(None, finger_radius=1.0),
    "regrasp on a word": lambda c, g: icage.regrasp(c, outline="x"),
    "regrasp to nowhere": lambda c, g: icage.regrasp(c),
    "regrasp without a grasp": lambda c, g: icage.regrasp(
        icage.Case("t", "mm", icage.Outline(TRIANGLE)), finger_radius=0.1
    ),
    "case of a word": lambda c, g: icage.Case("T", "mm", "x"),
    "load a wrong grasp": lambda c, g: icage.load("pliers", grasp=1.5),
    "load a wrong width": lambda c, g: icage.load("pliers", width="x"),
    "load a huge width": lambda c, g: icage.load("drawing.svg", width=BIG),
    "load a wrong unit": lambda c, g: icage.load(TRIANGLE, unit=b"mm"),
    "load nothing": lambda c, g: icage.load("no such file"),
    "load a case": lambda c, g: icage.load(c),
    "grasps, half a one": lambda c, g: c.grasps(top=1.5),
    "grasps, none": lambda c, g: c.grasps(top=0),
    "grasps by a number": lambda c, g: c.grasps(rng=0),
    "hand of a word": lambda c, g: icage.HandShape("x"),
    "hand of degrees": lambda c, g: icage.HandShape.from_angles(60, 120),
    "hand of words": lambda c, g: icage.HandShape.from_angles_deg("60", "120"),
    "placement of a word": lambda c, g: icage.Placement("x", 0, 0, 1),
    "grasp of a word": lambda c, g: icage.Grasp("a", 1, 2, 3, 4),
    "regions of bytes": lambda c, g: g.regions(b"x"),
    "regions of a wide gap": lambda c, g: g.regions(gap=2.0),
    "save to nothing": lambda c, g: g.save(None),
    "save to a zero byte": lambda c, g: g.save("\0"),
    "read nothing": lambda c, g: icage.read_cage(None),
    "replay nothing": lambda c, g: replay(None),
    "replay for ever": lambda c, g: replay(g, trials=INF),
    "replay half a trial": lambda c, g: replay(g, trials=1.5),
    "replay none": lambda c, g: replay(g, trials=0),
    "replay from a word": lambda c, g: replay(g, seed="x"),
    "replay from below": lambda c, g: replay(g, seed=-1),
    "replay on a word": lambda c, g: replay(g, threads="x"),
    "replay on fewer than none": lambda c, g: replay(g, threads=-3),
    "replay another set": lambda c, g: replay(g, which="zz"),
    "replay as a word": lambda c, g: replay(g, config="x"),
    "replay points": lambda c, g: replay(icage.plan(TRIANGLE, CONTACTS)),
    "a world of words": lambda c, g: SimConfig(time_step="x"),
}


@pytest.mark.parametrize("name", WRONG_CALLS)
def test_every_wrong_call_has_one_clear_error(name: str, case: icage.Case) -> None:
    with pytest.raises(icage.InputError) as error:
        WRONG_CALLS[name](case, icage.plan(case))
    assert str(error.value)
    assert "\n" not in str(error.value)


def test_a_clockwise_outline_and_lists_are_fine(cage: icage.Cage) -> None:
    other = icage.plan(TRIANGLE[::-1], tuple(map(tuple, CONTACTS)))
    assert other.sigma_max == pytest.approx(cage.sigma_max, rel=1e-12)


def test_a_case_plans_as_its_parts_do(case: icage.Case) -> None:
    whole = icage.plan(case)
    parts = icage.plan(TRIANGLE, grown(0.05), 0.05)
    assert whole.sigma_max == parts.sigma_max
    assert (whole.name, whole.unit) == ("triangle", "mm")
    assert (parts.name, parts.unit) == ("", "")
    assert icage.plan(case.with_grasp(case.contacts)) == whole
    assert icage.plan(case, case.contacts) == whole


def test_equality_and_hashes_answer(cage: icage.Cage, case: icage.Case) -> None:
    again = icage.plan(TRIANGLE, CONTACTS)
    assert cage == again
    assert hash(cage) == hash(again)
    assert cage != icage.plan(TRIANGLE, np.roll(CONTACTS, 1, axis=0))
    assert cage != 1
    assert case == icage.Case("triangle", "mm", icage.Outline(TRIANGLE), 0.05, case.target)
    assert case != icage.Case("other", "mm", icage.Outline(TRIANGLE), 0.05, case.target)
    assert (
        len({icage.Outline(TRIANGLE), icage.Outline(TRIANGLE), icage.Outline(TRIANGLE[::-1])}) < 3
    )
    assert cage.grasps[0] == again.grasps[0]
    assert cage.punctures == again.punctures
    assert cage.hand == again.hand


def test_arrays_are_read_only(cage: icage.Cage, case: icage.Case) -> None:
    arrays = [cage.outline.vertices, case.contacts, cage.contacts, cage.escape_path]
    arrays += [cage.grasps[0].contacts, cage.punctures[0].contacts, cage.hand.z]
    for array in arrays:
        assert array is not None
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 7.0


def test_reprs_are_short(cage: icage.Cage, case: icage.Case) -> None:
    grasp = icage.Grasp(np.array(CONTACTS), 0.5, 0.8, None, 1.6)
    for value in (cage, case, case.outline, cage.hand, grasp):
        assert len(repr(value)) < 160


def test_reprs_of_every_status() -> None:
    never = icage.Cage(
        icage.Outline(TRIANGLE), icage.HandShape.from_angles_deg(60, 120), 0.0, np.array(CONTACTS),
        icage.CageStatus.NEVER_ESCAPES, None, 1.0, None, None,
    )  # fmt: skip
    assert "never escapes" in repr(never)
    square = [[0, 0], [2, 0], [2, 1], [0, 1]]
    held = icage.plan(square, [[0.5, 0], [1.5, 0], [1, 1]])
    assert held.status == "not_a_cage"
    assert "not a cage" in repr(held)
    ET.fromstring(held._repr_svg_())


def test_a_query_takes_one_placement_or_many(cage: icage.Cage) -> None:
    place = cage.target_placement
    one = cage.query(place)
    assert one.verdict is icage.PlacementClass.TARGET
    assert one == cage.query(place.as_array().tolist())
    rows = cage.query(np.array([place.as_array(), [9.0, 9.0, 0.0, 0.5]]))
    assert len(rows) == 2
    assert rows[0] == one
    assert rows[1].verdict == "escapes"
    assert json.dumps(one.verdict) == '"target"'
    for wrong in ([1, 2, 3], [[1, 2, 3]], [0, 0, 0, -1.0], [0, 0, 0, NAN], "here", None):
        with pytest.raises(PlacementError):
            cage.query(wrong)


def test_regions_hold_the_target(cage: icage.Cage) -> None:
    for level in ("sigma_max", "sigma_first", 0.5 * (cage.sigma_0 + (cage.sigma_max or 0.0))):
        inner, outer = cage.regions(level), cage.regions(level, bound="outer")
        for k, point in enumerate(cage.contacts):
            assert outer[k].distance(shapely.Point(point)) < 1e-9
            assert inner[k].area <= outer[k].area
    for wrong in ("sigma", 0.0, 99.0, NAN):
        with pytest.raises(icage.InputError):
            cage.regions(wrong)
    with pytest.raises(icage.InputError, match="bound"):
        cage.regions(bound="middle")  # pyright: ignore[reportArgumentType]


def test_the_contact_space_names_the_method_that_answers() -> None:
    paper = icage.plan(TRIANGLE, CONTACTS, method=CONTACT_SPACE)
    for ask in (lambda: paper.query([0, 0, 0, 1]), paper.regions):
        with pytest.raises(MethodError, match="cells"):
            ask()
    ET.fromstring(paper._repr_svg_())


def test_pictures_are_svg(cage: icage.Cage, case: icage.Case) -> None:
    for text in (cage_picture(cage), case_picture(case), way_out_picture(cage)):
        assert ET.fromstring(text).tag.endswith("svg")
        assert len(text) < 60_000
        assert "nan" not in text


def test_a_saved_cage_is_the_same_and_an_edited_one_is_refused(
    case: icage.Case, tmp_path: Path
) -> None:
    cage, file = icage.plan(case), tmp_path / "cage.json"
    cage.save(file)
    again = icage.read_cage(file)
    assert (again.status, again.name, again.unit) == (cage.status, cage.name, cage.unit)
    for level in ("sigma_0", "sigma_first", "sigma_max"):
        assert getattr(again, level) == pytest.approx(getattr(cage, level), rel=1e-12)
    document = json.loads(file.read_text())
    document["sigma_max"] *= 1.01
    file.write_text(json.dumps(document))
    with pytest.raises(CaseError, match="sigma_max"):
        icage.read_cage(file)
    bare = icage.plan(TRIANGLE, CONTACTS)
    bare.save(file)
    assert (icage.read_cage(file).name, icage.read_cage(file).unit) == ("", "")


def test_every_public_name_is_documented() -> None:
    for name in icage.__all__:
        found = getattr(icage, name)
        assert inspect.getdoc(found), name
        if inspect.isfunction(found):
            text = inspect.getdoc(found) or ""
            assert "Raises" in text, name
            assert ">>>" in text, name


def test_nothing_heavy_is_loaded_before_it_is_named() -> None:
    code = "import sys, icage, sim; print(*({'numba', 'shapely', 'mujoco'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == ""
    code = "import sys, icage; icage.plan(%s, %s)._repr_svg_(); print('matplotlib' in sys.modules)"
    code %= (TRIANGLE, CONTACTS)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
