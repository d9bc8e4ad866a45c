"""Grasps that were found, as arrays, best first: thousands of them are ranked at a time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice

import numpy as np

from icage.arrays import FloatArray, IntArray
from icage.grasps.wanted import Candidate
from icage.outline import Outline

_ALIKE = 0.08
"""[diameter] Grasps whose contacts differ by less than this (root mean square) are one idea."""


@dataclass(frozen=True, slots=True, eq=False)
class Findings:
    """n grasps.

    Attributes
    ----------
    triples:
        (n, 3) contact features, in the order of the contacts.
    points:
        (n, 2) where the lines of force meet.
    contacts:
        (n, 3, 2) [unit], counterclockwise from finger 1.
    sigma_0, level:
        (n,) [unit] as in ``Candidate``.
    cells:
        (n,) that the search from each has visited: what another one like it costs.
    """

    triples: IntArray
    points: FloatArray
    contacts: FloatArray
    sigma_0: FloatArray
    level: FloatArray
    cells: IntArray

    def __len__(self) -> int:
        return len(self.triples)

    @property
    def score(self) -> FloatArray:
        """(n,) level / sigma_0."""
        return self.level / self.sigma_0

    @classmethod
    def none(cls) -> Findings:
        """Nothing yet."""
        return cls(
            np.empty((0, 3), np.int64), np.empty((0, 2)), np.empty((0, 3, 2)), np.empty(0),
            np.empty(0), np.empty(0, np.int64),
        )  # fmt: skip

    @classmethod
    def together(cls, parts: Sequence[Findings]) -> Findings:
        """All of them, in this order."""
        if not parts:
            return cls.none()
        return cls(
            np.concatenate([part.triples for part in parts]),
            np.concatenate([part.points for part in parts]),
            np.concatenate([part.contacts for part in parts]),
            np.concatenate([part.sigma_0 for part in parts]),
            np.concatenate([part.level for part in parts]),
            np.concatenate([part.cells for part in parts]),
        )

    def of(self, rows: IntArray) -> Findings:
        """Some of them, in a given order."""
        return Findings(
            self.triples[rows], self.points[rows], self.contacts[rows], self.sigma_0[rows],
            self.level[rows], self.cells[rows],
        )  # fmt: skip

    def best_first(self) -> Findings:
        """Sorted by score; equal ones by their features, then as they were found."""
        a, b, c = self.triples.T
        return self.of(np.lexsort((c, b, a, -self.score)))

    def candidates(self) -> tuple[Candidate, ...]:
        """One value each."""
        return tuple(
            Candidate(contacts, (a, b, c), sigma_0, level, level / sigma_0)
            for (a, b, c), contacts, sigma_0, level in zip(
                self.triples.tolist(), self.contacts, self.sigma_0.tolist(), self.level.tolist(),
                strict=True,
            )
        )  # fmt: skip


def apart(contacts: FloatArray, others: FloatArray) -> FloatArray:
    """(n,) root mean square distance of contacts (3, 2) from others (n, 3, 2), in any labelling."""
    turned = np.stack([np.roll(contacts, k, axis=0) for k in range(len(contacts))])
    gap = others[:, None, :, :] - turned[None, :, :, :]
    return np.sqrt((gap**2).sum(axis=3).mean(axis=2)).min(axis=1)


def distinct(contacts: FloatArray, within: float) -> IntArray:
    """Rows of grasps (n, 3, 2), best first, without those that are near a better one, [unit]."""
    left = np.arange(len(contacts))
    kept: list[int] = []
    while len(left):
        kept.append(int(left[0]))
        left = left[apart(contacts[left[0]], contacts[left]) >= within]
    return np.array(kept, np.int64)


def same_idea(outline: Outline, a: FloatArray, b: FloatArray) -> bool:
    """Whether two grasps (3, 2) differ by less than ``_ALIKE``."""
    return bool(apart(a, b[None])[0] < _ALIKE * outline.diameter)


def ideas(contacts: FloatArray, diameter: float) -> Iterator[IntArray]:
    """Rows of grasps (n, 3, 2), best first, that are one idea each; the best idea comes first.

    The first row of an idea is its best; the others differ from it by less than ``_ALIKE``.
    """
    left = np.arange(len(contacts))
    while len(left):
        alike = apart(contacts[left[0]], contacts[left]) < _ALIKE * diameter
        yield left[alike]
        left = left[~alike]


def groups(contacts: FloatArray, diameter: float, most: int) -> list[IntArray]:
    """The first ``most`` ideas."""
    return list(islice(ideas(contacts, diameter), most))
