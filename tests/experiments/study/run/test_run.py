"""``icage study``: the table is the same whatever ran before, in whatever order and pieces."""

from __future__ import annotations

import functools
import itertools
import json
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
import pytest

from experiments.io.intervals import stopped_at
from experiments.io.parquet_files import words_of, write_table
from experiments.study.run import shards as run
from experiments.study.run.folder import StudyFolder
from tests.experiments.commands.runner import here
from tests.experiments.small import t_case, write_case
from tests.experiments.study.studies import TRIALS, Studied, left_alone, no_trials, t_file

_FAST = {("1", "50"), ("2", "7"), ("2", "1000")}
_ALL = itertools.product(("1", "2"), ("7", "50", "1000"))
WAYS = pytest.mark.parametrize(
    ("threads", "shard"),
    [pytest.param(*way, marks=() if way in _FAST else pytest.mark.slow) for way in _ALL],
)


# ---------------------------------------------------------------------------- the same table


@WAYS
def test_threads_and_shards_change_nothing(folder: Path, study: Studied, threads: str, shard: str):
    result = study.run("--threads", threads, "--shard", shard)
    assert result.code == 0, result
    assert "120 of 120 trials (all trials that were asked for)" in result.out
    study.check_same(left_alone(folder))
    assert study.document["found"]["outcomes"]["target"] not in (0, TRIALS)


def test_shards_of_one_trial_have_the_same_columns(folder: Path, study: Studied):
    """Also those that were never closed."""
    assert study.run("--shard", "1", "--trials", "20").code == 0
    assert study.table.equals(left_alone(folder).table.slice(0, 20))
    assert study.document["found"]["outcomes"]["collision"] > 0


@pytest.mark.parametrize("again", ["7", "1000"])
def test_resumed_with_another_shard_size(
    folder: Path, study: Studied, again: str, monkeypatch: pytest.MonkeyPatch
):
    study.broken_off(monkeypatch, 3, "--shard", "17")
    assert not study.document["finished"]
    assert study.resume("--shard", again).code == 0
    study.check_same(left_alone(folder))


def test_interrupted_again_and_again(folder: Path, study: Studied, monkeypatch: pytest.MonkeyPatch):
    study.broken_off(monkeypatch, 2, "--shard", "30", "--threads", "2")
    for shard, kept in (("11", 3), ("9", 1)):
        before = set(study.shards)
        with monkeypatch.context() as inner:
            keep = functools.partial(_keep_then_stop, left=[kept])
            inner.setattr(StudyFolder, "keep", lambda *given, keep=keep: keep(*given))
            assert study.run("--resume", "--shard", shard).code == 130
        assert before < set(study.shards)
    assert study.resume().code == 0
    study.check_same(left_alone(folder))


_KEEP = StudyFolder.keep


def _keep_then_stop(*given: Any, left: list[int]) -> None:
    _KEEP(*given)
    left[0] -= 1
    if left[0] == 0:
        raise KeyboardInterrupt


# ---------------------------------------------------------------------------- finished, or longer


@pytest.mark.parametrize("named", [True, False])
def test_a_finished_study_resumed_changes_nothing(
    study: Studied, named: bool, monkeypatch: pytest.MonkeyPatch
):
    first = study.run("--shard", "50")
    before = study.files
    no_trials(monkeypatch)
    again = study.run("--resume", "--shard", "7") if named else study.resume("--threads", "1")
    assert (again.code, again.out) == (0, first.out)
    assert study.files == before


def test_more_trials_keep_the_first(folder: Path, study: Studied):
    assert study.run("--trials", "50", "--shard", "20").code == 0
    assert study.table.equals(left_alone(folder).table.slice(0, 50))
    assert study.run("--resume", "--shard", "30").code == 0
    study.check_same(left_alone(folder))


def test_more_trials_run_only_what_is_missing(study: Studied, monkeypatch: pytest.MonkeyPatch):
    study.broken_off(monkeypatch, 2, "--trials", "60", "--shard", "20", "--threads", "1")
    asked: list[tuple[int, int]] = []
    real = run.shard_table
    monkeypatch.setattr(run, "shard_table", lambda s, span: (asked.append(span), real(s, span))[1])
    assert study.run("--resume", "--trials", "80", "--shard", "1000").code == 0
    assert asked == [(40, 79)]


