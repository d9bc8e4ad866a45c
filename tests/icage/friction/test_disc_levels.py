"""sigma_first(mu) of disc fingers: what must hold whatever the object, and faults that are seen."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable

import numpy as np
import pytest

import icage
from icage.errors import GraspError
from icage.friction import disc_jams, jam_search
from icage.friction.disc_contacts import DiscContacts
from icage.friction.disc_jams import DiscJams
from icage.friction.kernels import disc_jams as disc_kernels
from icage.friction.kernels.disc_features import ARC, AT_X, AT_Y, CORNER, FIXED
from icage.friction.levels import friction_levels
from icage.kernels import compiled
from icage.outline import Outline
from icage.planner import plan
from models import CASES
from tests.icage.friction.beside_sampling import Compared, compared_disc, drawn_disc
from tests.oracles.geometry import Floats
from tests.oracles.polygons import rotated

MUS = (0.0, 0.01, 0.05, 0.15, 0.3, 0.6, 1.5, 20.0)
SEEDS = range(12)
WITHIN = 1e-9


def of(vertices: Floats, contacts: Floats, radius: float) -> Floats | None:
    """Levels over sigma_0; None where a pocket that is closed holds a contact."""
    try:
        cage = plan(Outline(vertices), contacts, radius)
    except GraspError:
        return None
    found = friction_levels(cage, MUS)
    return np.array(
        [np.inf if f.sigma_first is None else f.sigma_first / cage.sigma_0 for f in found]
    )


@functools.cache
def drawn(seed: int) -> tuple[Floats, Floats, float]:
    target, _ = drawn_disc(seed)
    return target.vertices, target.contacts, target.radius


@functools.cache
def undisturbed(seed: int) -> Floats | None:
    """The levels of a drawn target where it lies, which many tests compare with."""
    return of(*drawn(seed))


def same(a: Floats | None, b: Floats | None) -> bool:
    if a is None or b is None:
        return a is b
    finite = np.isfinite(a)
    return bool((finite == np.isfinite(b)).all()) and bool(
        (np.abs(a[finite] / b[finite] - 1.0) <= WITHIN).all()
    )


def test_without_friction_it_is_the_plans_own_and_more_friction_never_raises_it() -> None:
    for seed in SEEDS:
        vertices, contacts, radius = drawn(seed)
        levels = undisturbed(seed)
        assert levels is not None
        cage = plan(Outline(vertices), contacts, radius)
        assert cage.friction(0.0).sigma_first == cage.sigma_first
        assert (np.diff(levels[np.isfinite(levels)]) <= 0.0).all(), seed


def test_a_little_friction_costs_no_more_than_the_bracket_of_the_plan() -> None:
    """Beyond the polygon's own first level nothing is known; but that is as good as the curve's."""
    for seed in SEEDS:
        vertices, contacts, radius = drawn(seed)
        cage = plan(Outline(vertices), contacts, radius)
        found = cage.friction(1e-9)
        if found.jam is None and cage.sigma_first is not None:
            assert (found.sigma_first or 0.0) > cage.sigma_first * (1.0 - 1e-4)


def test_a_level_does_not_depend_on_what_else_is_asked() -> None:
    for seed in (3, 5, 9):
        vertices, contacts, radius = drawn(seed)
        alone = [
            plan(Outline(vertices), contacts, radius).friction(mu).sigma_first or np.inf
            for mu in MUS
        ]
        cage = plan(Outline(vertices), contacts, radius)
        backwards = [level.sigma_first or np.inf for level in friction_levels(cage, MUS[::-1])]
        assert same(np.array(alone), np.array(backwards[::-1])), seed


MOTIONS: dict[str, tuple[Callable[[Floats], Floats], float]] = {
    "turned": (lambda points: rotated(points, 2.3, (0.7, -1.1)), 1.0),
    "small": (lambda points: 1e-3 * points, 1e-3),
    "large": (lambda points: 1e3 * points, 1e3),
    "away": (lambda points: points + np.array([40.0, -30.0]), 1.0),
}


@pytest.mark.parametrize("motion", MOTIONS)
def test_motion_and_scale(motion: str) -> None:
    for seed in SEEDS:
        vertices, contacts, radius = drawn(seed)
        move, scale = MOTIONS[motion]
        moved = of(move(vertices), move(contacts), scale * radius)
        assert same(undisturbed(seed), moved), seed


def test_labels_and_mirrors() -> None:
    mirror = np.array([-1.0, 1.0])
    for seed in SEEDS:
        vertices, contacts, radius = drawn(seed)
        base = undisturbed(seed)
        for shift in (1, 2):
            assert same(base, of(vertices, np.roll(contacts, shift, axis=0), radius)), seed
        mirrored = of(mirror * vertices, (mirror * contacts)[[1, 0, 2]], radius)
        assert same(base, mirrored), seed


@pytest.mark.parametrize("radius", [0.02, 0.1, 0.3])
def test_a_triangle_jams_where_its_normals_miss_by_the_cone(radius: float) -> None:
    """Turned by a, forces meet in a point if each is turned by a against its normal, at the edge
    of the object and not at the centre of the finger: the radius changes nothing but sigma.
    """
    outline = np.array([[0, 0], [1, 0], [0.5, 0.75**0.5]])
    middle = np.array([0.5, 0.75**0.5 / 3.0])
    way = np.array([[0.0, -1.0], [0.75**0.5, 0.5], [-(0.75**0.5), 0.5]])
    inner = 0.75**0.5 / 3.0
    cage = plan(outline, middle + (inner + radius) * way, radius)
    for angle in (0.02, 0.05):
        # the finger's centre is off the foot of the middle by tan(a) times its distance from there
        needed = math.tan(angle) * (inner + radius) / inner
        allowed = icage.JamTolerance(angle=angle)
        below, above = friction_levels(cage, [needed * (1 - 1e-6), needed * (1 + 1e-6)], allowed)
        assert (below.sigma_first or 0.0) > 1.1 * cage.sigma_0
        assert above.sigma_first == pytest.approx(cage.sigma_0 / math.cos(angle), rel=1e-8)


def test_a_jam_is_as_wide_as_the_level_and_in_the_basin() -> None:
    for name in ("disc_Y", "disc_hammer"):
        cage = icage.plan(icage.load(CASES / f"{name}.json"))
        for found in friction_levels(cage, MUS):
            if found.jam is not None:
                assert found.jam.placement.sigma == pytest.approx(found.sigma_first, rel=1e-9)
                assert cage.query(found.jam.placement).verdict == "target"


def wrong(*seeds: int) -> dict[int, Compared]:
    """Of targets on which a fault changes the level most, as a sweep over 60 has shown."""
    results = {seed: compared_disc(seed, an_element=9) for seed in seeds}
    return {seed: result for seed, result in results.items() if result and not result.agrees}


def test_none_of_them_is_wrong_without_a_fault() -> None:
    assert wrong(2, 3, 8, 19) == {}


@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_a_cone_of_another_width_is_seen(factor: float, monkeypatch: pytest.MonkeyPatch) -> None:
    least = DiscJams.least
    monkeypatch.setattr(
        DiscJams, "least", lambda self, mu, near, below: least(self, factor * mu, near, below)
    )
    assert wrong(3, 8)


@pytest.mark.parametrize("missing", [2, 3])
def test_missing_pairs_or_triples_are_seen(missing: int, monkeypatch: pytest.MonkeyPatch) -> None:
    every = jam_search.touching_subsets
    monkeypatch.setattr(
        jam_search, "touching_subsets", lambda n: every(n)[every(n).sum(axis=1) != missing]
    )
    assert wrong(3, 19)


@pytest.mark.parametrize("kind", [CORNER, ARC])
def test_missing_corners_or_arcs_are_seen(kind: int, monkeypatch: pytest.MonkeyPatch) -> None:
    found = disc_jams.disc_contacts
    monkeypatch.setattr(disc_jams, "disc_contacts", lambda *asked: _without(kind, found(*asked)))
    assert wrong(2, 3, 8)


def test_torque_taken_at_the_centres_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    edges = disc_kernels.generators.plain

    def at_centres(*asked: object) -> int:
        n = edges(*asked)
        asked[-1][:n, [AT_X, AT_Y, FIXED]] = 0.0
        return n

    for kernel in (disc_kernels.bounds_of, disc_kernels.least_disc_jam):
        monkeypatch.setattr(kernel, "machine", None)
    monkeypatch.setattr(compiled._process, "never", True)
    monkeypatch.setattr(disc_kernels, "generators", at_centres)
    assert wrong(2, 3)


def _without(kind: int, contacts: DiscContacts) -> DiscContacts:
    keep = contacts.kind[contacts.which] != kind
    ptr = np.concatenate([[0], np.cumsum(keep)])[contacts.ptr]
    return contacts._replace(ptr=ptr.astype(np.int64), which=contacts.which[keep])
