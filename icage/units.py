"""Units that lengths of a case may be in."""

from __future__ import annotations

from typing import Final, Literal, TypeAlias

Unit: TypeAlias = Literal["m", "mm", "cm"]

UNITS: Final[tuple[Unit, ...]] = ("m", "mm", "cm")

METRES: Final[dict[str, float]] = {"m": 1.0, "mm": 1e-3, "cm": 1e-2}
"""[m] One of each."""