def test_more_trials_are_asked_for_without_the_case(folder: Path, study: Studied):
    assert study.run("--trials", "50", "--shard", "20").code == 0
    assert study.resume("--trials", str(TRIALS)).code == 0
    study.check_same(left_alone(folder))
    assert study.document["config"]["trials"] == TRIALS


@pytest.mark.parametrize("named", [True, False])
def test_fewer_trials_throw_nothing_away(
    study: Studied, named: bool, monkeypatch: pytest.MonkeyPatch
):
    again = (lambda *o: study.run("--resume", *o)) if named else study.resume
    assert study.run("--trials", "50").code == 0
    before = study.files
    line = again("--trials", "20").error_line()
    assert "trials is 20, but --out" in line
    assert "holds 50 already" in line
    assert study.files == before
    assert again("--trials", "50").code == 0


def test_fewer_trials_than_the_shards_hold_are_refused(
    study: Studied, monkeypatch: pytest.MonkeyPatch
):
    study.broken_off(monkeypatch, 2, "--trials", "60", "--shard", "20", "--threads", "1")
    before = study.files
    assert "holds 40 already" in study.resume("--trials", "39").error_line()
    assert study.files == before
    assert study.resume("--trials", "40").code == 0  # as many as there are: none is lost
    assert len(study.table) == 40


def test_shards_of_another_study_keep_nobody_from_fewer_trials(
    study: Studied, monkeypatch: pytest.MonkeyPatch
):
    study.broken_off(monkeypatch, 2, "--trials", "60", "--shard", "20", "--threads", "1")
    for path in study.shards:
        pq.write_table(pq.read_table(path).replace_schema_metadata(None), path)
    assert study.resume("--trials", "10").code == 0
    assert len(study.table) == 10


@pytest.mark.parametrize("option", [("--seed", "5"), ("--vary", "mass=2"), ("--max-time", "3")])
def test_anything_else_needs_the_whole_command(study: Studied, option: tuple[str, str]):
    assert study.run("--trials", "20").code == 0
    before = study.files
    line = study.resume("--trials", "40", *option).error_line()
    name = option[0].removeprefix("--").replace("-", "_")
    assert line.startswith(f"{name} is given without a CASE: only trials may be")
    assert "repeat the whole command" in line
    assert study.files == before


def test_a_given_nominal_placement_is_resumed(study: Studied, monkeypatch: pytest.MonkeyPatch):
    nominal = ("--nominal", "2,2.5,0,1.5", "--trials", "20")
    assert study.run(*nominal).code == 0
    no_trials(monkeypatch)
    assert study.resume().code == 0
    assert study.run(*nominal, "--resume").code == 0


def test_a_saltelli_study_is_resumed_from_another_folder(
    study: Studied, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    saltelli = ("--sampling", "saltelli", "--trials", "30")
    varied = ("--vary", "place_x=normal:0.1", "--vary", "place_y=normal:0.1")
    assert study.run(*saltelli, varied=varied).code == 0
    no_trials(monkeypatch)
    monkeypatch.chdir(tmp_path)
    assert study.command("t.json", "--resume", *varied, *saltelli).code == 0
    longer = study.command("t.json", "--resume", *varied, "--sampling", "saltelli")
    assert "trials was 30, is 1000" in longer.error_line()
    assert "trials was 30, is 1000" in study.resume("--trials", "1000").error_line()


# ---------------------------------------------------------------------------- refused


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--seed", "5"), "holds another study: seed was 0, is 5"),
        (("--angle-tolerance", "0.1"), "another study: angle_tolerance was 0.02, is 0.1"),
        (("--vary", "speed=1:2"), "another study: vary was"),
        (("--uncaged", "skip"), "another study: uncaged was 'close', is 'skip'"),
        (("--sampling", "sobol"), "another study: sampling was 'random', is 'sobol'"),
    ],
)
def test_another_config_is_refused(study: Studied, options: tuple[str, ...], words: str):
    assert study.run("--trials", "20").code == 0
    before = study.files
    assert words in study.run("--resume", *options).error_line()
    assert study.files == before


