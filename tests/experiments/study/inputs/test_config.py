"""A study's description: every form that is allowed, and one line for everything that is not."""

from __future__ import annotations

import json
import shlex
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from experiments.cases.with_discs import PhysicalCase, physical_case
from experiments.cli import parser
from experiments.commands.study import _given
from experiments.study.inputs.config import (
    FIELDS,
    ConfigError,
    StudyConfig,
    read_toml,
    study_config,
)
from experiments.study.inputs.distributions import (
    Distribution,
    DistributionError,
    parse_distribution,
)
from experiments.study.inputs.fields import HELP
from experiments.study.inputs.read_variable import read_variable
from experiments.study.inputs.variable_list import listing
from experiments.study.inputs.variables import GROUPS, PAIRS, VARIABLES
from experiments.study.run.command import command_line
from experiments.study.run.session import session_of
from icage.case import Case
from icage.errors import InputError
from icage.formats.case_json import read_case
from models import CASES
from tests.experiments.commands.runner import here
from tests.experiments.small import cage_of, t_case, write_case

CASE = t_case()
SIZE = CASE.outline.diameter


@pytest.fixture(autouse=True)
def planned_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """The T is planned for all these tests together: they stop before anything is closed."""

    def known(case: Case) -> PhysicalCase:
        same = case.name == "T" and case.finger_radius == CASE.finger_radius
        return PhysicalCase.of(case, cage_of("T")) if same else physical_case(case)

    monkeypatch.setattr("experiments.study.run.session.physical_case", known)


def config(**table: Any) -> StudyConfig:
    return study_config({"case": "T", **table}, CASE)


def read(name: str, given: object, unit: str = "mm") -> Distribution:
    return read_variable(name, given, unit, SIZE)[name]


# ---------------------------------------------------------------------------- what is allowed

FORMS = [
    ("friction", 0.3, "fixed", (0.3,)),
    ("friction", 1, "fixed", (1.0,)),
    ("friction", "0.3", "fixed", (0.3,)),
    ("friction", " fixed : 30 % ", "fixed", (0.3,)),
    ("friction", "0:0.8", "uniform", (0.0, 0.8)),
    ("friction", "uniform:.1:8e-1", "uniform", (0.1, 0.8)),
    ("mass", "truncated:1:0.1:0.8:1.3", "truncated", (1.0, 0.1, 0.8, 1.3)),
    ("friction", "grid:0,0.1,0.4", "grid", (0.0, 0.1, 0.4)),
    ("friction", "grid:0:1:5", "grid", (0.0, 0.25, 0.5, 0.75, 1.0)),
    ("friction", "GRID:0.2", "grid", (0.2,)),
    ("place_x", "normal:2mm", "normal", (0.0, 2.0)),
    ("place_x", "normal:1:0.1cm", "normal", (1.0, 1.0)),
    ("bias_x", "normal:2%", "normal", (0.0, 0.02 * SIZE)),
    ("place_x", "-1000%:1000%", "uniform", (-10.0 * SIZE, 10.0 * SIZE)),
    ("phi_1", "normal:0:1deg", "normal", (0.0, np.deg2rad(1.0))),
    ("phi_2", "normal:7deg", "normal", (0.0, np.deg2rad(7.0))),
    ("com_x", "normal:0:2%", "normal", (0.0, 0.02 * SIZE)),
    ("linkage_play", "0:10%", "uniform", (0.0, 0.1 * SIZE)),
    ("place_x", "-1%:1%", "uniform", (-0.01 * SIZE, 0.01 * SIZE)),
    ("place_x", "-0.003 m : 0.3cm", "uniform", (-3.0, 3.0)),
    ("place_theta", "normal:2deg", "normal", (0.0, np.deg2rad(2.0))),
    ("tilt", "0.1rad:20deg", "uniform", (0.1, np.deg2rad(20.0))),
    ("tilt", "0.1", "fixed", (0.1,)),
    ("tilt_direction", "normal:10deg", "normal", (-0.5 * np.pi, np.deg2rad(10.0))),
    ("outline_noise", "0:1%", "uniform", (0.0, 0.01 * SIZE)),
]  # fmt: skip


@pytest.mark.parametrize(("name", "given", "kind", "parameters"), FORMS)
def test_every_form_and_unit_is_read(
    name: str, given: object, kind: str, parameters: tuple[float, ...]
):
    found = read(name, given)
    assert found.kind == kind
    np.testing.assert_allclose(found.parameters, parameters, rtol=1e-14)


