from __future__ import annotations

import copy
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from icage.case import Case
from icage.errors import CaseError, GraspError, HandError, InputError, OutlineError
from icage.formats.case_json import parse_case, read_case, read_object
from models import CASES
from tests.icage.formats.svg.drawings import drawing

HERE = Path()
GONE = object()


def changed(case: dict[str, Any], place: tuple[str | int, ...], value: Any) -> dict[str, Any]:
    """A copy of the case with one value replaced, or with its key gone."""
    other = copy.deepcopy(case)
    inner: Any = other
    for key in place[:-1]:
        inner = inner[key]
    if value is GONE:
        del inner[place[-1]]
    else:
        inner[place[-1]] = value
    return other


def test_a_case_is_read_as_it_stands(square: dict[str, Any]):
    case = parse_case(square, HERE)
    assert (case.name, case.unit, case.finger_radius) == ("square", "mm", 0.0)
    assert case.outline.vertices.tolist() == [[0, 0], [1, 0], [1, 1], [0, 1]]
    assert case.contacts.tolist() == [[0, 0.5], [1, 0.25], [1, 0.75]]
    assert not case.contacts.flags.writeable


def test_defaults_are_metres_and_points(square: dict[str, Any]):
    del square["unit"], square["finger_radius"]
    case = parse_case(square, HERE)
    assert (case.unit, case.finger_radius) == ("m", 0.0)


def test_unknown_keys_are_passed_over(square: dict[str, Any]):
    parse_case({**square, "expected": {"sigma_0": 1.0}, "note": None}, HERE)


@pytest.mark.parametrize("file", sorted(CASES.glob("*.json")), ids=lambda file: file.stem)
def test_every_solved_problem_is_a_case(file: Path):
    case = read_case(file)
    written = json.loads(file.read_text())
    assert case.name == file.stem == written["name"]
    assert case.contacts.tolist() == written["grasp"]["contacts"]


@pytest.mark.parametrize(
    ("place", "value", "message"),
    [
        (("format",), GONE, "no key 'format'"),
        (("format",), "icage-case/2", "'icage-case/1' is needed"),
        (("format",), 1, "format is 1"),
        (("name",), GONE, "no key 'name'"),
        (("name",), 7, "name is 7"),
        (("name",), "", "name is"),
        (("name",), "a\nb", "printable"),
        (("name",), "x" * 101, "1 to 100 characters"),
        (("unit",), "inch", "one of m, mm, cm"),
        (("unit",), None, "unit is null"),
        (("unit",), ["m"], "unit is a list"),
        (("outline",), GONE, "no key 'outline'"),
        (("outline",), [[0, 0], [1, 0], [0, 1]], "outline is a list; an object"),
        (("outline", "vertices"), GONE, "neither of the keys 'vertices' and 'file'"),
        (("outline", "file"), "a.svg", "both of the keys"),
        (("outline", "vertices"), None, "vertices is null; a list"),
        (("outline", "vertices"), {}, "vertices is an object; a list"),
        (("outline", "vertices"), [], "0 different vertices"),
        (("outline", "vertices", 2), 3.0, r"vertices\[2\] is 3.0; a pair"),
        (("outline", "vertices", 2), [1, 2, 3], r"vertices\[2\] is a list; a pair"),
        (("outline", "vertices", 2), ["1", 2], r'vertices\[2\]\[0\] is "1"; a number'),
        (("outline", "vertices", 2), [True, 2], r"vertices\[2\]\[0\] is true; a number"),
        (("outline", "vertices", 2), [None, 2], r"vertices\[2\]\[0\] is null; a number"),
        (("outline", "vertices", 2), [10**400, 2], "too large for a double"),
        (("outline", "vertices"), [[0, 0]] * 2001, "at most 2000"),
        (("finger_radius",), -0.1, "finger_radius is -0.1; 0 or more"),
        (("finger_radius",), "0", 'finger_radius is "0"; a number'),
        (("finger_radius",), False, "finger_radius is false; a number"),
        (("finger_radius",), 1e9, "finger_radius is 1e\\+09 mm; 0 to"),
        (("finger_radius",), 1e-300, "finger_radius is 1e-300 mm; 0 for point fingers, or at"),
        (("finger_radius",), 1e-12, "finger_radius is 1e-12 mm; 0 for point fingers, or at"),
        (("grasp",), GONE, "no key 'grasp'"),
        (("grasp",), [], "grasp is a list; an object"),
        (("grasp", "contacts"), GONE, "grasp has no key 'contacts'"),
        (("grasp", "contacts"), [[0, 0.5], [1, 0.5]], "has 2 points; 3 are needed"),
        (("grasp", "contacts"), [[0, 0]] * 4, "has 4 points; 3 are needed"),
        (("grasp", "contacts", 1), "here", r'contacts\[1\] is "here"; a pair'),
        (("grasp", "contacts", 1, 0), {}, r"contacts\[1\]\[0\] is an object; a number"),
    ],
)
def test_what_is_malformed_is_named(
    square: dict[str, Any], place: tuple[str | int, ...], value: Any, message: str
):
    with pytest.raises(InputError, match=message) as caught:
        parse_case(changed(square, place, value), HERE)
    assert "\n" not in str(caught.value)