@pytest.mark.parametrize("named", [True, False])
def test_other_versions_are_refused(study: Studied, named: bool):
    assert study.run("--trials", "20").code == 0
    document = study.document
    document["versions"]["mujoco"] = "4.0.7"
    (study.path / "study.json").write_text(json.dumps(document))
    again = study.run("--resume", "--trials", "20") if named else study.resume()
    assert "another study: mujoco was 4.0.7, is" in again.error_line()


def test_other_code_of_the_same_version_is_refused_or_said(study: Studied):
    """Its shards are this study's all the same: nothing is run twice."""
    assert study.run("--trials", "20").code == 0
    before, document = study.table, study.document
    mine, old = document["versions"]["code"], "icage-0000000000 sim-0 experiments-0"
    document["versions"]["code"] = old
    (study.path / "study.json").write_text(json.dumps(document))
    line = study.resume().error_line()
    assert f"another study: code was {old}, is {mine} (--any-code goes on all the same" in line
    assert study.resume("--any-code", "--trials", "25").code == 0
    assert study.table.slice(0, 20).equals(before)
    assert (study.document["versions"]["code"], study.document["other_code"]) == (mine, [old])
    assert (
        f"Rows of other code of the same version were taken: {old}."
        in (study.path / "results.md").read_text()
    )
    assert study.resume("--trials", "30").code == 0  # what was said is said on
    assert study.document["other_code"] == [old]


def test_another_case_is_refused(study: Studied):
    assert study.run("--trials", "20").code == 0
    path, case = t_file(study.path.parent), t_case()
    write_case(case, path, name="another")
    assert "the case was 'T', is 'another'" in study.run("--resume").error_line()
    contacts = (case.contacts + [0.0, 1e-9]).tolist()
    write_case(case, path, grasp={"contacts": contacts})
    assert "the case is another one" in study.run("--resume").error_line()


def test_a_study_is_not_overwritten(study: Studied):
    assert study.run("--trials", "20").code == 0
    before = study.files
    assert "holds a study already; --resume goes on" in study.run().error_line()
    assert study.files == before


def test_nothing_to_resume(study: Studied):
    assert "holds no study to go on with" in study.resume().error_line()
    study.path.mkdir()
    for text in ('{"format": "icage-plan/1"}', '{"format": "icage-study/1"}', "[]", "{"):
        (study.path / "study.json").write_text(text)
        for again in (study.resume(), study.run("--resume")):
            assert again.error_line()
    assert list(study.files) == ["study.json"]


# ---------------------------------------------------------------------------- early stop


@pytest.fixture
def often(monkeypatch: pytest.MonkeyPatch) -> None:
    """Looks every 20 trials: a study of 120 stops by itself after 80."""
    looks = functools.partial(stopped_at, look_every=20, at_least=20)
    monkeypatch.setattr(run, "stopped_at", looks)


STOP = ("--until-half-width", "0.075")


def check_stopped(study: Studied, whole: Studied) -> None:
    assert study.table.equals(whole.table.slice(0, 80))
    stopped = {"early": True, "at": 80, "why": "the half width is at most 0.075"}
    assert study.document["stopped"] == stopped
    assert not (study.path / "shards").exists()


@WAYS
def test_it_stops_at_the_same_trial(
    folder: Path, study: Studied, threads: str, shard: str, often: None
):
    result = study.run(*STOP, "--threads", threads, "--shard", shard)
    assert "80 of 120 trials (the half width is at most 0.075)" in result.out
    check_stopped(study, left_alone(folder))


def test_it_stops_at_the_same_trial_when_resumed(
    folder: Path, study: Studied, often: None, monkeypatch: pytest.MonkeyPatch
):
    study.broken_off(monkeypatch, 2, *STOP, "--shard", "9", "--threads", "2")
    assert study.resume("--shard", "50").code == 0
    check_stopped(study, left_alone(folder))
    no_trials(monkeypatch)
    assert study.resume("--shard", "7").code == 0
    check_stopped(study, left_alone(folder))