def test_lengths_without_a_unit_are_in_that_of_the_case():
    for unit, share in (("m", 1e-3), ("cm", 0.1), ("mm", 1.0)):
        assert read("place_x", "2", unit).parameters == (2.0,)
        assert read("place_x", "2mm", unit).parameters == pytest.approx((2.0 * share,))
        assert read("place_x", "1%", unit).parameters == pytest.approx((0.01 * SIZE,))


def test_a_pair_is_two_independent_inputs():
    found = config(vary={"place_xy": "normal:1", "bias_xy": "0:1"}).vary
    assert set(found) == {"place_x", "place_y", "bias_x", "bias_y"}
    assert found["place_x"] == found["place_y"] == Distribution("normal", (0.0, 1.0))


def test_nominal_values_lie_in_the_physical_range_and_every_group_is_listed():
    for name, one in VARIABLES.items():
        assert one.name == name
        assert one.low <= one.nominal <= one.high
        assert one.group in GROUPS
        assert config().distribution(name).parameters == (one.nominal,)
    lines = "\n".join(listing())
    assert all(f"  {name} " in lines for name in VARIABLES)
    assert all(pair in lines for pair in PAIRS)
    assert "nominal 0, allowed 0 to 5)" in lines
    assert "nominal -90deg, allowed -360deg to 360deg)" in lines
    assert "nominal 0, allowed 0% to 10%)" in lines


def test_every_field_has_help_and_the_document_holds_every_field():
    names = {f.name for f in fields(StudyConfig)}
    assert names == set(HELP) == set(FIELDS)
    one = config(vary={"friction": "0:1"}, nominal=None, until_half_width=0.01)
    document = json.loads(json.dumps(one.document()))
    assert set(document) == names
    assert document["vary"] == {"friction": {"kind": "uniform", "parameters": [0.0, 1.0]}}


def test_where_a_study_starts_if_it_does_not_say():
    assert config().starts == "guaranteed"
    assert config(vary={"friction": "0:1"}).starts == "guaranteed"
    assert config(vary={"place_x": "0:1"}).starts == "nominal"
    assert config(vary={"bias_theta": 0.1}).starts == "nominal"
    assert config(nominal=[0, 0, 0, 1]).starts == "nominal"
    assert config(place="best").starts == "nominal"
    assert config(vary={"place_x": "0:1"}, starts="cage").starts == "cage"


def test_whether_there_is_friction_or_noise_at_all():
    assert not config().rough
    assert not config(vary={"friction": 0}).rough
    assert config(vary={"friction": "grid:0,0.1"}).rough
    assert not config().noisy
    assert config(vary={"outline_noise": "1%"}).noisy


# ---------------------------------------------------------------------------- values

GRID = (np.arange(20_000) + 0.5) / 20_000


def test_values_have_the_mean_and_deviation_that_were_asked_for():
    uniform = Distribution("uniform", (-1.0, 3.0)).values(GRID)
    assert uniform.mean() == pytest.approx(1.0, abs=1e-12)
    assert uniform.std() == pytest.approx(4.0 / np.sqrt(12.0), rel=1e-6)
    normal = Distribution("normal", (2.0, 0.5)).values(GRID)
    assert normal.mean() == pytest.approx(2.0, abs=1e-12)
    assert normal.std() == pytest.approx(0.5, rel=1e-3)
    within = np.abs(normal - 2.0) <= 0.5 * 1.959964
    assert within.mean() == pytest.approx(0.95, abs=1e-4)
    assert np.median(normal) == pytest.approx(2.0, abs=1e-12)


def test_truncated_is_the_normal_distribution_conditioned_on_the_range():
    """Against the normal values that happen to lie in the range, in order."""
    normal = Distribution("normal", (0.3, 0.2)).values((np.arange(1_000_000) + 0.5) / 1e6)
    kept = normal[(normal >= 0.0) & (normal <= 0.4)]
    truncated = Distribution("truncated", (0.3, 0.2, 0.0, 0.4)).values(GRID)
    np.testing.assert_allclose(truncated, np.quantile(kept, GRID), atol=2e-5)
    assert truncated.mean() == pytest.approx(kept.mean(), abs=1e-5)
    far = Distribution("truncated", (0.0, 1.0, 4.5, 5.0)).values(GRID)  # out in the tail
    assert 4.5 <= far.min() < 4.501
    assert 4.99 < far.max() <= 5.0
    assert np.median(far) < 4.65


