"""Which values every trial gets. A trial's values depend on the study's config and its number only.

Quantiles in [0, 1) come from one stream (random), one scrambled Sobol sequence, or Saltelli's
design; a piece of any of them can be had without the rest, so shards of any size draw the same
trials. Grids are no quantiles: trial i takes cell i of all grids, over and over, so that every cell
has as many trials as any other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.stats import qmc

from experiments.study.inputs.config import StudyConfig
from experiments.study.inputs.variables import PLACEMENT, VARIABLES, input_of, is_placement
from experiments.study.report.indices import design_rows
from icage.arrays import FloatArray, IntArray

_STREAM: Final = 11
"""Of the random numbers of inputs; starts and shapes have others."""


@dataclass(frozen=True, slots=True)
class Design:
    """The trials of a study.

    Attributes
    ----------
    names:
        Variables that vary; columns of the quantiles.
    groups:
        Saltelli's design: columns that are exchanged together. Placement is one group, with the
        drawn start in it; the shape of the boundary's noise goes with its size.
    total:
        Trials, all of them.
    """

    config: StudyConfig
    names: tuple[str, ...]
    groups: tuple[tuple[str, tuple[int, ...]], ...]
    total: int

    @classmethod
    def of(cls, config: StudyConfig) -> Design:
        """The design of a config."""
        names = tuple(n for n in VARIABLES if n in config.vary and config.vary[n].varies)
        if config.sampling != "saltelli":
            return cls(config, names, (), config.trials)
        placed = tuple(k for k, n in enumerate(names) if is_placement(n))
        groups: list[tuple[str, tuple[int, ...]]]
        groups = [(n, (k,)) for k, n in enumerate(names) if k not in placed]
        noise = input_of("shape", "noise").name
        if noise not in names and config.noisy:
            groups.append((noise, ()))
        if placed or config.starts != "nominal":
            groups.append((PLACEMENT, placed))
        base = base_points(config.trials, len(groups))
        return cls(config, names, tuple(groups), design_rows(base, len(groups)))

    def values(self, trials: IntArray) -> dict[str, FloatArray]:
        """Name to values (n,) of every variable, for trials (n,) in ascending order."""
        uniform = self._quantiles(trials)
        found = {
            name: self.config.distribution(name).values(np.zeros(len(trials))) for name in VARIABLES
        }
        for k, name in enumerate(self.names):
            found[name] = self.config.vary[name].values(uniform[:, k])
        return found | self._grids(trials)

    def streams(self, trials: IntArray, group: str = PLACEMENT) -> tuple[IntArray, IntArray]:
        """Which start each trial takes, (n,) number and (n,) stream; stream 1 is Saltelli's B."""
        if not self.groups:
            return trials, np.zeros_like(trials)
        width = len(self.groups) + 2
        member = trials % width
        swapped = [2 + k for k, (name, _) in enumerate(self.groups) if name == group]
        return trials // width, np.isin(member, [1, *swapped]).astype(np.int64)

    def shapes(self, trials: IntArray) -> IntArray:
        """Which shape of the boundary's noise each trial has, (n,): as with the starts."""
        number, stream = self.streams(trials, input_of("shape", "noise").name)
        return 2 * number + stream

    def _quantiles(self, trials: IntArray) -> FloatArray:
        """Quantiles (n, d) of the varying variables."""
        if not len(trials) or not self.names:
            return np.zeros((len(trials), len(self.names)))
        if not self.groups:
            return self._rows(len(self.names), trials)
        width = len(self.groups) + 2
        both = self._rows(2 * len(self.names), trials // width)
        a, b = both[:, : len(self.names)], both[:, len(self.names) :]
        member = trials % width
        mixed = np.where((member == 1)[:, None], b, a)
        for k, (_, columns) in enumerate(self.groups):
            here = np.flatnonzero(member == 2 + k)
            for column in columns:
                mixed[here, column] = b[here, column]
        return mixed

    def _rows(self, dimensions: int, rows: IntArray) -> FloatArray:
        """Rows (n, d) of the one sequence of the study; ``rows`` ascending, repeats allowed."""
        first, last = int(rows[0]), int(rows[-1])
        count = last - first + 1
        seed = np.random.SeedSequence([self.config.seed, _STREAM])
        if self.config.sampling == "random":
            bits = np.random.PCG64(seed)
            bits.advance(first * dimensions)  # one draw a number
            piece = np.random.Generator(bits).random((count, dimensions))
        else:
            piece = sobol_points(dimensions, first, count, np.random.default_rng(seed))
        return piece[rows - first]

    def _grids(self, trials: IntArray) -> dict[str, FloatArray]:
        """Values of the variables on grids: the last one changes fastest."""
        grids = [n for n in self.names if self.config.vary[n].kind == "grid"]
        found: dict[str, FloatArray] = {}
        cell = np.array(trials)
        for name in reversed(grids):
            values = np.array(self.config.vary[name].parameters)
            found[name] = values[cell % len(values)]
            cell = cell // len(values)
        return found


def sobol_points(dimensions: int, first: int, count: int, rng: np.random.Generator) -> FloatArray:
    """Points (count, d) of a scrambled Sobol sequence from number ``first`` on.

    SciPy forwards sequences of up to 32 bits only, and by one point at least; a piece from its
    start is drawn in a power of two, since it warns of any other number.
    """
    sequence = qmc.Sobol(dimensions, scramble=True, rng=rng, bits=32)
    if first == 0:
        return np.asarray(sequence.random(1 << (count - 1).bit_length())[:count])
    return np.asarray(sequence.fast_forward(first).random(count))


def base_points(trials: int, groups: int) -> int:
    """Base points N, a power of two, so that N (groups + 2) is at least ``trials``."""
    base = 1
    while base * (groups + 2) < trials:
        base *= 2
    return base


def cells(config: StudyConfig, names: Sequence[str]) -> int:
    """Number of cells of the grids among ``names``."""
    sizes = [len(config.vary[n].parameters) for n in names if config.vary[n].kind == "grid"]
    return int(np.prod(sizes)) if sizes else 1
