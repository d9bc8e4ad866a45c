"""Forces from cones that add up to none: against linear programs over their edges."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import linprog, nnls

from icage.friction.disc_contacts import DiscContacts
from icage.friction.kernels.balance import EVERYTHING, NOTHING, SECTOR, balancing
from icage.friction.kernels.disc_balance import _power, _squeezing_row, _torque
from icage.friction.kernels.disc_features import (
    ARC,
    AT_X,
    CORNER,
    EDGE,
    FIXED,
    FORCE_X,
    OF_FINGER,
    generators,
    rays,
)
from tests.icage.friction.flat_polygons import fingers_of
from tests.oracles.geometry import Floats

pytestmark = pytest.mark.usefixtures("plain")

Z = np.array([[0.0, 0.0], [1.0, 0.0], [0.3, 0.8]])


def cones(rng: np.random.Generator, count: int, half: float) -> Floats:
    """Rows (count, 4): both edges of a cone of forces, unit vectors."""
    middle = rng.uniform(0.0, 2.0 * np.pi, count)
    return np.column_stack([f(middle + s) for s in (-half, half) for f in (np.cos, np.sin)])


def balances(z: Floats, rows: Floats, w: complex) -> bool:
    """Whether forces in the cones add up to none and squeeze a hand of this w."""
    forces = rows.reshape(-1, 2) @ np.array([1.0, 1j])
    moments = np.repeat(np.conj(z @ np.array([1.0, 1j])), 2) * forces
    equal = np.array([forces.real, forces.imag, moments.real, moments.imag])
    wanted = np.array([0.0, 0.0, -w.real, -w.imag])
    return nnls(equal, wanted)[1] < 1e-9


@pytest.mark.parametrize("half", [1e-9, 0.1, 0.5, 0.9])
def test_a_sector_holds_the_hands_that_forces_balance(half: float) -> None:
    rng = np.random.default_rng(int(100 * half))
    kinds = {NOTHING: 0, SECTOR: 0, EVERYTHING: 0}
    for trial in range(60):
        count = 3 if trial % 3 else 2
        finger = np.sort(rng.permutation(3)[:count])
        rows = cones(rng, count, half)
        if trial % 4 == 0:  # opposite each other
            rows[1] = -rows[0]
        store = np.vstack([rng.normal(size=(2, 4)), rows])
        which = 2 + rng.permutation(count)
        used = store[which]
        sector = np.full(2, np.nan)
        z = Z + (trial % 2) * np.array([0.7, -0.4])  # wherever the unit hand has its origin
        kind = balancing(z, finger, store, which, count, sector)
        kinds[kind] += 1
        asked = rng.uniform(-np.pi, np.pi, 6)
        if kind == SECTOR:
            middle, spread = sector
            assert 0.0 <= spread <= 0.5 * np.pi
            edges = middle + (spread - 1e-6) * np.array([1.0, -1.0]) if spread > 1e-5 else [middle]
            for angle in edges:
                assert balances(z[finger], used, complex(np.exp(1j * angle))) or half < 1e-6
            beyond = middle + (spread + 1e-5) * np.array([1.0, -1.0])
            if spread < 0.5 * np.pi:
                for angle in beyond:
                    assert not balances(z[finger], used, complex(np.exp(1j * angle)))
        for angle in asked:
            inside = {NOTHING: False, EVERYTHING: True}.get(kind)
            if inside is None:
                off = abs((angle - sector[0] + np.pi) % (2.0 * np.pi) - np.pi) - sector[1]
                if abs(off) < 1e-4:
                    continue
                inside = off < 0.0
            assert balances(z[finger], used, complex(np.exp(1j * angle))) == inside
    assert kinds[SECTOR] >= 5
    assert kinds[NOTHING] >= 5
    assert kinds[EVERYTHING] >= (1 if half > 0.4 else 0)


RADIUS = 0.2


def features(rng: np.random.Generator) -> DiscContacts:
    """An edge, a corner and an arc, as the kernels see them."""
    none = np.empty(0, np.int64)
    return DiscContacts(
        ptr=none, which=none, kind=np.array([EDGE, CORNER, ARC]), place=rng.normal(size=(3, 4)),
        angle=rng.uniform(-np.pi, np.pi, (3, 2)), apex=np.empty((0, 2)), radius=RADIUS,
    )  # fmt: skip


@pytest.mark.parametrize("phi", [0.2, 1.2])
def test_cones_have_an_edge_on_both_sides_and_wide_ones_one_more(phi: float) -> None:
    """Forces act where a finger touches: beside its centre, or at the vertex of an arc."""
    rng = np.random.default_rng(4)
    contacts = features(rng)
    state = np.full((3, 11), np.nan)
    state[1, :2] = 0.7, 0.1
    found = np.full((18, 6), np.nan)
    n = generators(contacts, np.array([0, 2, 1]), np.array([0, 1, 2]), 3, state, phi, found)
    known = []
    for finger, feature, along, half in (
        (0, 0, contacts.angle[0, 0], phi), (2, 1, contacts.angle[1, 0], phi),
        (2, 1, contacts.angle[1, 1], phi), (1, 2, 0.7 + np.pi, phi + 0.1),
    ):  # fmt: skip
        at = RADIUS * np.array([np.cos(along), np.sin(along)])
        place = contacts.place[feature, :2] if feature == 2 else at
        for way in (-half, 0.0, half) if half > 1.0 else (-half, half):
            force = [math.cos(along + way), math.sin(along + way)]
            known.append([*force, *place, float(feature == 2), finger])
    assert n == len(known)
    assert found[:n] == pytest.approx(np.array(known), abs=1e-12)
    assert generators(contacts, np.array([0, 2]), np.array([0, 1]), 2, state, phi, found[:5]) == 5


def edges(rng: np.random.Generator, count: int) -> Floats:
    """Generators (count, 6) of any fingers, some fixed."""
    found = np.empty((count, 6))
    angle = rng.uniform(0.0, 2.0 * np.pi, count)
    found[:, FORCE_X], found[:, FORCE_X + 1] = np.cos(angle), np.sin(angle)
    found[:, AT_X : AT_X + 2] = rng.normal(size=(count, 2))
    found[:, FIXED] = rng.integers(0, 2, count)
    found[:, OF_FINGER] = rng.integers(0, 3, count)
    return found


@pytest.mark.parametrize("seed", range(12))
def test_rays_are_the_extreme_balances(seed: int) -> None:
    """Torque and power of all forces of unit weight that add up to none lie between the rays'."""
    rng = np.random.default_rng(seed)
    count = 4 + seed % 4
    edge, found = edges(rng, count), np.full((60, 7), np.nan)
    m = rays(Z, edge, count, found)
    balanced = np.vstack([np.ones(count), edge[:, :2].T])
    assert (m > 0) == (nnls(balanced, np.array([1.0, 0.0, 0.0]))[1] < 1e-9)
    for _ in range(4 if m else 0):
        hand = rng.normal(size=4)
        point = fingers_of(hand[None], Z)[0][edge[:, OF_FINGER].astype(int)]
        free = edge[:, FIXED] == 0.0
        at = np.where(free, point, 0.0) + edge[:, AT_X] + 1j * edge[:, AT_X + 1]
        force = edge[:, 0] + 1j * edge[:, 1]
        torque = (np.conj(at) * force).imag
        turned = complex(hand[2], hand[3]) * (Z @ [1.0, 1j])[edge[:, OF_FINGER].astype(int)]
        power = (np.conj(turned) * force).real
        mix = rng.normal(size=2)
        cost = mix[0] * torque + mix[1] * power
        of_rays = [mix[0] * _torque(r, hand) + mix[1] * _power(r, hand) for r in found[:m]]
        for sign in (1.0, -1.0):
            best = linprog(sign * cost, A_eq=balanced, b_eq=[1.0, 0.0, 0.0])
            assert min(sign * np.array(of_rays)) == pytest.approx(best.fun, abs=1e-9)
    assert rays(Z, edge, count, found[: max(m - 1, 0)]) == max(m - 1, 0)