def test_grid_values_are_as_frequent_as_each_other_and_fixed_ones_do_not_move():
    grid = Distribution("grid", (0.0, 5.0, 1.0, 7.0)).values(GRID)
    assert [int((grid == v).sum()) for v in (0.0, 5.0, 1.0, 7.0)] == [5000] * 4
    assert (Distribution("fixed", (0.1,)).values(GRID) == 0.1).all()
    assert not Distribution("fixed", (0.1,)).varies
    assert not Distribution("grid", (0.1,)).varies
    assert Distribution("grid", (0.1, 0.2)).varies


numbers = st.floats(-1e6, 1e6)
wide = st.floats(-1e99, 1e99)


@st.composite
def distributions(draw: st.DrawFn) -> Distribution:
    kind = draw(st.sampled_from(["fixed", "uniform", "normal", "truncated", "grid"]))
    if kind == "fixed":
        return Distribution(kind, (draw(wide),))
    if kind == "grid":
        return Distribution(kind, tuple(sorted(draw(st.lists(wide, min_size=1, max_size=9)))))
    if kind == "normal":
        return Distribution(kind, (draw(numbers), draw(st.floats(1e-6, 1e6))))
    low, high = sorted(draw(st.lists(wide if kind == "uniform" else numbers, min_size=2,
                                     max_size=2, unique=True)))  # fmt: skip
    if kind == "uniform":
        return Distribution(kind, (low, high))
    share, spread = draw(st.floats(-1.0, 2.0)), draw(st.floats(0.3, 10.0))
    width = high - low
    return Distribution(kind, (low + share * width, spread * width + 1e-300, low, high))


uniforms = st.lists(
    st.floats(0.0, 1.0, exclude_max=True) | st.sampled_from([0.0, 1e-300, 0.5, 1.0 - 2.0**-53]),
    min_size=1,
    max_size=20,
)


@given(distributions(), uniforms)
def test_values_are_in_range_and_grow_with_the_quantile(one: Distribution, at: list[float]):
    found = one.values(np.array(sorted(at)))
    assert np.isfinite(found).all()
    assert (found >= one.low).all()
    assert (found <= one.high).all()
    step = 1e-12 * max(abs(float(found.min())), abs(float(found.max())))
    assert (np.diff(found) >= -step).all()


@given(distributions())
def test_what_is_written_down_is_read_again(one: Distribution):
    """The command line of a finished study gives the same study."""
    document = {"config": {**StudyConfig("T", vary={"place_x": one}).document()}}
    words = command_line(document)
    text = words.split("place_x=", 1)[1].split(" --out")[0].rstrip("'")
    assert parse_distribution(text, 0.0, lambda number, unit: number) == one


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        (["--nominal=-1.5,2,-0.25,3"], ["--nominal=-1.5,2,-0.25,3"]),
        (["--place", "best"], ["--place", "best"]),
        (["--starts", "guaranteed", "--vary", "place_x=0:1"], ["--starts", "guaranteed"]),
        (["--until-half-width", "0.01"], ["--until-half-width", "0.01"]),
        (["--trials", "7", "--uncaged", "skip"], ["--trials", "7", "--uncaged", "skip"]),
        (["--vary", "place_theta=-8deg:8deg"], ["place_theta=-8deg:8deg"]),
        (["--vary", "tilt=0.3"], ["tilt=0.3rad"]),
        (["--vary", "tilt_direction=normal:10deg"], ["tilt_direction=normal:-90deg:10deg"]),
        (["--vary", "phi_1=grid:-1deg,0.1rad"], ["phi_1=grid:-1deg,0.1rad"]),
        (["--vary", "place_x=-2%:2%"], ["place_x=-2%:2%"]),
        (["--vary", "place_y=-2:0.1"], ["place_y=-2:0.1"]),
        (["--vary", "friction=uniform:30%:0.80"], ["friction=0.3:0.8"]),
        (["--vary", "mass=fixed:2.0"], ["mass=2"]),
        (["--vary", "mass=truncated:1:0.1:50%:2"], ["mass=truncated:1:0.1:0.5:2"]),
    ],
)
def test_the_printed_command_runs_the_same_study(
    options: list[str], expected: list[str], tmp_path: Path
):
    case = write_case(CASE, tmp_path / "t.json")

    def session(words: list[str]) -> Any:
        args = parser().parse_args(words)
        return session_of(_given(args), str(tmp_path / "out"), False, 10)

    first = session(["study", str(case), *options, "--out", "DIR"])
    words = shlex.split(command_line(first.document))
    assert words[0] == "icage"
    at = words.index(expected[0])
    assert words[at : at + len(expected)] == expected
    assert session(words[1:]).document == first.document