def test_a_mistyped_key_gets_a_hint(square: dict[str, Any]):
    square["Grasp"] = square.pop("grasp")
    with pytest.raises(CaseError, match="no key 'grasp' .it has 'Grasp'"):
        parse_case(square, HERE)


@pytest.mark.parametrize(
    ("vertices", "message"),
    [
        ([[0, 0], [1, 1], [1, 0], [0, 1]], r"Self-intersection\[0.5 0.5\]"),
        ([[0, 0], [1, 0], [2, 0], [1, 0]], "not simple|no area"),
        ([[0, 0], [1, 1], [2, 2]], "not simple|no area"),
        ([[0, 0], [0, 0], [1, 0], [1, 0]], "2 different vertices"),
        ([[0, 0], [1, 0], [1e13, 1]], "up to 1e"),
    ],
)
def test_bad_outlines_say_where(square: dict[str, Any], vertices: Any, message: str):
    square["outline"]["vertices"] = vertices
    with pytest.raises(OutlineError, match=f"outline.vertices: .*({message})"):
        parse_case(square, HERE)


@pytest.mark.parametrize(
    ("contacts", "kind", "message"),
    [
        ([[0, 0.5], [1, 0.75], [1, 0.25]], HandError, "clockwise"),
        ([[0, 0.5], [1, 0.5], [1, 0.5]], HandError, "coincide"),
        ([[0, 0.2], [0, 0.5], [0, 0.7]], HandError, "collinear"),
        ([[0, 0.5], [1, 0.25], [0.9, 0.75]], GraspError, "contact 3 .*inside the outline, 0.1 "),
        (
            [[0, 0.5], [1, 0.25], [1.25, 0.75]],
            GraspError,
            "contact 3 .*is 0.25 mm from the outline",
        ),
        ([[0, 0.5], [1.00001, 0.25], [1, 0.75]], GraspError, "contact 2 .*is 1e-05 mm from"),
    ],
)
def test_bad_contacts_say_which_and_how_far(
    square: dict[str, Any], contacts: Any, kind: type[InputError], message: str
):
    square["grasp"]["contacts"] = contacts
    with pytest.raises(kind, match=f"grasp.contacts: .*{message}"):
        parse_case(square, HERE)


def test_contacts_may_be_off_by_a_millionth_of_the_diameter(square: dict[str, Any]):
    square["grasp"]["contacts"] = [[0, 0.5], [1 + 1e-6, 0.25], [1, 0.75]]
    parse_case(square, HERE)


def disc_case(square: dict[str, Any], r: float, contacts: Any) -> Case:
    return parse_case(
        {**square, "finger_radius": r, "grasp": {"contacts": [list(c) for c in contacts]}}, HERE
    )


