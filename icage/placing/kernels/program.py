"""The most that the least of some linear functions can be on a box: a linear program, by its dual.

Row i is offset_i + slope_i . x with x in [-1, 1]^4. Of the rows with ``counts`` 1 the least is
made as large as can be, while those with ``counts`` 0 are at least 0. Multipliers l >= 0 whose
counting ones sum to 1 prove

    most <= sum l_i offset_i + sum_j |sum_i l_i slope_ij|,

whatever rounding did to them: the bound returned is this one, computed anew. Our own; the simplex
method on a tableau of five rows. [docs/theory.md, Sec. 11]
"""

# pyright: basic
from __future__ import annotations

from typing import NamedTuple

import numpy as np

from icage.kernels.compiled import compiled, compiled_borrowing

UNKNOWNS = 4

_STEPS = 80
"""Exchanges at most; the multipliers after any of them prove a bound."""

_ZERO = 1e-13
"""[1] Of the largest offset or slope: smaller is rounding."""


class Program(NamedTuple):
    """Room for the rows, and for what the simplex method writes."""

    offset: np.ndarray
    slope: np.ndarray
    counts: np.ndarray
    tableau: np.ndarray
    basis: np.ndarray
    multiplier: np.ndarray
    at: np.ndarray
    """(4,) where the bound is reached, in [-1, 1]^4, if the rows were exact."""


@compiled
def new_program(rows):
    """Room for so many rows."""
    return Program(
        np.empty(rows),
        np.empty((rows, UNKNOWNS)),
        np.empty(rows),
        np.empty((UNKNOWNS + 2, rows + 2 * UNKNOWNS + 1)),
        np.empty(UNKNOWNS + 1, np.int64),
        np.empty(rows),
        np.empty(UNKNOWNS),
    )


@compiled_borrowing
def most_of_least(program, rows, enough):
    """The bound (-inf: the rows with ``counts`` 0 exclude each other); any bound <= ``enough``."""
    first = _first_row(program, rows)
    _fill(program, rows, first)
    t = program.tableau
    last = rows + 2 * UNKNOWNS
    size = 0.0
    for i in range(rows):
        size = max(size, abs(program.offset[i]))
        for j in range(UNKNOWNS):
            size = max(size, abs(program.slope[i, j]))
    zero = _ZERO * size
    for _ in range(_STEPS):
        if -t[UNKNOWNS + 1, last] <= enough:
            break
        column = -1
        lowest = -zero
        for c in range(last):
            if t[UNKNOWNS + 1, c] < lowest:
                lowest = t[UNKNOWNS + 1, c]
                column = c
        if column < 0:
            break
        row = -1
        ratio = np.inf
        for r in range(UNKNOWNS + 1):
            if t[r, column] > _ZERO and t[r, last] < ratio * t[r, column]:
                ratio = t[r, last] / t[r, column]
                row = r
        if row < 0:
            if _proves_empty(program, rows, column, zero):
                return -np.inf
            break
        _exchange(program, last, row, column)
    for j in range(UNKNOWNS):
        x = 1.0 - t[UNKNOWNS + 1, rows + 2 * j]
        program.at[j] = min(1.0, max(-1.0, x))
    for i in range(rows):
        program.multiplier[i] = 0.0
    for r in range(UNKNOWNS + 1):
        if program.basis[r] < rows:
            program.multiplier[program.basis[r]] = max(0.0, t[r, last])
    return _proved(program, rows)


@compiled_borrowing
def _first_row(program, rows):
    """The counting row with the least largest value."""
    best = np.inf
    first = 0
    for i in range(rows):
        if program.counts[i] > 0.0:
            top = program.offset[i]
            for j in range(UNKNOWNS):
                top += abs(program.slope[i, j])
            if top < best:
                best = top
                first = i
    return first


@compiled_borrowing
def _fill(program, rows, first):
    """The tableau whose basis is one row and the signs of its slopes."""
    t = program.tableau
    last = rows + 2 * UNKNOWNS
    slope = program.slope
    for j in range(UNKNOWNS):
        sign = -1.0 if slope[first, j] > 0.0 else 1.0
        for i in range(rows):
            t[j, i] = sign * (slope[i, j] - slope[first, j] * program.counts[i])
        for c in range(rows, last):
            t[j, c] = 0.0
        t[j, rows + 2 * j] = -sign
        t[j, rows + 2 * j + 1] = sign
        t[j, last] = -sign * slope[first, j]
        program.basis[j] = rows + 2 * j + (0 if sign < 0.0 else 1)
    for i in range(rows):
        t[UNKNOWNS, i] = program.counts[i]
    for c in range(rows, last):
        t[UNKNOWNS, c] = 0.0
    t[UNKNOWNS, last] = 1.0
    program.basis[UNKNOWNS] = first
    for c in range(last + 1):
        cost = program.offset[c] if c < rows else 1.0 if c < last else 0.0
        cost -= program.offset[first] * t[UNKNOWNS, c]
        for j in range(UNKNOWNS):
            cost -= t[j, c]
        t[UNKNOWNS + 1, c] = cost


@compiled_borrowing
def _exchange(program, last, row, column):
    """A column enters the basis in place of a row's."""
    t = program.tableau
    pivot = t[row, column]
    for c in range(last + 1):
        t[row, c] /= pivot
    for r in range(UNKNOWNS + 2):
        if r != row and t[r, column] != 0.0:
            factor = t[r, column]
            for c in range(last + 1):
                t[r, c] -= factor * t[row, c]
    program.basis[row] = column


@compiled_borrowing
def _proves_empty(program, rows, column, zero):
    """Whether the ray of multipliers along a column shows that no x satisfies the rows."""
    t = program.tableau
    for i in range(rows):
        program.multiplier[i] = 0.0
    if column < rows:
        program.multiplier[column] = 1.0
    for r in range(UNKNOWNS + 1):
        if program.basis[r] < rows:
            program.multiplier[program.basis[r]] += max(0.0, -t[r, column])
    total = 0.0
    for i in range(rows):
        if program.counts[i] > 0.0:
            program.multiplier[i] = 0.0
        total += program.multiplier[i]
    return _sum_of(program, rows) < -zero * (1.0 + total)


@compiled_borrowing
def _proved(program, rows):
    """The bound that the multipliers prove."""
    counting = 0.0
    for i in range(rows):
        counting += program.multiplier[i] * program.counts[i]
    return _sum_of(program, rows) / counting if counting > 0.0 else np.inf


@compiled_borrowing
def _sum_of(program, rows):
    """The sum l_i offset_i + sum_j |sum_i l_i slope_ij|."""
    total = 0.0
    for i in range(rows):
        total += program.multiplier[i] * program.offset[i]
    for j in range(UNKNOWNS):
        along = 0.0
        for i in range(rows):
            along += program.multiplier[i] * program.slope[i, j]
        total += abs(along)
    return total