# ---------------------------------------------------------------------------- what is not

BAD_VARY = [
    ("nothing=1", "vary.nothing", "known are place_x, "),
    ("friction=-0.1:0.5", "vary.friction", "0 to 5"),
    ("friction=normal:0.1", "vary.friction", "truncated:MEAN:SD:LOW:HIGH"),
    ("friction=0.5:0.5", "vary.friction", "LOW < HIGH"),
    ("friction=0.8:0.1", "vary.friction", "LOW < HIGH"),
    ("friction=truncated:0.3:0.1:1:0", "vary.friction", "LOW < HIGH"),
    ("friction=truncated:0.3:0:0:1", "vary.friction", "above 0"),
    ("friction=truncated:0.3:0.01:2:3", "vary.friction", "holds none"),
    ("friction=truncated:0.3:0.1:0:6", "vary.friction", "0 to 5"),
    ("friction=normal:0.3:-1", "vary.friction", "above 0"),
    ("friction=grid:0,6", "vary.friction", "0 to 5"),
    ("friction=grid:", "vary.friction", "grid:A,B,C"),
    ("friction=grid:0:1:0", "vary.friction", "1 to 10000"),
    ("friction=grid:0:1:10001", "vary.friction", "1 to 10000"),
    ("friction=grid:0:1:1.5", "vary.friction", "grid:LOW:HIGH:COUNT"),
    ("friction=nan", "vary.friction", "VALUE, LOW:HIGH"),
    ("friction=0:inf", "vary.friction", "VALUE, LOW:HIGH"),
    ("friction=1e999", "vary.friction", "finite"),
    ("place_x=-1e308:1e308", "vary.place_x", "finite"),
    ("friction=0:1:2", "vary.friction", "VALUE, LOW:HIGH"),
    ("friction=uniform:1", "vary.friction", "uniform:LOW:HIGH"),
    ("friction=normal:", "vary.friction", "normal:SD"),
    ("friction=much", "vary.friction", "VALUE, LOW:HIGH"),
    ("friction=0.3mm", "vary.friction", "none or %"),
    ("place_x=2deg", "vary.place_x", "mm, cm, m or %"),
    ("place_x=2km", "vary.place_x", "mm, cm, m or %"),
    ("tilt=1%", "vary.tilt", "deg or rad"),
    ("tilt=91deg", "vary.tilt", "0 to 1.5708 [rad]"),
    ("mass=0:1", "vary.mass", "0.01 to 100"),
    ("softness=0.5", "vary.softness", "1 to 200"),
    ("outline_scale=3", "vary.outline_scale", "0.5 to 2"),
    ("outline_noise=6%", "vary.outline_noise", "0 to 0.205244 [mm] (0% to 5% of the diameter)"),
    ("outline_noise=normal:1%", "vary.outline_noise", "truncated:MEAN:SD:LOW:HIGH"),
    ("linkage_play=-1:1", "vary.linkage_play", "0 to 0.410488 [mm] (0% to 10% of the diameter)"),
    ("linkage_play=1e9", "vary.linkage_play", "found 1e+09 to 1e+09; 0 to 0.410488 [mm]"),
    ("linkage_play=normal:0.1%", "vary.linkage_play", "truncated:MEAN:SD:LOW:HIGH"),
    ("com_x=1e6", "vary.com_x", "-4.10488 to 4.10488 [mm] (-100% to 100% of the diameter)"),
    ("com_y=-1:101%", "vary.com_y", "-4.10488 to 4.10488 [mm]"),
    ("com_y=normal:26%", "vary.com_y", "four standard deviations reach from -4.26907 to 4.26907"),
    ("place_x=1e9", "vary.place_x", "-41.0488 to 41.0488 [mm] (-1000% to 1000%"),
    ("place_sigma=0:11m", "vary.place_sigma", "-41.0488 to 41.0488 [mm]"),
    ("place_xy=normal:300%", "vary.place_x", "-41.0488 to 41.0488 [mm]"),
    ("bias_y=1001%", "vary.bias_y", "-41.0488 to 41.0488 [mm]"),
    ("bias_theta=361deg", "vary.bias_theta", "-6.28319 to 6.28319 [rad]"),
    ("finger_radius=101%", "vary.finger_radius", "-4.10488 to 4.10488 [mm]"),
    ("phi_1=2", "vary.phi_1", "-0.5 to 0.5 [rad]"),
    ("phi_2=normal:8deg", "vary.phi_2", "-0.5 to 0.5 [rad]"),
    ("finger_radius=-0.2:0", "vary.finger_radius", "-0.102211 mm or more"),
    ("finger_radius=-0.1026", "vary.finger_radius", "-0.102211 mm or more"),
    ("finger_radius=normal:0.01", "vary.finger_radius", "use truncated"),
    ("friction", "--vary", "NAME=DISTRIBUTION"),
    ("friction=", "--vary", "NAME=DISTRIBUTION"),
    ("=0:1", "--vary", "NAME=DISTRIBUTION"),
]


