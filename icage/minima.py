"""All local minima of sigma of one hand shape and the levels at which they merge: the answer."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from icage.arrays import BoolArray, FloatArray, IntArray, read_only
from icage.hand import HandShape
from icage.outline import Outline
from icage.values import Value


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Sublevels(Value):
    """The whole sublevel structure of a hand round an object, as ``icage.sublevels`` finds it.

    One row for each local minimum of sigma that counts [docs/theory.md, Sec. 2.5], by sigma; a
    plateau is one minimum. By the elder rule the higher of two minima ends where their components
    meet; a pinched hand is the deepest of all.

    Attributes
    ----------
    outline, hand:
        The object, and the shape of the hand with point fingers.
    births:
        (m,) sigma of each minimum, [unit], ascending.
    merges:
        (m,) level at which its component meets that of a deeper minimum, or a pinched hand, [unit];
        inf: never.
    into:
        (m,) row of that deeper minimum; -1: a pinched hand, or never.
    contacts:
        (m, 3, 2) fingers at each minimum in the object's frame, [unit].
    """

    outline: Outline
    hand: HandShape
    births: FloatArray
    merges: FloatArray
    into: IntArray
    contacts: FloatArray

    def __post_init__(self) -> None:
        for name in ("births", "merges", "into", "contacts"):
            object.__setattr__(self, name, read_only(getattr(self, name).copy()))

    def __len__(self) -> int:
        return len(self.births)

    def __repr__(self) -> str:
        count = f"{len(self)} {'minimum' if len(self) == 1 else 'minima'}"
        if not len(self):
            return f"<Sublevels: {count}>"
        return f"<Sublevels: {count}, sigma {self.births[0]:.6g} to {self.births[-1]:.6g}>"

    @property
    def depths(self) -> FloatArray:
        """(m,) how far each minimum lies below its merge, [unit]."""
        return self.merges - self.births

    @property
    def escapes(self) -> FloatArray:
        """(m,) sigma_max of each minimum: the level at which it meets a pinched hand, or inf."""
        return read_only(escapes_of(self.merges, self.into))

    @property
    def never_escape(self) -> BoolArray:
        """(m,) which minima no opening of the hand connects with a pinched hand."""
        return np.isinf(self.escapes)


def escapes_of(merges: FloatArray, into: IntArray) -> FloatArray:
    """(m,) level at which minima meet a pinched hand, of what ``Sublevels`` calls so; inf: never.

    Merges only rise from a minimum to the one that it merges into: it is the last of them.
    """
    last = np.arange(len(merges))
    while (into[last] >= 0).any():
        last = np.where(into[last] >= 0, into[last], last)
    return merges[last]
