"""Arithmetic on pairs of doubles, against fractions."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from icage.kernels import double_double as dd

pytestmark = pytest.mark.usefixtures("plain")

NEAR = Fraction(1, 2**100)
"""[1] Of sums and products of numbers of 106 bits."""


def exact(pair: tuple[float, float]) -> Fraction:
    return Fraction(pair[0]) + Fraction(pair[1])


def number(rng: np.random.Generator) -> tuple[float, float]:
    """A pair whose second part is below the last place of the first."""
    high = float(rng.normal()) * 2.0 ** int(rng.integers(-8, 9))
    return dd.two_sum(high, high * float(rng.uniform(-1.0, 1.0)) * 2.0**-54)


def test_sums_and_products_of_doubles_are_exact() -> None:
    rng = np.random.default_rng(1)
    for a, b in rng.normal(size=(200, 2)) * 2.0 ** rng.integers(-30, 31, (200, 2)):
        assert exact(dd.two_sum(a, b)) == Fraction(a) + Fraction(b)
        assert exact(dd.two_product(a, b)) == Fraction(a) * Fraction(b)
        assert dd.two_sum(a, b)[0] == a + b
        assert dd.two_product(a, b)[0] == a * b


def test_a_hundred_bits_are_right() -> None:
    rng = np.random.default_rng(2)
    for _ in range(200):
        a, b, c, d = (number(rng) for _ in range(4))
        x, y, u, v = (exact(one) for one in (a, b, c, d))
        for found, known, size in (
            (dd.add(*a, *b), x + y, abs(x + y)),
            (dd.sub(*a, *b), x - y, abs(x - y)),
            (dd.mul(*a, *b), x * y, abs(x * y)),
            (dd.scale(*a, b[0]), x * Fraction(b[0]), abs(x * y)),
            (dd.div(*a, *b), x / y, abs(x / y)),
            (dd.dot(*a, *b, *c, *d), x * u + y * v, abs(x * u) + abs(y * v)),
        ):
            assert abs(exact(found) - known) <= NEAR * size
            assert found[0] == found[0] + found[1]  # the second part is below the last place


def test_nearly_all_may_cancel() -> None:
    a = (1.0, 2.0**-60)
    assert exact(dd.sub(*a, 1.0, 0.0)) == Fraction(1, 2**60)
    assert exact(dd.sub(*a, 1.0, 2.0**-61)) == Fraction(1, 2**61)