def refused(capsys: Any, folder: Path, *arguments: str) -> str:
    """The one line of a study that may not begin; nothing is written."""
    before = sorted(folder.rglob("*"))
    line = here(capsys, "study", *arguments, "--out", str(folder / "out")).error_line()
    assert sorted(folder.rglob("*")) == before
    return line


@pytest.mark.parametrize(("text", "field", "allowed"), BAD_VARY)
def test_a_bad_input_gets_one_line(
    text: str, field: str, allowed: str, tmp_path: Path, capsys: Any
):
    case = write_case(CASE, tmp_path / "t.json")
    line = refused(capsys, tmp_path, str(case), "--vary", text)
    assert line.startswith(field)
    assert allowed in line


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--vary", "friction=0:1", "--vary", "friction=0:2"], ["friction", "twice"]),
        (["--vary", "place_xy=normal:1", "--vary", "place_x=1"], ["vary.place_x", "twice"]),
        (["--vary", "bias_y=1", "--vary", "bias_xy=normal:1"], ["vary.bias_xy", "bias_y", "twice"]),
        (["--trials", "0"], ["--trials", "1 to 10000000"]),
        (["--trials", "1e3"], ["--trials", "1 to 10000000"]),
        (["--seed", "-1"], ["--seed", "0 to"]),
        (["--grasp", "2"], ["grasp is 2", "one grasp"]),
        (["--starts", "here"], ["starts", "guaranteed, cage, nominal"]),
        (["--sampling", "latin"], ["sampling", "random, sobol, saltelli"]),
        (["--uncaged", "no"], ["uncaged", "close, skip"]),
        (["--nominal", "1,2,3"], ["--nominal", "X,Y,THETA,SIGMA"]),
        (["--nominal", "1,2,3,nan"], ["--nominal", "finite"]),
        (["--nominal=1,2,3,-1"], ["nominal", "above 0"]),
        (["--nominal", "1e9,29,1.05,90"], ["nominal: finger", "41.0488 mm, 10 diameters"]),
        (["--nominal", "0,0,0,100"], ["nominal: finger 2", "41.0488 mm, 10 diameters"]),
        (["--nominal", "1,2,3,1", "--starts", "cage"], ["nominal", "starts = 'cage'"]),
        (["--place", "here"], ["place", "best"]),
        (["--place", "best", "--starts", "cage"], ["place", "starts = 'cage'"]),
        (["--place", "best", "--nominal", "25,29,1.05,90"], ["place and nominal"]),
        (["--until-half-width", "0.6"], ["until_half_width", "up to 0.5"]),
        (["--until-half-width", "0.1", "--sampling", "sobol"], ["until_half_width", "random"]),
        (["--position-tolerance", "1"], ["position_tolerance", "up to 0.5"]),
        (["--angle-tolerance", "inf"], ["--angle-tolerance", "finite"]),
        (["--max-time", "0"], ["--max-time", "above 0"]),
        (["--time-step", "0.03"], ["time_step", "up to 0.02"]),
        (["--sampling", "saltelli", "--vary", "mass=grid:1,2"], ["vary.mass", "use a range"]),
        (["--sampling", "saltelli", "--starts", "nominal"], ["saltelli", "at least one variable"]),
    ],
)
def test_a_bad_option_gets_one_line(
    options: list[str], words: list[str], tmp_path: Path, capsys: Any
):
    case = write_case(CASE, tmp_path / "t.json")
    line = refused(capsys, tmp_path, str(case), *options)
    for word in words:
        assert word in line


