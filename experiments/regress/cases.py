"""Which cases are run, and with how much effort."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

from icage.errors import InputError
from models import CASES, HARD, grasp_cases

Level = Literal["fast", "default", "full"]

FAST: Final = (
    "T_best",
    "tunnel_golden",
    "rectangle_notcage",
    "disc_hammer",
    "pliers/2_paper_shape",
)
"""Cases of ``--fast``: two derived, one verdict, one with discs of its own, one real tool."""


@dataclass(frozen=True, slots=True)
class Effort:
    """How much is done for a case; 0 leaves a part out.

    Attributes
    ----------
    closings:
        From the guaranteed set, from the rest of the cage and from outside, each; and a shake.
    attacks:
        Of each attacker at each level.
    measuring:
        Attackers that also measure sigma_max.
    second:
        Closings of each set, and random attacks, in the second engine.
    mus:
        [1] Coefficients of friction at which as many hands are closed from below sigma_first(mu).
    """

    level: Level
    closings: int
    attacks: int
    measuring: tuple[str, ...]
    second: int
    mus: tuple[float, ...] = ()


EFFORTS: Final = {
    "fast": Effort("fast", 40, 8, ("guided",), 4, (0.1, 0.4)),
    "default": Effort("default", 100, 24, ("guided",), 6, (0.1, 0.4)),
    "full": Effort("full", 200, 200, ("guided",), 20, (0.05, 0.1, 0.2, 0.4, 0.8)),
}


@dataclass(frozen=True, slots=True)
class Entry:
    """A case to run; ``name`` is its key in the baseline."""

    name: str
    path: Path


def shipped(level: Level) -> tuple[Entry, ...]:
    """The shipped cases: the solved problems, the tools' grasps and the hard ones."""
    solved = [Entry(path.stem, path) for path in sorted(CASES.glob("*.json"))]
    hard = [Entry(f"hard/{path.stem}", path) for path in sorted(HARD.glob("*.json"))]
    tools = [Entry(name, path) for name, path in grasp_cases().items()]
    every = (*solved, *hard, *tools)
    return tuple(e for e in every if e.name in FAST) if level == "fast" else every


def in_folder(folder: Path) -> tuple[Entry, ...]:
    """All case files of a folder.

    Raises
    ------
    InputError:
        There is no such folder, or no ``*.json`` in it.
    """
    if not folder.is_dir():
        raise InputError(f"--cases {str(folder)!r} is not a folder")
    found = tuple(Entry(path.stem, path) for path in sorted(folder.glob("*.json")))
    if not found:
        raise InputError(f"--cases {str(folder)!r} holds no case file (*.json)")
    return found