def test_a_stopped_study_goes_on_if_asked(folder: Path, study: Studied, often: None):
    """And one that ran further than it needed to stops where it would have."""
    assert study.run(*STOP, "--shard", "50").code == 0
    assert study.run("--resume", "--shard", "13").code == 0
    study.check_same(left_alone(folder))
    assert study.run(*STOP, "--resume").code == 0
    check_stopped(study, left_alone(folder))


def test_it_says_that_it_could_not_stop(study: Studied, often: None):
    result = study.run("--until-half-width", "0.01", "--trials", "40")
    assert "40 of 40 trials (all trials that were asked for; the half width is not" in result.out
    assert not study.document["stopped"]["early"]


def test_stopping_at_the_last_trial_is_not_early(study: Studied, often: None):
    result = study.run(*STOP, "--trials", "80")
    why = "all trials that were asked for; the half width is at most 0.075"
    assert f"80 of 80 trials ({why})" in result.out
    assert study.document["stopped"] == {"early": False, "at": 80, "why": why}


# ---------------------------------------------------------------------------- nominal placement


@pytest.mark.parametrize(
    ("nominal", "words"),
    [("-0.1,1,0,0.2", "in collision with the object"), ("38,0,0.2,2", "not caged")],
)
def test_a_nominal_placement_outside_the_cage_is_told(study: Studied, nominal: str, words: str):
    result = study.run(f"--nominal={nominal}", "--trials", "2", varied=())
    assert f"nominal placement: {words}\n" in result.out
    assert result.err == (
        f"icage: warning: the nominal placement is not in the target's cage: {words}\n"
    )
    assert not study.document["nominal"]["in_cage"]
    assert words in (study.path / "results.md").read_text()


def test_a_nominal_placement_in_the_cage_has_a_margin(study: Studied):
    result = study.run("--trials", "2", varied=("--vary", "place_x=0.01"))
    one = study.document["nominal"]
    assert one["in_cage"]
    words = f"only in the target; the hand may open by {one['margin']:.4g} mm before the object"
    assert words in result.out
    assert result.err == ""
    page = (study.path / "results.md").read_text()
    assert words in page


# ---------------------------------------------------------------------------- run again


@pytest.mark.parametrize("finished", [True, False])
def test_every_trial_is_run_again_from_its_number(
    study: Studied, finished: bool, monkeypatch: pytest.MonkeyPatch, capsys: Any
):
    if finished:
        assert study.run("--trials", "40").code == 0
    else:
        study.broken_off(monkeypatch, 2, "--shard", "20", "--threads", "1")
    verdicts = set()
    for index in (0, 3, 5, 20, 39):
        result = here(capsys, "replay-trial", str(study.path), str(index), "--json", "-")
        answer = json.loads(result.out)
        assert (result.code, answer["identical"], answer["differences"]) == (0, True, [])
        assert answer["format"] == "icage-replay-trial/1"
        assert answer["index"] == answer["recorded"]["trial"] == index
        assert answer["outcome"] == answer["recorded"]["outcome"]
        verdicts.add(answer["outcome"])
    assert verdicts == {"target", "collision"}
    told = here(capsys, "replay-trial", str(study.path), "3")
    assert "record       the same to the last bit" in told.out
    beyond = here(capsys, "replay-trial", str(study.path), "40")
    assert "has no trial 40; it has 40, counted from 0" in beyond.error_line()


def test_a_false_record_is_told(study: Studied, capsys: Any):
    assert study.run("--trials", "5").code == 0
    path = study.path / "trials.parquet"
    table = pq.read_table(path)
    steps = table["steps"].to_pylist()
    at = table.column_names.index("steps")
    other = table.set_column(at, "steps", [[steps[0] + 1, *steps[1:]]])
    write_table(other, path, words_of(table))
    result = here(capsys, "replay-trial", str(study.path), "0")
    assert result.code == 1
    assert "same versions, but steps differ" in result.err