BAD_TOML = [
    ("trial = 3", ["'trial'", "case, grasp, trials"]),
    ("out = 'x'", ["'out'", "case, grasp, trials"]),
    ("trials = 3.5", ["trials", "whole number"]),
    ("trials = '3'", ["trials", "whole number"]),
    ("trials = true", ["trials", "whole number"]),
    ("trials = 0", ["trials", "1 to 10000000"]),
    ("trials = 10000001", ["trials", "1 to 10000000"]),
    ("seed = -1", ["seed", "0 to"]),
    ("grasp = 1.0", ["grasp", "whole number"]),
    ("grasp = true", ["grasp", "whole number"]),
    ("starts = 3", ["starts", "a word"]),
    ("max_time = '5'", ["max_time", "finite number"]),
    ("max_time = nan", ["max_time", "finite number"]),
    ("angle_tolerance = inf", ["angle_tolerance", "finite number"]),
    ("position_tolerance = 0.0", ["position_tolerance", "more than 0"]),
    (f"max_time = 1{'0' * 400}", ["max_time", "finite number"]),
    (f"trials = 1{'0' * 5000}", ["study.toml", "not TOML"]),
    ("until_half_width = true", ["until_half_width", "finite number"]),
    ("nominal = [1, 2, 3]", ["nominal", "four finite numbers"]),
    ("nominal = [1, 2, 3, 'a']", ["nominal", "four finite numbers"]),
    ("nominal = [1, 2, 3, inf]", ["nominal", "four finite numbers"]),
    ("nominal = 3", ["nominal", "four finite numbers"]),
    ("place = 3", ["place", "a word"]),
    ("place = 'roomiest'", ["place", "best"]),
    ("vary = 3", ["vary", "table"]),
    ("[vary]\nfriction = [0, 1]", ["vary.friction", "neither a number nor a distribution"]),
    ("[vary]\nfriction = true", ["vary.friction", "neither a number nor a distribution"]),
    ("[vary.friction]\nlow = 0", ["vary.friction", "neither a number nor a distribution"]),
    ("[vary]\nfriction = nan", ["vary.friction", "finite"]),
    ("[vary]\nfriction = -inf", ["vary.friction", "finite"]),
    (f"[vary]\nfriction = 1{'0' * 400}", ["vary.friction", "finite"]),
    ("[vary]\nfriktion = 1", ["vary.friktion", "known are"]),
    ("[vary]\nplace_xy = 'normal:1'\nplace_y = 3", ["place_y", "twice"]),
    ("[vary]\nfriction = 1\nfriction = 2", ["study.toml", "not TOML"]),
    ("sampling = 'saltelli'\n[vary]\nmass = 'grid:1,2'", ["vary.mass", "use a range"]),
    ("case = 'other.json'", ["study.toml", "not TOML"]),
    ("what", ["study.toml", "not TOML"]),
    (f"vary = {'[' * 3000}", ["study.toml", "not TOML"]),
]  # fmt: skip


@pytest.mark.parametrize(("text", "words"), BAD_TOML, ids=[text[:30] for text, _ in BAD_TOML])
def test_a_bad_file_gets_one_line(text: str, words: list[str], tmp_path: Path, capsys: Any):
    write_case(CASE, tmp_path / "t.json")
    file = tmp_path / "study.toml"
    file.write_text(f"case = 't.json'\n{text}\n")
    line = refused(capsys, tmp_path, str(file))
    for word in words:
        assert word in line


def test_a_file_that_is_no_text_or_not_there_gets_one_line(tmp_path: Path, capsys: Any):
    file = tmp_path / "study.toml"
    assert "study.toml" in refused(capsys, tmp_path, str(file))
    file.write_bytes(b"\xff\xfe\x00")
    assert "not TOML" in refused(capsys, tmp_path, str(file))
    file.write_text("trials = 3\n")
    assert "CASE is needed" in refused(capsys, tmp_path, str(file))
    file.write_text("case = 3\n")
    assert "a word is needed" in refused(capsys, tmp_path, str(file))
    file.write_text("# " + "x" * 1_000_001)
    assert "larger than" in refused(capsys, tmp_path, str(file))


