"""One candidate evaluated, and the simplex that climbs: by closed forms and by its own rules."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pytest

from icage.cells.free_space import FreeSpace
from icage.grasps.features import features_of, neighbours
from icage.grasps.kernels import climb as module
from icage.grasps.kernels.climb import climb, tried_jobs
from icage.grasps.kernels.evaluate import Sought, Verdict, evaluate
from icage.grasps.kernels.hands import HandLimits
from icage.hand import HandShape
from icage.outline import Outline
from tests.oracles.geometry import Floats

pytestmark = pytest.mark.usefixtures("plain")

ROOT = 3.0**0.5
TRIANGLE = np.array([[0.0, 0.0], [1.0, 0.0], [0.5, 0.5 * ROOT]])
MIDDLES = np.array([[0.5, 0.0], [0.75, 0.25 * ROOT], [0.25, 0.25 * ROOT]])
NONE = np.empty((0, 4))


class Triangle:
    """The regular triangle held at the middles of its sides: sigma_0 is 1/2."""

    def __init__(self, size: float = 1.0) -> None:
        self.size = size
        self.shape = size * TRIANGLE + size * np.array([7.0, -2.0])
        self.contacts = size * MIDDLES + size * np.array([7.0, -2.0])
        outline = Outline(self.shape)
        self.space = FreeSpace.around(outline, HandShape.from_contacts(self.contacts))
        self.limits = HandLimits.apart(1e-3 * size)

    def asked(
        self, contacts: Floats, *, first: bool = False, avoided: Floats = NONE,
        cells: int = 10**6, limits: HandLimits | None = None,
    ) -> tuple:  # fmt: skip
        x, y = contacts.T.copy()
        sought = Sought(first, avoided, 0.01 * self.size, cells)
        ring = self.shape - self.space.origin
        found = evaluate(
            self.space.pieces, self.space.origin, ring, x, y, limits or self.limits, sought
        )
        return (*found, np.column_stack([x, y]))


@pytest.mark.parametrize("size", [1.0, 40.0, 0.03])
@pytest.mark.parametrize("first", [False, True])
def test_the_triangle_by_its_closed_forms(size: float, first: bool) -> None:
    """It opens where a finger passes a corner: sigma = sqrt(3) / 2 of a side."""
    t = Triangle(size)
    verdict, finger, sigma_0, level, cells, at = t.asked(t.contacts, first=first)
    assert verdict == Verdict.CAGE
    assert finger == 0
    assert sigma_0 == pytest.approx(0.5 * size)
    assert level == pytest.approx(0.5 * ROOT * size)
    assert cells > 1
    assert at == pytest.approx(t.contacts, abs=1e-9 * size)
    # the minimum is found from beside it
    near = t.contacts + 1e-7 * size * np.array([[0.0, -1.0], [1.0, 0.0], [-1.0, 0.5]])
    moved = t.asked(near, first=first)
    assert moved[0] == Verdict.CAGE
    assert moved[5] == pytest.approx(t.contacts, abs=1e-6 * size)
    assert moved[3] == pytest.approx(level, rel=1e-5)
    # as far as the hand opens
    most = t.asked(t.contacts, first=first, limits=t.limits._replace(sigma_most=0.7 * size))
    assert (most[0], most[3]) == (Verdict.CAGE, pytest.approx(0.7 * size))
    wide = t.asked(t.contacts, first=first, limits=t.limits._replace(sigma_most=2.0 * size))
    assert wide[3] == pytest.approx(level)


def test_what_is_no_candidate_is_said() -> None:
    t = Triangle()
    nothing = (0, 0.0, 0.0, 0)
    clockwise = t.asked(t.contacts[::-1])
    assert clockwise[:5] == (Verdict.OUTSIDE, *nothing)
    small = t.asked(t.contacts, limits=t.limits._replace(sigma_least=0.6))
    assert small[:5] == (Verdict.OUTSIDE, *nothing)
    for k in range(3):
        beside = np.array([[*(t.contacts[k] - 0.005), *(t.contacts[k] - 1.0)]])
        assert t.asked(t.contacts, avoided=beside)[:5] == (Verdict.OUTSIDE, *nothing)
    far = np.array([[*(t.contacts[0] - 0.02), *(t.contacts[0] - 1.0)]])
    assert t.asked(t.contacts, avoided=far)[0] == Verdict.CAGE
    loose = t.contacts + 0.1 * (t.contacts - t.contacts.mean(axis=0))
    assert t.asked(loose)[:5] == (Verdict.NO_MINIMUM, *nothing)
    broken = t.asked(t.contacts, cells=1)
    assert broken[:2] == (Verdict.BROKEN_OFF, 0)
    assert broken[2] == pytest.approx(0.5)
    assert broken[3] == 0.0
    assert broken[4] == 2
    # two fingers hold a bar; the third one is in the air beside it
    bar = Triangle()
    bar.shape = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [0.0, 1.0]])
    on_bar = np.array([[1.0, 0.0], [2.0, 0.0], [1.5, 1.3]])
    bar.space = FreeSpace.around(Outline(bar.shape), HandShape.from_contacts(on_bar))
    assert bar.asked(on_bar)[:5] == (Verdict.NO_MINIMUM, *nothing)
    along = np.array([[1.0, 0.0], [2.0, 0.0], [1.5, 1.0]])  # a plateau
    bar.space = FreeSpace.around(Outline(bar.shape), HandShape.from_contacts(along))
    assert bar.asked(along)[:5] == (Verdict.NO_MINIMUM, *nothing)


def test_a_finger_in_the_air_beside_two_that_hold_is_no_grasp() -> None:
    """An hourglass squeezed in its waist."""
    glass = Triangle()
    glass.shape = np.array([[-2.0, -2], [2, -2], [0.5, 0], [2, 2], [-2, 2], [-0.5, 0]])
    contacts = np.array([[-0.5, 0.0], [0.5, 0.0], [2.5, 1.0]])
    glass.space = FreeSpace.around(Outline(glass.shape), HandShape.from_contacts(contacts))
    assert glass.asked(contacts)[:5] == (Verdict.NO_MINIMUM, 0, 0.0, 0.0, 0)
    touching = np.array([[-0.5, 0.0], [0.5, 0.0], [1.25, 1.0]])
    glass.space = FreeSpace.around(Outline(glass.shape), HandShape.from_contacts(touching))
    assert glass.asked(touching)[0] == Verdict.CAGE


def test_a_point_is_tried_on_the_features_that_can_use_it() -> None:
    t = Triangle()
    outline = Outline(t.shape)
    features = features_of(outline)
    beside = neighbours(features)
    sought = Sought(False, NONE, 0.01, 10**6)
    ring = t.shape - t.space.origin
    own, x, y = np.empty(3, np.int64), np.empty(3), np.empty(3)
    args = (t.space.pieces, t.space.origin, ring, features, beside, t.limits, sought)
    middle = t.contacts.mean(axis=0)
    found = module.tried(*args, np.array([0, 1, 2]), *middle, own, x, y)
    assert found == t.asked(t.contacts)[:5]
    assert own.tolist() == [0, 1, 2]
    assert np.column_stack([x, y]) == pytest.approx(t.contacts, abs=1e-9)
    far = module.tried(*args, np.array([0, 1, 2]), *(middle + 50.0), own, x, y)
    assert far == (0, 0, 0.0, 0.0, 0)


@pytest.fixture
def hill(monkeypatch: pytest.MonkeyPatch) -> list[tuple[float, float]]:
    """In place of an evaluation a score of the point; returns the points that were tried."""
    seen: list[tuple[float, float]] = []

    def tried(*args: object) -> tuple[int, int, float, float, int]:
        triple, px, py, own, x, y = args[7:13]
        seen.append((px, py))
        own[:] = triple  # type: ignore[index]
        x[:], y[:] = px, py  # type: ignore[index]
        score = SCORE[0](px, py)
        if score <= 0.0:
            return Verdict.NO_CAGE, 1, 1.0, 5.0, 7
        return Verdict.CAGE, 2, 2.0, 2.0 * score, len(seen)

    monkeypatch.setattr(module, "tried", tried)
    return seen


SCORE = [lambda x, y: 0.0]


def simplex(start: Floats, stride: float, steps: int) -> Iterator[tuple[float, float]]:
    """The rules of [NelderMead1965] with the usual factors, as a sequence of points to try.

    Coefficients 1 (reflection), 2 (expansion), 1/2 (contraction, shrinking).
    """
    points = [start + stride * np.array(c) for c in ((0.0, 0.0), (1.0, 0.3), (-0.3, 1.0))]
    values = []
    for p in points:
        values.append((yield tuple(p)))
    while True:
        order = sorted(range(3), key=lambda k: -values[k])
        points, values = [points[k] for k in order], [values[k] for k in order]
        if max(math.dist(points[0], p) for p in points[1:]) < 0.02 * abs(stride):
            return
        middle = 0.5 * (points[0] + points[1])
        mirror = middle + (middle - points[2])
        high = yield tuple(mirror)
        if high > values[0]:
            beyond = middle + 2.0 * (middle - points[2])
            higher = yield tuple(beyond)
            points[2], values[2] = (beyond, higher) if higher > high else (mirror, high)
        elif high > values[1]:
            points[2], values[2] = mirror, high
        else:
            outside = high > values[2]
            between = middle + (0.5 if outside else -0.5) * (middle - points[2])
            value = yield tuple(between)
            if value > (high if outside else values[2]):
                points[2], values[2] = between, value
            else:
                for k in (1, 2):
                    points[k] = 0.5 * (points[0] + points[k])
                    values[k] = yield tuple(points[k])


HILLS = {
    "round": lambda x, y: 3.0 - (x - 0.4) ** 2 - (y + 0.2) ** 2,
    "ridge": lambda x, y: 3.0 - abs(x - y) - 0.1 * (x + y - 1.0) ** 2,
    "cliff": lambda x, y: 1.0 + x if x < 0.35 and y < 0.6 else 0.0,
    "flat": lambda x, y: 1.0,
    "none": lambda x, y: 0.0,
    "waves": lambda x, y: 2.0 + math.sin(9.0 * x) * math.cos(7.0 * y),
}


@pytest.mark.parametrize("name", HILLS)
@pytest.mark.parametrize("stride", [0.5, -0.2, 0.03])
@pytest.mark.parametrize("steps", [2, 9, 60])
def test_the_simplex_climbs_by_its_rules(
    name: str, stride: float, steps: int, hill: list[tuple[float, float]]
) -> None:
    SCORE[0] = HILLS[name]
    start = np.array([0.1, 0.3])
    triple = np.array([4, 5, 6])
    found, used, point, spent = climb(
        None, None, None, None, None, None, None, triple, start, stride, steps
    )
    known: list[tuple[float, float]] = []
    rules = simplex(start, stride, steps)
    at = next(rules)
    try:
        while len(known) < steps:
            known.append(at)
            at = rules.send(max(0.0, HILLS[name](*at)))
    except StopIteration:
        pass
    assert spent == len(hill) == len(known)
    assert np.array(hill) == pytest.approx(np.array(known), abs=1e-12)
    scores = [max(0.0, HILLS[name](*p)) for p in hill]
    assert used.tolist() == [[4, 5, 6]]
    if max(scores) == 0.0:
        assert found.verdict[0] == 0
        assert point[0].tolist() == start.tolist()
        return
    best = int(np.argmax(scores))
    assert tuple(point[0]) == hill[best]
    assert (found.verdict[0], found.first[0], found.cells[0]) == (Verdict.CAGE, 2, best + 1)
    assert found.levels[0].tolist() == [2.0, 2.0 * scores[best]]
    assert found.contacts[0].tolist() == [list(hill[best])] * 3


def test_every_job_is_told_in_its_row(hill: list[tuple[float, float]]) -> None:
    SCORE[0] = HILLS["cliff"]
    triples = np.array([[0, 1, 2], [3, 4, 5], [6, 7, 8]])
    points = np.array([[0.1, 0.2], [0.9, 0.2], [0.3, 0.4]])
    found, used = tried_jobs(None, None, None, None, None, triples, points, None, None)
    assert hill == [tuple(p) for p in points]
    assert used.tolist() == triples.tolist()
    assert found.verdict.tolist() == [Verdict.CAGE, Verdict.NO_CAGE, Verdict.CAGE]
    assert found.first.tolist() == [2, 1, 2]
    assert found.levels.tolist() == [[2.0, 2.2], [1.0, 5.0], [2.0, 2.6]]
    assert found.cells.tolist() == [1, 7, 3]
    assert found.contacts.tolist() == [[p.tolist()] * 3 for p in points]
