"""``icage regress``: planted faults are caught by physics, and the baseline guards the rest."""

from __future__ import annotations

import functools
import json
import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

from experiments.cases.with_discs import HandAndObject, PhysicalCase, physical_case
from experiments.escape.run import attacked
from experiments.regress.baseline import differences
from experiments.regress.cases import EFFORTS, Effort, shipped
from experiments.regress.checks import checks
from experiments.regress.document import row_document
from experiments.regress.measure import Planned, Row, in_physics, plan_both
from experiments.regress.run import one_case
from experiments.regress.table import bottom_line, markdown, terminal
from icage.contact_space.method import ContactSpace
from icage.formats.load import load
from icage.hand import HandShape
from icage.outline import Outline
from icage.planner import plan
from models import CASES, case_paths
from tests.experiments.commands.runner import here

CLOSE = Effort("fast", 12, 0, (), 0)
ATTACK = Effort("fast", 0, 4, ("guided",), 0)
PAPER_SHAPE = str(case_paths("pliers")[1])


@pytest.fixture(scope="module")
def sound() -> PhysicalCase:
    """The pliers in the paper's hand, as planned."""
    return physical_case(load(PAPER_SHAPE))


@functools.cache
def planned() -> Planned:
    return plan_both(load(PAPER_SHAPE))


def failures(physical: PhysicalCase, effort: Effort) -> tuple[str, ...]:
    """What physics alone says: the plan is not compared with anything."""
    return checks(in_physics(Row("case", planned(), 0, effort), physical))


def simulating(physical: PhysicalCase, **changes: Any) -> PhysicalCase:
    wrong: HandAndObject = replace(physical.simulated, **changes)
    return replace(physical, simulated=wrong)


def mirrored(outline: Outline) -> Outline:
    middle = outline.vertices[:, 0].min() + outline.vertices[:, 0].max()
    return Outline(np.column_stack([middle - outline.vertices[:, 0], outline.vertices[:, 1]]))


def test_what_is_sound_passes(sound: PhysicalCase) -> None:
    assert not failures(sound, CLOSE)


def test_closings_with_friction_from_below_their_level(sound: PhysicalCase) -> None:
    row = in_physics(Row("case", planned(), 0, replace(CLOSE, mus=(0.1, 0.4))), sound)
    assert not checks(row)
    document = row_document(row)
    assert [run["mu"] for run in document["friction"]] == [0.1, 0.4]
    assert all(run["target"] == run["trials"] >= 6 for run in document["friction"])
    assert all(run["trials"] + run["near_level"] == 12 for run in document["friction"])
    counted = sum(run["trials"] for run in document["friction"])
    assert any(f"{counted}/{counted}, 2" in line for line in terminal([document]))
    (ends, other) = row.rubbed
    kept = int(ends.kept.sum())
    lost = replace(ends, in_target=np.arange(len(ends)) != np.flatnonzero(ends.kept)[0])
    found = checks(replace(row, rubbed=(lost, other)))
    assert any("friction 0.1" in line and f"{kept - 1} of {kept}" in line for line in found)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("factor", "words"), [(1.01, ["escaped below"]), (0.99, ["escaped above", "measure"])]
)
def test_a_sigma_max_off_by_one_percent_is_caught(
    sound: PhysicalCase, factor: float, words: list[str]
) -> None:
    cage = sound.cage
    assert cage.sigma_max is not None
    assert cage.sigma_max_upper is not None
    wrong = replace(
        cage, sigma_max=factor * cage.sigma_max, sigma_max_upper=factor * cage.sigma_max_upper
    )
    found = failures(replace(sound, cage=wrong), ATTACK)
    for word in words:
        assert any("guided attacks" in line and word in line for line in found), found


def test_no_tunnel_edges_are_caught_by_both_methods() -> None:
    case = load(str(CASES / "tunnel_golden.json"))
    wrong = plan_both(case, ContactSpace(tunnels=False))
    found = checks(Row("tunnel_golden", wrong, 0, CLOSE))
    assert any("the two methods disagree: sigma_max" in line for line in found), found


@pytest.mark.slow
def test_no_tunnel_edges_are_caught_by_physics() -> None:
    """Discs of 0.1 %: larger ones do not fit through the tunnel, and it does not matter."""
    point = load(str(CASES / "tunnel_golden.json"))
    physical = physical_case(point, radii=[0.001])
    case = physical.case
    wrong = plan(case.outline, case.contacts, case.finger_radius, ContactSpace(tunnels=False))
    assert wrong.sigma_max is not None
    assert physical.cage.sigma_max is not None
    assert wrong.sigma_max > 1.005 * physical.cage.sigma_max
    right = physical.cage.escape_path  # led along the true way out, the claim being the wrong one
    claimed = replace(physical, cage=replace(wrong, escape_path=right))
    found = attacked(claimed, 4, 0, 1, lambda *_: None, ["guided"]).failures
    assert any("guided" in line and "4 of 4 escaped below" in line for line in found), found