@pytest.mark.parametrize("order", [[0, 1, 2], [0, 2, 1], [2, 0, 1], [1, 0, 2]])
def test_two_opposite_forces_are_a_ray(order: list[int]) -> None:
    edge = np.zeros((3, 6))
    edge[order, :2] = [[0.0, 1.0], [0.0, -1.0], [1.0, 0.0]]
    edge[order, OF_FINGER] = [0, 1, 2]
    found = np.empty((6, 7))
    assert rays(Z, edge, 3, found) == 1
    # (0, 1)/2 on finger 1 at d, the opposite on finger 2 at d + w: torque -w_x / 2, power -w_y / 2
    assert found[0].tolist() == pytest.approx([0.0, 0.0, -0.5, 0.0, 0.0, 0.0, -0.5])


def test_the_row_of_two_balances_that_squeeze_together() -> None:
    """T_a P_b - T_b P_a <= 0, with the torques off to the safe side."""
    rng = np.random.default_rng(9)
    a, b = rng.normal(size=(2, 7))
    row = np.empty(5)
    for _ in range(5):
        hand, loose = rng.normal(size=4), float(rng.uniform(0.0, 0.3))
        p, q = _power(a, hand), _power(b, hand)
        _squeezing_row(row, a, b, p, q, loose)
        known = _torque(b, hand) * p - _torque(a, hand) * q + loose * (abs(p) + abs(q))
        assert row[:4] @ hand + row[4] == pytest.approx(known, abs=1e-12)
