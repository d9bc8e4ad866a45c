"""What one target of a sweep showed: how much several ways to the same levels differ."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

TOLERANCE = 1e-7
"""[1] Two ways to the same level disagree if they differ by more than this (relative)."""


@dataclass(slots=True)
class Outcome:
    """What one target showed. ``opening`` = sigma_max / sigma_0 where both exist."""

    number: int
    family: str
    runs: int = 0
    opening: float | None = None
    verdict: str = "cage"
    worst: float = 0.0
    disagreements: list[str] = field(default_factory=list)
    exceptions: list[str] = field(default_factory=list)

    worst_of: dict[str, float] = field(default_factory=dict)
    """The worst difference within each tolerance, where there are several."""

    def add(self, what: str, difference: float, tolerance: float = TOLERANCE) -> None:
        """Note how much one more way to the same levels differs."""
        self.runs += 1
        if difference > tolerance:
            self.disagreements.append(f"{what}: {difference:.3g}")
            return
        self.worst = max(self.worst, difference)
        if tolerance != TOLERANCE:
            key = f"{tolerance:g}"
            self.worst_of[key] = max(self.worst_of.get(key, 0.0), difference)


Judge = Callable[[int, int], Outcome]
"""(seed, number of the target) -> Outcome."""