def test_disc_centres_keep_their_distance_from_the_true_outline(square: dict[str, Any]):
    corner = 1 + 0.1 * math.cos(0.3), 1 + 0.1 * math.sin(0.3)  # on the arc round (1, 1)
    disc_case(square, 0.1, [[-0.1, 0.5], [1.1, 0.25], corner])
    short = 1 + 0.0999 * math.cos(0.3), 1 + 0.0999 * math.sin(0.3)
    with pytest.raises(GraspError, match=r"contact 3 .*0\.0999 mm from the outline, nearer than"):
        disc_case(square, 0.1, [[-0.1, 0.5], [1.1, 0.25], short])
    with pytest.raises(GraspError, match="must be finger_radius = 0.1 mm away"):
        disc_case(square, 0.1, [[-0.2, 0.5], [1.1, 0.25], corner])
    with pytest.raises(GraspError, match="contact 1 .*lies inside the outline"):
        disc_case(square, 0.1, [[0.1, 0.5], [1.1, 0.25], corner])


def test_overlapping_discs_name_the_side(square: dict[str, Any]):
    with pytest.raises(GraspError, match=r"fingers 2 and 3 overlap: side 2-3 is 0\.19"):
        disc_case(square, 0.1, [[-0.1, 0.5], [1.1, 0.4], [1.1, 0.59]])
    disc_case(square, 0.1, [[-0.1, 0.5], [1.1, 0.4], [1.1, 0.6]])


POCKET = [[0, 0], [10, 0], [10, 10], [5.5, 10], [5.5, 9], [8, 9], [8, 4], [2, 4], [2, 9], [4.5, 9]]
"""A box with a wide chamber behind a neck one unit wide."""


def test_a_radius_that_closes_the_pocket_of_a_contact(square: dict[str, Any]):
    square["outline"]["vertices"] = [*POCKET, [4.5, 10], [0, 10]]
    centres = [[10.8, 5.0], [5.0, 4.8], [10.8, 6.0]]
    with pytest.raises(
        GraspError, match="contact 2 .*pocket that finger_radius = 0.8 mm closes off"
    ):
        disc_case(square, 0.8, [[-0.8, 5.0], centres[1], [10.8, 6.0]])
    # Through the neck: half a unit is too wide by a hair, 0.49 is not.
    disc_case(square, 0.49, [[-0.49, 5.0], [5.0, 4.49], [10.49, 6.0]])


def test_a_radius_that_fills_the_pocket_of_a_contact(square: dict[str, Any]):
    notch = [[0, 0], [10, 0], [10, 10], [6, 10], [6, 7], [5, 7], [5, 10], [0, 10]]
    square["outline"]["vertices"] = notch
    with pytest.raises(GraspError, match="contact 3 .*does not fit into the pocket"):
        disc_case(square, 0.8, [[-0.8, 5.0], [10.8, 5.0], [5.8, 7.8]])


def test_an_outline_from_a_drawing(square: dict[str, Any], tmp_path: Path):
    (tmp_path / "box.svg").write_text(drawing('<rect x="7" width="30" height="15"/>'))
    square["outline"] = {"file": "box.svg", "width": 2.0, "tolerance": 0.01}
    square["grasp"]["contacts"] = [[0, 0.5], [2, 0.25], [2, 0.75]]
    file = tmp_path / "case.json"
    file.write_text(json.dumps(square))
    case = read_case(file)
    assert case.outline.polygon.bounds == (0, 0, 2, 1)
    assert case.sources == read_object(file).sources == (file, tmp_path / "box.svg")


