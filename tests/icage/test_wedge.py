"""Wedges: guarantees that only an exact fit holds."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
import pytest
import shapely

import icage
from icage.cage import Cage
from icage.cells.moved_walls import with_walls_moved
from icage.errors import GraspError
from icage.formats.plan_json import plan_document, plan_summary
from icage.geometry.exterior import exterior_pieces
from icage.grasps.planned import WEDGED, planned_grasps
from icage.grasps.wanted import Wanted
from icage.hand import HandShape
from icage.outline import Outline
from icage.planner import plan
from icage.sampling import SamplingError, draw_starts
from icage.wedge import Wedge, WedgeKind
from models import CASES
from tests.oracles.geometry import Ring
from tests.oracles.planar_closing import close_hand


class Asked(NamedTuple):
    """An outline, finger centres, the fingers' radius."""

    ring: tuple[tuple[float, float], ...]
    contacts: tuple[tuple[float, float], ...]
    radius: float


HOOK = ((5, 1), (5, 3), (1, 3), (1, 2), (0, 2), (0, -1), (1, -1), (1, 0), (3, 0), (3, -2), (4, -2),
        (4, 0), (5, 0))  # fmt: skip
"""With a slot of width 2 that opens downwards."""

SLANTED = Asked(
    HOOK,
    ((2.8160044180567465, -0.18683041755571828), (1.1898455957810574, 3.183995581943254),
     (1.1839955819432537, -0.1839955819432535)),
    0.1839955819432536,
)  # fmt: skip
"""A side slanted in the slot that is as wide as it, but for 2e-6."""


def flush(radius: float) -> Asked:
    """Two fingers fill the slot from wall to wall at its bottom, the third is square to them."""
    ring = ((5, 3), (0, 3), (0, -1), (1, -1), (1, 0), (3, 0), (3, -2), (5, -2))
    left, right, low = 1.0 + radius, 3.0 - radius, -radius
    return Asked(ring, ((right, low), (left, 3.0 + radius), (left, low)), radius)


THIN = Asked(
    ((2, 0), (4, 0), (4, -2), (5, -2), (5, 2), (1, 2), (1, 3), (-1, 3), (-1, 0), (-4, 0), (-4, -4),
     (0, -4), (0, -1), (1, -1), (1, 0)),
    ((1.7041149378963143, -0.13695903229736966), (-1.13695903229737, 0.13695903229736983),
     (0.1369590322973696, -1.6034529842632672)),
    0.13695903229736972,
)  # fmt: skip
"""A way out that is closed by a hundred-thousandth."""

NOTHING_LEFT = {
    "slanted": (SLANTED, WedgeKind.THICKER),
    "flush": (flush(0.2), WedgeKind.THICKER),
    "flush points": (flush(0.0), WedgeKind.THICKER),
}


@cache
def planned(asked: Asked) -> Cage:
    return plan(Outline(np.array(asked.ring, dtype=np.float64)), asked.contacts, asked.radius)


def wedge_in(cage: Cage) -> Wedge:
    assert cage.wedge is not None
    return cage.wedge


@pytest.mark.parametrize("name", NOTHING_LEFT)
def test_nothing_is_guaranteed_of_what_an_exact_fit_holds(name: str) -> None:
    asked, kind = NOTHING_LEFT[name]
    cage = planned(asked)
    wedge = wedge_in(cage)
    assert wedge.kind == kind
    assert wedge.sigma == cage.sigma_guaranteed == cage.sigma_0
    assert cage.sigma_first is not None
    assert cage.sigma_first > 1.2 * cage.sigma_0
    with pytest.raises(SamplingError, match="exact fit"):
        draw_starts(cage, "guaranteed", 3, np.random.default_rng(0))
    with pytest.raises(GraspError, match="exact fit"):
        icage.place(cage)
    assert cage.query(cage.target_placement).verdict == "caged"


@pytest.mark.parametrize("name", NOTHING_LEFT)
def test_the_search_does_not_rank_it(name: str) -> None:
    asked, _ = NOTHING_LEFT[name]
    outline, contacts = planned(asked).outline, planned(asked).contacts
    found = planned_grasps(outline, asked.radius, [contacts], Wanted(), 1)
    assert found.cages == ()
    assert [failure.why for failure in found.failures] == [WEDGED]
    assert len(planned_grasps(outline, asked.radius, [contacts], Wanted(aim="cage"), 1).cages) == 1


