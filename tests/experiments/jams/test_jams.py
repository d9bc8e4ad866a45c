"""``python -m experiments.jams``: what holds passes, planted faults are found, the page says so."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from experiments.cases.with_discs import PhysicalCase
from experiments.jams import run
from experiments.jams.closings import close_from, draw, gentler
from experiments.jams.document import jams_document, page
from experiments.jams.many import judge_many
from experiments.jams.run import Judged, judge, limiting
from experiments.jams.settings import CHANGED, change
from icage.case import Case
from icage.formats.case_json import read_case
from icage.formats.json_out import json_text
from icage.friction.levels import FrictionLevel, friction_levels
from icage.planner import plan
from models import CASES
from sim.grip.stick import RUBBING


@pytest.fixture(scope="module")
def hammer() -> PhysicalCase:
    case = read_case(CASES / "disc_hammer.json")
    return PhysicalCase.of(case, plan(case.outline, case.contacts, case.finger_radius))


@pytest.fixture(scope="module")
def judged(hammer: PhysicalCase) -> Judged:
    return judge("hammer", hammer, 8, 4, mus=(0.02, 0.3))


def test_what_is_foretold_holds(judged: Judged) -> None:
    assert judged.failures == ()
    assert {(one.side, one.mu) for one in judged.ends} == {
        (side, mu) for side in ("below", "above") for mu in (0.02, 0.3)
    }
    above = [one for one in judged.ends if one.side == "above"]
    assert all((~one.in_target).any() and one.from_afar.all() for one in above)
    assert judged.jams
    assert all(abs(jam.off) < 0.05 for jam in judged.jams)


def test_a_level_without_friction_is_found_wrong(
    hammer: PhysicalCase, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = hammer.cage.sigma_first

    def wrong(cage: object, mus: tuple[float, ...]) -> tuple[FrictionLevel, ...]:
        found = friction_levels(hammer.cage, mus)
        return tuple(replace(level, sigma_first=first, jam=None) for level in found)

    monkeypatch.setattr(run, "friction_levels", wrong)
    failures = judge("hammer", hammer, 8, 4, mus=(0.1,)).failures
    assert any("closings from below sigma_first(0.1) ended in the target" in f for f in failures)


def test_an_end_where_nothing_holds_is_found(judged: Judged) -> None:
    above = next(one for one in judged.ends if one.side == "above")
    off = replace(above, residual=np.where(above.in_target, np.nan, 0.1))
    assert any("where nothing holds" in f for f in replace(judged, ends=(off,)).failures)


def test_a_jam_that_holds_too_soon_is_found(judged: Judged) -> None:
    jam = judged.jams[0]
    early = replace(jam, foretold=1.2 * jam.measured.sticks)
    assert any("is foretold to hold" in f for f in replace(judged, jams=(early,)).failures)


def test_less_friction_than_the_level_was_made_for_has_less_to_fear(hammer: PhysicalCase) -> None:
    """Closings from above a level that end in no jam of half its friction are not called so."""
    level = friction_levels(hammer.cage, (0.3,))[0]
    starts = draw(hammer, level, "above", 8, np.random.default_rng(0))
    ends = close_from(hammer, level, "above", starts)
    weaker = close_from(hammer, replace(level, mu=0.15), "above", ends.ends)
    assert weaker.angle.max() < ends.angle.max()


def test_gentler_closings_are_as_long_as_they_are_slow() -> None:
    slow = gentler(RUBBING)
    assert slow.drive_force * slow.max_time == pytest.approx(RUBBING.drive_force * RUBBING.max_time)


def test_each_jam_once(hammer: PhysicalCase) -> None:
    levels = friction_levels(hammer.cage, (0.1, 0.2, 0.3))
    assert [mus for _, mus in limiting(hammer, levels)] == [(0.1, 0.2, 0.3)]


def test_settings_are_compared_end_by_end(judged: Judged, hammer: PhysicalCase) -> None:
    levels = {level.mu: level for level in judged.levels}
    places = [(jam.jam.placement, jam.foretold, jam.measured.sticks) for jam in judged.jams]
    name = next(iter(CHANGED))
    found = change(name, hammer, places, levels, list(judged.ends))
    assert found.trials == sum(map(len, judged.ends))
    assert found.same >= 0.8 * found.trials
    assert found.stray == 0
    assert all(ratio == pytest.approx(1.0, abs=0.02) for ratio in found.thresholds)


def test_the_document_and_its_page(judged: Judged) -> None:
    document = json.loads(json_text(jams_document([judged], [], [("bar", "not a cage")])))
    lines = list(page(document, "python -m experiments.jams"))
    below = [one for one in judged.ends if one.side == "below"]
    kept = sum(int(one.kept.sum()) for one in below)
    assert kept >= 12
    assert lines[2].startswith(f"**{kept} of {kept}** closings from below")
    assert f"{16 - kept} more began so near to the level" in lines[2]
    assert any(line.startswith("| hammer | 0.3 |") for line in lines)
    assert "- bar: not a cage" in lines
    assert lines[-1] == "    python -m experiments.jams"


def test_what_cannot_be_closed_is_left_out() -> None:
    never: Case = read_case(CASES / "rectangle_notcage.json")
    rows, skipped = judge_many({"never": never}, 4, 2, 0, lambda *_: None)
    assert rows == []
    assert [name for name, _ in skipped] == ["never"]
