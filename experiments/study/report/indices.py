"""Which group of inputs matters: Sobol indices from Saltelli's design, with bootstrap intervals.

A study of N base points and G groups draws two independent sets of inputs, A and B, and between
them AB_g: A with the columns of group g taken from B (scipy's convention: its ``sample_AB`` copies
A and writes B's rows into it; in Saltelli's papers A and B are sometimes the other way round). Of
base point i the study runs A_i, B_i, AB_1i .. AB_Gi one after the other, so that what has been run
at any time is whole base points and a rest. With f the outcome and V its variance over A and B,

    first order  S_g = mean(f_B (f_AB_g - f_A)) / V           what g does alone
    total        T_g = mean((f_A - f_AB_g)^2) / (2 V)          ... and together with others

[Saltelli2010, Table 2 (b), (f)], computed by ``scipy.stats.sobol_indices``. Of an outcome that is
0 or 1, T_g is the share of base points where drawing g anew changes the outcome, over 2 V.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.stats import bootstrap, sobol_indices

from experiments.io.intervals import CONFIDENCE, wilson
from icage.arrays import AnyArray, FloatArray, IntArray
from icage.errors import InputError

FEWEST: Final = 32
"""[base points] With fewer, an interval says nothing."""

RAREST: Final = 10
"""[outcomes] of A and B that must differ from the commonest one: V rests on them."""

RESAMPLES: Final = 999


@dataclass(frozen=True, slots=True)
class Index:
    """What one group does to the variance of the outcome, with 95 % intervals; [1].

    Estimates, not clipped: one that is truly 0 may come out a little below it.
    """

    name: str
    first: float
    first_low: float
    first_high: float
    total: float
    total_low: float
    total_high: float


@dataclass(frozen=True, slots=True)
class Indices:
    """The indices of all groups, from ``base`` base points; None and why if there are none."""

    base: int
    groups: tuple[Index, ...] | None
    why: str | None = None


def design_rows(base: int, groups: int) -> int:
    """[trials] (G + 2) N.

    >>> design_rows(1024, 6)
    8192
    """
    return (groups + 2) * base


def layout(trials: IntArray, groups: int) -> tuple[IntArray, IntArray]:
    """Base point and member of each trial (T,); members: 0 is A, 1 is B, 2 + g is AB_g.

    >>> base, member = layout(np.arange(6), groups=2)
    >>> base.tolist(), member.tolist()
    ([0, 0, 0, 0, 1, 1], [0, 1, 2, 3, 0, 1])
    """
    return trials // (groups + 2), trials % (groups + 2)


def split(values: AnyArray, groups: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Outcomes (T,) in trial order as f_A (N,), f_B (N,), f_AB (G, N) of whole base points.

    A base point that has not run to its end is left out.
    """
    base = len(values) // (groups + 2)
    rows = np.asarray(values[: design_rows(base, groups)], dtype=np.float64)
    members = rows.reshape(base, groups + 2).T
    return members[0], members[1], members[2:]


def sobol(
    f_a: FloatArray,
    f_b: FloatArray,
    f_ab: FloatArray,
    names: Sequence[str],
    rng: np.random.Generator,
) -> Indices:
    """Indices of G groups from outcomes f_A (N,), f_B (N,), f_AB (G, N).

    Only the first 2^k base points are used: scipy takes no other number, and only so many Sobol
    points are balanced. The intervals resample base points with ``rng`` (percentiles, treating
    them as independent). A group that changed no 0/1 outcome would get [0, 0] from any resampling;
    its upper ends come from Wilson's interval of no change in N base points instead.

    Raises
    ------
    InputError
        If the shapes do not agree.
    """
    if f_a.ndim != 1 or f_b.shape != f_a.shape or f_ab.shape != (len(names), len(f_a)):
        shapes = f"{f_a.shape}, {f_b.shape} and {f_ab.shape}"
        raise InputError(
            f"outcomes of {len(names)} groups: (N,), (N,), (G, N) needed, not {shapes}"
        )
    base = 1 << (len(f_a).bit_length() - 1) if len(f_a) else 0
    # Rows A, B, AB_1 .. AB_G and A again: a group that does nothing, since scipy fails with one
    f = np.vstack([f_a, f_b, f_ab, f_a])[:, :base].astype(np.float64)
    why = _why_not(f)
    if why is not None:
        return Indices(base, None, why)
    first, total = _estimate(f)
    (first_low, total_low), (first_high, total_high) = _interval(f, rng)
    if np.isin(f, (0.0, 1.0)).all():
        unchanged = (f[2:-1] == f[0]).all(axis=1)
        most = wilson(0, base)[1] / (2.0 * f[:2].var())
        first_high, total_high = (
            np.where(unchanged, most, high) for high in (first_high, total_high)
        )
    table = np.column_stack([first, first_low, first_high, total, total_low, total_high])
    return Indices(
        base, tuple(Index(n, *row) for n, row in zip(names, table.tolist(), strict=True))
    )


def _why_not(f: FloatArray) -> str | None:
    """Why outcomes (G + 3, N) have no indices; None if they have."""
    base = f.shape[1]
    if base < FEWEST:
        return f"{base} base points; at least {FEWEST} are needed"
    wrong = int((~np.isfinite(f[:-1])).sum())
    if wrong:
        return f"{wrong} outcomes are not finite"
    values, counts = np.unique(f[:2], return_counts=True)
    if len(values) == 1:
        return f"all {2 * base} outcomes of A and B are {values[0]:g}: no variance to share out"
    rare = 2 * base - int(counts.max())
    if rare < RAREST:
        usual = values[counts.argmax()]
        return f"only {rare} of {2 * base} outcomes of A and B are not {usual:g}: too few"
    return None


def _estimate(f: FloatArray) -> FloatArray:
    """First-order and total indices (2, G) of outcomes (G + 3, N)."""
    known = {"f_A": f[0:1], "f_B": f[1:2], "f_AB": f[2:, None, :]}
    found = sobol_indices(func=known, n=f.shape[1])
    return np.stack([found.first_order, found.total_order])[:, :-1]


def _interval(f: FloatArray, rng: np.random.Generator) -> tuple[FloatArray, FloatArray]:
    """Lower and upper ends, (2, G) each, by resampling the base points.

    Not ``SobolResult.bootstrap``: it takes no random numbers from its caller, so no run of it can
    be repeated, and its BCa interval is NaN for a group that does nothing.
    """
    base = f.shape[1]

    def estimate(rows: IntArray) -> FloatArray:
        return _estimate(f[:, rows])

    found = bootstrap(
        (np.arange(base),), estimate, method="percentile",
        n_resamples=RESAMPLES, batch=max(1, 2**20 // base), confidence_level=CONFIDENCE,
        vectorized=False, rng=rng,
    )  # fmt: skip
    return found.confidence_interval.low, found.confidence_interval.high