@pytest.mark.parametrize("change", [1e-6, 1e-7])
def test_fingers_a_hair_thicker_end_elsewhere(change: float) -> None:
    """By an exact closing that knows no cells, from placements of the target's component."""
    cage = planned(SLANTED)
    size = cage.outline.diameter
    rows = draw_starts(cage, "cage", 3, np.random.default_rng(1)).placements
    for row in rows:
        w = row[3] * np.exp(1j * row[2])
        at = np.array([row[0], row[1], w.real, w.imag])
        ends = [
            close_hand(Ring.of(cage.outline.vertices), cage.hand.z, at, cage.finger_radius + by)
            for by in (-change * size, change * size)
        ]
        off = [np.hypot(*(end.contacts - cage.contacts).mean(axis=0)) / size for end in ends]
        assert off[0] < 0.005
        assert off[1] > 0.1
        assert ends[1].sigma > 1.4 * cage.sigma_0


def test_a_thin_way_out_caps_the_guaranteed_set_where_it_opens() -> None:
    cage = planned(THIN)
    wedge = wedge_in(cage)
    assert wedge.kind == WedgeKind.THINNER
    assert cage.sigma_first is not None
    assert cage.sigma_0 < wedge.sigma < 0.9 * cage.sigma_first
    thinner = plan(cage.outline, regrasped(cage, -wedge.fit), cage.finger_radius - wedge.fit)
    assert wedge.sigma == pytest.approx(thinner.sigma_max, rel=1e-5)
    starts = draw_starts(cage, "guaranteed", 20, np.random.default_rng(0)).placements
    assert (starts[:, 3] < wedge.sigma).all()


def regrasped(cage: Cage, by: float) -> np.ndarray:
    """The same grasp with another radius."""
    case = icage.Case("thin", "m", cage.outline, cage.finger_radius, cage.contacts)
    return icage.regrasp(case, finger_radius=cage.finger_radius + by).contacts


def test_plan_and_summary_tell() -> None:
    for asked in (SLANTED, THIN):
        cage = planned(asked)
        document = plan_document(cage, (), "hook", "m", exact_fit=True)
        assert document["wedge"]["sigma"] == wedge_in(cage).sigma
        assert document["wedge"]["kind"] == wedge_in(cage).kind
        lines = list(plan_summary(cage, "hook", "m", exact_fit=True))
        assert sum(line.startswith("wedge ") for line in lines) == 1


@pytest.mark.parametrize(
    ("scale", "turn", "shift"), [(7.0, 0.0, 0.0), (1.0, 0.7, 0.0), (0.01, 2.0, 3.0)]
)
@pytest.mark.parametrize("asked", [SLANTED, THIN])
def test_moved_copies_have_the_same_wedge(
    asked: Asked, scale: float, turn: float, shift: float
) -> None:
    here = wedge_in(planned(asked))
    z = scale * np.exp(1j * turn)

    def moved(points: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
        there = [complex(*point) * z + complex(shift, -shift) for point in points]
        return tuple((one.real, one.imag) for one in there)

    there = wedge_in(planned(Asked(moved(asked.ring), moved(asked.contacts), scale * asked.radius)))
    assert there.kind == here.kind
    assert there.sigma == pytest.approx(scale * here.sigma, rel=1e-6)


GOOD = sorted(path.stem for path in CASES.glob("*.json"))


@pytest.mark.parametrize("name", ["pliers", "saw", "wrench", *GOOD])
def test_shipped_cases_hang_on_no_exact_fit(name: str) -> None:
    cage = plan(icage.load(name if name not in GOOD else CASES / f"{name}.json"))
    assert cage.wedge is None
    assert "wedge" not in plan_document(cage, (), name, "m", exact_fit=True)
    if cage.shelf is None:
        assert cage.sigma_guaranteed == cage.sigma_first


@pytest.mark.parametrize("by", [-1e-3, 1e-3])
def test_edges_move_by_the_same_and_pieces_keep_their_names(by: float) -> None:
    outline = Outline(np.array(flush(0.0).ring, dtype=np.float64))
    hand = HandShape.from_contacts(np.array(flush(0.0).contacts))
    pieces, origin = exterior_pieces(outline, hand)
    moved = with_walls_moved(pieces, np.full(len(pieces.wall_from), by))
    ring = np.column_stack([moved.x, moved.y])[moved.wall_from] + origin
    grown = outline.polygon.buffer(by, join_style="mitre")
    assert shapely.distance(grown.exterior, shapely.points(ring)).max() < 1e-12
    assert (moved.slot_neighbour == pieces.slot_neighbour).all()
    far = np.hypot(moved.x - pieces.x, moved.y - pieces.y)
    assert far.max() == pytest.approx(abs(by) * 2.0**0.5)