def test_a_finger_radius_off_by_two_percent_is_caught(sound: PhysicalCase) -> None:
    wrong = simulating(sound, finger_radius=1.02 * sound.simulated.finger_radius)
    assert any(line.startswith("guaranteed: 0 of 12") for line in failures(wrong, CLOSE))


@pytest.mark.slow
def test_a_mirrored_object_is_caught(sound: PhysicalCase) -> None:
    wrong = simulating(sound, outline=mirrored(sound.simulated.outline))
    assert any(line.startswith("guaranteed: 0 of 12") for line in failures(wrong, CLOSE))


def test_a_wrong_phi_is_caught(sound: PhysicalCase) -> None:
    phi_1, phi_2 = sound.simulated.hand.phi
    wrong = simulating(sound, hand=HandShape.from_angles(phi_1 + np.radians(0.2), phi_2))
    assert any(line.startswith("guaranteed: 0 of 12") for line in failures(wrong, CLOSE))


def test_a_query_that_names_too_little_is_caught(
    sound: PhysicalCase, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The query forgets the target: every closing that ends there was not named."""
    monkeypatch.setattr("icage.cells.membership.Answers.grasps_of", lambda *_: ())
    found = failures(sound, CLOSE)
    assert any("had not named" in line for line in found), found


def test_shipped_cases() -> None:
    every = shipped("default")
    assert len({entry.name for entry in every}) == len(every) >= 36
    assert {entry.name for entry in shipped("fast")} < {entry.name for entry in every}
    assert shipped("full") == every
    assert EFFORTS["full"].attacks == 200


ROW = {
    "planner": {"verdict": "cage", "sigma_max": 2.0, "grasps": 3},
    "closings": {"guaranteed": {"trials": 100, "target": 100, "penetration": 5e-4}},
    "attacks": {
        "below": 1.99,
        "solref": [5e-4, 2.0],
        "guided": {"below": {"attacks": 24, "escapes": 0}, "measured": [1.999, 2.001]},
    },
    "shake": {"held": True, "rank": 3},
    "second": {"random_below": {"attacks": 10, "escapes": 0}},
}


def changed(path: str, value: Any) -> dict[str, Any]:
    row = json.loads(json.dumps(ROW))
    *parents, last = path.split(".")
    inner = row
    for key in parents:
        inner = inner[key]
    inner[last] = value
    return row


@pytest.mark.parametrize(
    ("path", "value", "fails"),
    [
        ("planner.sigma_max", 2.0 * (1 + 0.9e-7), False),
        ("planner.sigma_max", 2.0 * (1 + 1.1e-7), True),
        ("planner.sigma_max", None, True),
        ("planner.verdict", "not_a_cage", True),
        ("planner.grasps", 4, True),
        ("closings.guaranteed.target", 99, True),
        ("closings.guaranteed.penetration", 7.4e-4, False),
        ("closings.guaranteed.penetration", 7.6e-4, True),
        ("attacks.guided.below.escapes", 3, True),
        ("attacks.guided.measured", [1.998, 2.001], False),
        ("attacks.guided.measured", [1.990, 2.001], True),
        ("attacks.guided.measured", [1.999, None], True),
        ("attacks.below", 1.991, True),
        ("attacks.solref", [1e-3, 1.0], True),
        ("shake.held", False, True),
        ("shake.rank", 2, True),
        ("second", None, False),
        ("second.random_below.escapes", 4, True),
    ],
)
def test_tolerances_of_the_baseline(path: str, value: Any, fails: bool) -> None:
    assert not differences(ROW, ROW)
    found = differences(changed(path, value), ROW)
    assert bool(found) == fails, found
    if fails:
        assert found[0].startswith(path)


def test_not_a_cage_is_checked_for_its_verdict_only() -> None:
    entry = next(e for e in shipped("fast") if e.name == "rectangle_notcage")
    row, record, seconds = one_case(entry, CLOSE)
    assert record == ([], None)
    assert seconds >= 0.0
    assert row["planner"]["verdict"] == "not_a_cage"
    assert "parallel" in row["why_no_physics"]
    assert (row["physical"], row["attacks"], row["failures"]) == (None, None, [])


@pytest.mark.slow
def test_attacks_on_what_is_sound_and_their_table(sound: PhysicalCase) -> None:
    done = in_physics(Row("pliers", planned(), 0, replace(ATTACK, closings=12)), sound)
    assert not checks(done)
    row = row_document(done)
    text = "\n".join(terminal([row]))
    assert "12/12" in text
    assert "0/4" in text
    assert "4 of 4 guided ones above it" in bottom_line([row])
    page = "\n".join(markdown([row], "title", "icage regress"))
    assert page.startswith("# title\n\n| case |")
    assert page.endswith("    icage regress")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder of cases that need no physics: two that are no cages."""
    cases = tmp_path / "cases"
    cases.mkdir()
    for name in ("rectangle_notcage", "stretching_not_a_cage"):
        (cases / f"{name}.json").write_text((CASES / f"{name}.json").read_text())
    return cases


def test_command_baseline_and_files(folder: Path, tmp_path: Path, capsys: Any) -> None:
    base, xml, page = (tmp_path / name for name in ("base.json", "r.xml", "r.md"))
    arguments = ("regress", "--cases", str(folder), "--baseline", str(base), "--workers", "1")
    first = here(capsys, *arguments)
    assert first.code == 0
    assert "rectangle_notcage is not in the baseline" in first.err
    assert here(capsys, *arguments, "--update-baseline").code == 0
    again = here(capsys, *arguments, "--junit", str(xml), "--markdown", str(page))
    assert (again.code, again.err) == (0, "")
    assert "2 cases, 0 failed" in again.out
    assert ET.parse(xml).getroot().attrib["failures"] == "0"
    assert "no physics" in page.read_text()
    document = json.loads(base.read_text())
    document["cases"]["rectangle_notcage"]["planner"]["sigma_0"] *= 1.001
    base.write_text(json.dumps(document))
    broken = here(capsys, *arguments, "--junit", str(xml))
    assert broken.code == 1
    assert "rectangle_notcage: baseline: planner.sigma_0" in broken.out
    failed = ET.parse(xml).getroot().find("testcase/failure")
    assert failed is not None
    assert "planner.sigma_0" in str(failed.text)
    updated = here(capsys, *arguments, "--update-baseline")
    assert updated.code == 0
    assert "baseline changes: rectangle_notcage: planner.sigma_0" in updated.err
    assert here(capsys, *arguments).code == 0


@pytest.mark.slow
def test_any_closing_can_be_run_again(
    tmp_path: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(EFFORTS, "fast", replace(EFFORTS["fast"], closings=3, attacks=0, second=2))
    cases, out = tmp_path / "cases", tmp_path / "out"
    cases.mkdir()
    for path in (*case_paths("pliers")[1:2], CASES / "rectangle_notcage.json"):
        (cases / path.name).write_text(path.read_text())
    arguments = ("regress", "--fast", "--cases", str(cases), "--baseline", str(tmp_path / "none"))
    done = here(capsys, *arguments, "--workers", "1", "--out", str(out))
    assert done.code == 0, done
    assert "Both engines" in done.out
    for index, which in enumerate(("guaranteed", "outside")):
        again = here(capsys, "replay-trial", str(out), str(3 * index + 1))
        assert again.code == 0, again
        assert f"{which} set, trial 1" in again.out
        assert "the same to the last bit" in again.out
    assert here(capsys, "replay-trial", str(out), "6").code == 2


@pytest.mark.slow
@pytest.mark.first
def test_the_fast_regression_is_as_committed(capsys: Any) -> None:
    """Every case of ``icage regress --fast`` holds and is within its baseline."""
    done = here(capsys, "regress", "--fast", "--workers", "1")
    assert (done.code, done.err) == (0, ""), done


def test_bad_input(folder: Path, tmp_path: Path, capsys: Any) -> None:
    assert "not a folder" in here(capsys, "regress", "--cases", "nowhere").error_line()
    assert "no case file" in here(capsys, "regress", "--cases", str(tmp_path)).error_line()
    bad = tmp_path / "bad.json"
    bad.write_text("{}")
    arguments = ("regress", "--cases", str(folder), "--baseline", str(bad))
    assert "not a baseline" in here(capsys, *arguments).error_line()
    assert "not allowed" in here(capsys, "regress", "--fast", "--full").error_line()


def test_the_outline_of_the_fault_is_a_mirror_image(sound: PhysicalCase) -> None:
    outline = sound.simulated.outline
    other = mirrored(outline)
    assert other.area == pytest.approx(outline.area)
    assert not shapely.equals_exact(other.polygon, outline.polygon, 1.0)