def test_a_case_that_is_not_there_gets_one_line(tmp_path: Path, capsys: Any):
    assert "no.json" in refused(capsys, tmp_path, str(tmp_path / "no.json"))
    assert "pliers has grasps 1 to" in refused(capsys, tmp_path, "pliers", "--grasp", "99")
    assert "CASE is needed" in refused(capsys, tmp_path)
    assert "--out DIR is needed" in here(capsys, "study", "pliers").error_line()


def test_a_file_and_the_command_line_add_up(tmp_path: Path):
    write_case(CASE, tmp_path / "t.json")
    file = tmp_path / "study.toml"
    file.write_text(
        "case = 't.json'\ntrials = 50\nseed = 3\nstarts = 'cage'\n"
        "[vary]\nfriction = '0:0.8'\nmass = 2\n"
    )
    assert read_toml(file)["trials"] == 50
    given = {"case": str(file), "seed": 4, "vary": {"friction": "0.1", "tilt": "0:5deg"}}
    session = session_of(given, str(tmp_path / "out"), False, 10)
    found = session.study.config
    assert (found.trials, found.seed, found.starts) == (50, 4, "cage")
    assert found.vary["friction"] == Distribution("fixed", (0.1,))
    assert found.vary["mass"] == Distribution("fixed", (2.0,))
    assert found.vary["tilt"].parameters == (0.0, np.deg2rad(5.0))
    assert not (tmp_path / "out").exists()


def test_errors_of_the_angles_must_leave_a_triangle():
    """Also together: planned are 9.5 and 39.5 degrees, 20 and -15 more leave no angle between."""
    thin = read_case(CASES / "tunnel_golden.json")

    def check(**vary: str) -> None:
        study_config({"case": "thin", "vary": vary}, thin)

    for good in ({"phi_1": "0:20deg"}, {"phi_2": "-15deg:15deg"}, {"phi_1": "normal:0:1deg"}):
        check(**good)
    with pytest.raises(InputError, match=r"vary.phi_1: errors of -10 and 0 degrees .* 0 < phi_1"):
        check(phi_1="-10deg:5deg")
    with pytest.raises(InputError, match=r"phi = \(9.5, 39.5\) degrees, leave no triangle"):
        check(phi_1="normal:3deg")
    with pytest.raises(InputError, match=r"vary.phi_1 and vary.phi_2: errors of 20 and -15 deg"):
        check(phi_1="0:20deg", phi_2="-15deg:0.1deg")


def test_errors_of_point_fingers_are_those_of_the_discs_they_become(tmp_path: Path, capsys: Any):
    case = str(CASES / "T_best.json")
    given = {"case": case, "vary": {"finger_radius": "-1%:1%"}}
    study = session_of(given, str(tmp_path / "out"), False, 10).study
    assert study.case.finger_radius > 0.0
    assert "vary.finger_radius" in refused(capsys, tmp_path, case, "--vary", "finger_radius=-3%:0")


@pytest.mark.parametrize(
    ("kind", "parameters"),
    [
        ("uniform", (1.0, 1.0)),
        ("uniform", (np.nan, 1.0)),
        ("normal", (0.0, 0.0)),
        ("normal", (0.0, np.inf)),
        ("truncated", (0.0, 1.0, 2.0, 1.0)),
        ("truncated", (0.0, 1.0, 50.0, 60.0)),
        ("grid", ()),
        ("grid", (0.0, np.inf)),
        ("fixed", (1e101,)),
    ],
)
def test_no_bad_distribution_can_be_made(kind: Any, parameters: tuple[float, ...]):
    with pytest.raises(DistributionError):
        Distribution(kind, parameters)


def test_help_says_what_is_not_obvious():
    assert "rounds its base points up to a power of two" in HELP["trials"]
    assert "random sampling only" in HELP["until_half_width"]
    assert all("..." not in one.help for one in VARIABLES.values())


def test_a_config_checks_itself_whoever_makes_it():
    with pytest.raises(ConfigError, match="trials"):
        StudyConfig("T", trials=0)
    assert issubclass(ConfigError, InputError)
