"""``icage escape``: levels, verdicts, the document; and that planted faults are found."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from experiments.cases.with_discs import PhysicalCase, physical_case
from experiments.escape.document import escape_table
from experiments.escape.run import AttackResult, Escape, at, judged
from experiments.escape.setup import AttackSetup
from icage.formats.case_json import read_case
from models import CASES
from sim.attack.guided import GuidedDriver, GuidedPull
from sim.attack.held import ESCAPED, HELD, Attacks, attack
from sim.attack.measured_sigma_max import Measured
from tests.experiments.commands.runner import here
from tests.experiments.small import cage_of, t_case, write_case


def silent(stage: str, done: int, total: int) -> None:
    assert 0 <= done <= total, stage


def test_levels():
    assert at(2.0, 1.0, -1) == pytest.approx(1.996)
    assert at(2.0, 1.0, 1) == pytest.approx(2.004)
    assert at(1.001, 1.0, -1) == pytest.approx(1.0009)


def faked(**changed: Any) -> Escape:
    """Attacks on the T that went as planned, with changes: escapes, depth, interval."""
    case, cage = t_case(), cage_of("T")
    assert cage.sigma_max is not None
    unit = case.outline.diameter
    top = cage.sigma_max / unit
    kind = changed.get("attacker", "guided")

    def run(out: int, level: float) -> Attacks:
        ending = np.where(np.arange(20) < out, ESCAPED, HELD)
        deep = np.full(20, changed.get("depth", 1e-4))
        return Attacks(
            np.full(20, level), ending, np.ones(20, dtype=np.int64), deep, np.ones(20),
            np.zeros((20, 6)),
        )  # fmt: skip

    low, high = changed.get("interval", (0.9999, 1.0001))
    found = Measured(low * top, high * top, high * top, 9, 9, 18, 1e-4, 1.0)
    result = AttackResult(
        kind, run(changed.get("below", 0), top), run(changed.get("above", 20), top), found
    )
    above = at(cage.sigma_max, cage.sigma_0, 1)
    physical = PhysicalCase.of(case, cage)
    return Escape(physical, 20, 0, below=0.0, above=above, attackers=(result,))


def test_what_goes_as_planned_is_ok():
    assert judged(faked()).verdict == "ok"
    assert judged(faked(above=19)).verdict == "ok"
    assert judged(faked(attacker="random", above=0, interval=(1.03, np.inf))).verdict == "ok"


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"below": 1}, "1 of 20 escaped below sigma_max"),
        ({"attacker": "random", "below": 2}, "random attacks: 2 of 20 escaped below"),
        ({"above": 18}, "only 18 of 20 escaped above"),
        ({"interval": (0.98, 0.99)}, "at most"),
        ({"attacker": "random", "interval": (0.98, 0.99)}, "at most"),
        ({"interval": (1.01, 1.02)}, "at least"),
        ({"interval": (1.01, np.inf)}, "at least"),
    ],
)
def test_every_fault_fails(changed: dict[str, Any], words: str):
    result = judged(faked(**changed))
    assert result.verdict == "failed"
    assert any(words in sentence for sentence in result.failures)


def test_the_head_of_the_table_names_the_bound_that_is_computed():
    done = judged(faked())
    assert done.cage.sigma_max is not None
    setup = AttackSetup.of(done.physical, 0.99 * done.cage.sigma_max, 1)
    _says_which_bound("\n".join(escape_table(replace(done, setup=setup))))


def _says_which_bound(told: str) -> None:
    assert "exact one-sided bound, Clopper-Pearson" in told
    assert "Wilson" not in told


def test_a_cage_thinner_than_the_penetration_is_not_judged():
    result = judged(faked(below=3, depth=0.02))
    assert result.verdict == "too_thin_for_physics"
    assert "20 times the penetration of 0.02" in str(result.why)
    assert not result.failures


def test_not_a_cage_is_not_attacked(tmp_path: Path, capsys: Any):
    out = tmp_path / "answer.json"
    result = here(capsys, "escape", str(CASES / "rectangle_notcage.json"), "--json", str(out))
    assert result.code == 0
    assert "not_a_cage" in result.out
    document = json.loads(out.read_text())
    assert (document["format"], document["verdict"]) == ("icage-escape/1", "ok")
    assert (document["plan_verdict"], document["attackers"]) == ("not_a_cage", {})


def test_bad_input(tmp_path: Path, capsys: Any):
    case = write_case(t_case(), tmp_path / "t.json")
    assert "--attacks" in here(capsys, "escape", str(case), "--attacks", "0").error_line()
    assert "input" in here(capsys, "escape", str(case), "--json", str(case)).error_line()
    assert "does not exist" in here(capsys, "escape", "nothing").error_line()


@pytest.mark.slow
@pytest.mark.first
def test_the_command_on_the_t(tmp_path: Path, capsys: Any):
    case = write_case(t_case(), tmp_path / "t.json")
    out = tmp_path / "answer.json"
    # one thread: two that wait for each other at every step ask for twice the processor seconds
    few = ("--attacks", "2", "--threads", "1")
    result = here(capsys, "escape", str(case), *few, "--json", str(out))
    assert result.code == 0, result
    _says_which_bound(result.out)
    document = json.loads(out.read_text())
    assert document["verdict"] == "ok"
    for name in ("random", "guided"):
        assert document["attackers"][name]["below"]["escapes"] == 0
        assert document["attackers"][name]["below"]["attacks"] == 2
    guided = document["attackers"]["guided"]
    assert guided["above"]["escapes"] == 2
    top = document["sigma_max"]
    assert guided["measured"]["low"] == pytest.approx(top, rel=5e-4)
    assert guided["measured"]["high"] == pytest.approx(top, rel=5e-4)
    assert document["penetration_max"] < 1e-3 * document["diameter"]


@pytest.mark.slow
def test_a_second_attempt_comes_through_a_narrow_pass():
    """Number 1 of these was knocked back at the pass before the hand was wide open, and wedged.

    The pass is narrow indeed: the hand is open by 6e-5 more than the object needs.
    """
    physical = physical_case(read_case(CASES / "Z_twofold_multi.json"))
    cage, unit = physical.cage, physical.case.outline.diameter
    assert cage.sigma_max is not None
    assert cage.sigma_max_upper is not None
    setup = AttackSetup.of(physical, at(cage.sigma_max, cage.sigma_0, -1), 1)
    assert setup.path is not None
    starts = np.repeat(setup.target[None, :], 8, axis=0)

    def attacked_at(level: float, stream: int, retries: int) -> Attacks:
        openings, rng = np.full(8, level / unit), np.random.default_rng([0, 5]).spawn(9)[stream]
        pull = GuidedPull(retries=retries)
        driver = GuidedDriver(setup.scene, openings, setup.path, rng, pull)
        return attack(setup.scene, setup.model, starts, openings, driver, 1)

    above = 0.97 * cage.sigma_max_upper + 0.03 * at(cage.sigma_max_upper, cage.sigma_0, 1)
    once, again = attacked_at(above, 4, 0), attacked_at(above, 4, GuidedPull().retries)
    free = np.array([0, 2, 3, 4, 5, 6, 7])
    assert once.ending[1] == HELD
    assert (once.ending[free] == ESCAPED).all()
    assert again.escapes == 8
    assert np.array_equal(once.end[free], again.end[free])  # what was never stuck is what it was
    assert np.array_equal(once.steps[free], again.steps[free])
    assert attacked_at(at(cage.sigma_max, cage.sigma_0, -1), 3, GuidedPull().retries).escapes == 0
