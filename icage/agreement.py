"""Do two methods say the same about a target? Our own."""

from __future__ import annotations

from icage.cage import Cage

AGREEMENT = 1e-7
"""[1] Levels of two methods may differ by this much (relative)."""


def difference(a: float | None, b: float | None) -> float:
    """Relative difference of two levels; inf if only one of them exists."""
    if a is None or b is None:
        return 0.0 if a is b else float("inf")
    return abs(a - b) / max(abs(a), abs(b))


def disagreements(a: Cage, b: Cage, tolerance: float = AGREEMENT) -> list[str]:
    """What two cages of the same target differ in, one line each; empty if they agree."""
    found: list[str] = []
    if a.status != b.status:
        found.append(f"verdict: {a.status} against {b.status}")
    for name in ("sigma_0", "sigma_first", "sigma_max"):
        one, other = getattr(a, name), getattr(b, name)
        off = difference(one, other)
        if off > tolerance:
            found.append(f"{name}: {_shown(one)} against {_shown(other)} ({off:.2g} relative)")
    found += _bounds_missed(a, b, tolerance)
    return found


def _bounds_missed(a: Cage, b: Cage, tolerance: float) -> list[str]:
    """Where one cage bounds the escape level by less than what the other one has for it.

    A bound is any value above the level that a polygon proves, and each method has polygons of its
    own: two bounds need not be the same, but each has to hold for both.
    """
    found: list[str] = []
    for one, other in ((a, b), (b, a)):
        bound, level = one.sigma_max_upper, other.sigma_max
        if (bound is None) != (other.sigma_max_upper is None) or (
            bound is not None and level is not None and bound < level * (1.0 - tolerance)
        ):
            bounds = f"{_shown(bound)} against {_shown(other.sigma_max_upper)}"
            found.append(f"sigma_max_upper: {bounds}, sigma_max {_shown(level)}")
    return found


def _shown(level: float | None) -> str:
    return "none" if level is None else f"{level:.12g}"