@pytest.mark.parametrize(
    ("outline", "message"),
    [
        ({"file": "box.svg"}, "states no size in mm, cm or in; a width is needed"),
        ({"file": "box.svg", "width": "2"}, 'outline.width is "2"'),
        ({"file": "box.svg", "width": -2}, "width is -2"),
        ({"file": "box.svg", "width": 2, "tolerance": None}, "outline.tolerance is null"),
        ({"file": "box.svg", "width": 2, "tolerance": 3.0}, "tolerance is 3"),
        ({"file": "none.svg", "width": 2}, "none.svg does not exist"),
        ({"file": "", "width": 2}, "outline.file"),
        ({"file": 3, "width": 2}, "outline.file is 3"),
        ({"file": "box.odt", "width": 2}, r"a drawing \(\*.svg"),
        ({"file": "box.step", "width": 2}, "box.step is a STEP model, which is not read"),
        ({"file": "a\0b.svg", "width": 2}, "outline.file"),
    ],
)
def test_bad_drawings_in_a_case(
    square: dict[str, Any], tmp_path: Path, outline: dict[str, Any], message: str
):
    (tmp_path / "box.svg").write_text(drawing('<rect width="30" height="15"/>'))
    with pytest.raises(InputError, match=message):
        parse_case({**square, "outline": outline}, tmp_path)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "is empty"),
        (b"{", "not valid JSON: .*line 1 column 2"),
        (b'{"a": 1,\n "b" 2}', "line 2 column 6"),
        (b"[1, 2]", "the case is a list; an object"),
        (b'{"format": NaN}', "NaN is not a JSON number"),
        (b'{"format": -Infinity}', "-Infinity is not a JSON number"),
        (b'{"format": ' + b"9" * 5000 + b"}", "too many digits"),
        (b"[" * 100_000, "nested too deeply"),
        (b"\xff\xfe\x00\x01", "not UTF-8|not text"),
        (bytes(range(1, 256)), "not UTF-8"),
        (b"{}\0", "byte 2 is zero"),
    ],
)
def test_bad_files_say_what_is_wrong(tmp_path: Path, content: bytes, message: str):
    file = tmp_path / "bad.json"
    file.write_bytes(content)
    with pytest.raises(CaseError, match=message) as caught:
        read_case(file)
    assert "bad.json" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_folder_is_no_case(tmp_path: Path):
    with pytest.raises(CaseError, match="is a folder; a case file is needed"):
        read_case(tmp_path)


def test_a_byte_order_mark_is_no_harm(square: dict[str, Any], tmp_path: Path):
    file = tmp_path / "case.json"
    file.write_text("\ufeff" + json.dumps(square), encoding="utf-8")
    assert read_case(file).name == "square"


def test_an_object_needs_no_grasp(square: dict[str, Any], tmp_path: Path):
    del square["grasp"]
    file = tmp_path / "case.json"
    file.write_text(json.dumps(square))
    assert len(read_object(file).outline) == 4
    with pytest.raises(CaseError, match="no key 'grasp'"):
        read_case(file)


anything = st.recursive(
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | st.text(max_size=5)
    | st.sampled_from(["m", "mm", "icage-case/1", 0.5, [0, 1], [[0, 0], [1, 0], [0, 1]]]),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=8), inner),
    max_leaves=8,
)
places = st.sampled_from(
    [(key,) for key in ("format", "name", "unit", "outline", "finger_radius", "grasp")]
    + [
        ("outline", "vertices"),
        ("outline", "file"),
        ("outline", "vertices", 1),
        ("outline", "vertices", 1, 0),
        ("grasp", "contacts"),
        ("grasp", "contacts", 2),
        ("grasp", "contacts", 2, 1),
    ]
)


@given(places, st.just(GONE) | anything)
@settings(max_examples=400, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_a_case_is_a_case_or_an_input_error(square, place: tuple[str | int, ...], value: Any):
    if value is GONE and isinstance(place[-1], int):
        return
    if place == ("outline", "file") and value is GONE:
        return
    try:
        found = parse_case(changed(square, place, value), Path("nowhere"))
    except InputError as error:
        assert str(error).isprintable()  # noqa: PT017  (that it raises is not the point)
    else:
        assert np.isfinite(found.contacts).all()
