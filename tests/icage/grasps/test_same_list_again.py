"""The same list from the same seed, for any number of workers, any length, any frame."""

from __future__ import annotations

import numpy as np
import pytest

from icage.errors import InputError
from icage.grasps.search import best_grasps
from icage.grasps.wanted import ANY_HAND, Candidate, Wanted
from icage.outline import Outline
from tests.icage.grasps.small_outlines import SMALL, found
from tests.oracles.polygons import rotated


def same_as(candidate: Candidate) -> tuple[object, ...]:
    return candidate.contacts.tobytes(), candidate.triple, candidate.score, candidate.level


def test_top_is_the_beginning_of_a_longer_list() -> None:
    whole = found("hour glass", "first")
    any_hand = Wanted(limits=ANY_HAND)
    few = best_grasps(
        Outline(SMALL["hour glass"]), top=2, wanted=any_hand, rng=np.random.default_rng(0)
    )
    assert [same_as(c) for c in few] == [same_as(c) for c in whole[:2]]
    with pytest.raises(InputError, match=r"top = 0; at least 1 is needed"):
        best_grasps(Outline(SMALL["triangle"]), top=0, rng=np.random.default_rng(0))


def test_the_same_seed_gives_the_same_list_with_any_number_of_workers() -> None:
    outline = Outline(SMALL["dart"])
    lists = [
        best_grasps(outline, top=5, rng=np.random.default_rng(3), workers=w) for w in (1, 1, 2)
    ]
    first, again, two = ([same_as(c) for c in answer] for answer in lists)
    assert len(first) == 5
    assert again == first
    assert two == first


@pytest.mark.parametrize("name", ["triangle", "dart", "notched", "hour glass"])
@pytest.mark.parametrize("change", ["turned", "moved", "scaled", "rolled", "clockwise"])
def test_the_best_score_does_not_depend_on_frame_unit_or_start(name: str, change: str) -> None:
    """The random steps differ, so the ends of the improvement may, by what it stops at."""
    ring = SMALL[name]
    other = {
        "turned": rotated(ring, 1.0),
        "moved": ring + [30.0, -70.0],
        "scaled": 1e-3 * ring,
        "rolled": np.roll(ring, 2, axis=0),
        "clockwise": ring[::-1],
    }[change]
    any_hand = Wanted(limits=ANY_HAND)
    best = best_grasps(Outline(other), top=1, wanted=any_hand, rng=np.random.default_rng(0))[0]
    assert best.score == pytest.approx(found(name, "first")[0].score, rel=1e-3)
