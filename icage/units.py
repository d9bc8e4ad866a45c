"""Units that lengths of a case may be in."""

from __future__ import annotations

from typing import Final, Literal, TypeAlias

Unit: TypeAlias = Literal["m", "mm", "cm"]

UNITS: Final[tuple[Unit, ...]] = ("m", "mm", "cm")
