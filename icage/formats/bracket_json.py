"""The bounds of a drawing's levels in a plan's document, and as lines to read."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

from icage.bracket import Bracket


def bracket_document(bounds: Bracket) -> dict[str, Any]:
    """``bracket`` of a plan; lengths in the case's unit."""
    return asdict(bounds)


def bracket_summary(bounds: Bracket, unit: str) -> Iterator[str]:
    """A line for a reader."""
    least, most = (
        "none" if level is None else f"{level:.9g}" for level in (bounds.lower, bounds.upper)
    )
    yield (
        f"bracket      sigma_max of the drawing itself: {least} to {most} {unit} (outlines inside "
        f"and around it, at most {bounds.tolerance:.3g} {unit} off)"
    )
