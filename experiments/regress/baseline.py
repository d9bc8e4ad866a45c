"""What was committed, and how far a run may be from it.

The planner is exact and is held to 1e-7. Physics comes out the same from the same seed on one kind
of machine; on another a closing that starts on the edge of two basins may end in the other.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Final

from experiments.regress.cases import Level
from icage.errors import InputError

FORMAT: Final = "icage-regress-baseline/1"
FOLDER: Final = Path(__file__).parent / "baselines"

Tolerance = tuple[str, float]
"""("relative" or "absolute" or "share of the trials" or "factor", how much)."""

EXACT: Final[Tolerance] = ("absolute", 0.0)

TOLERANCES: Final[tuple[tuple[str, Tolerance], ...]] = (
    ("planner.", ("relative", 1e-7)),
    ("physical.", ("relative", 1e-6)),
    ("closings.guaranteed.target", EXACT),
    ("closings.", ("share", 0.05)),
    ("attacks.guided.measured", ("relative", 1e-3)),
    ("attacks.random.measured", ("relative", 5e-2)),
    ("attacks.rigid.measured", ("relative", 1e-3)),
    ("attacks.penetration", ("factor", 1.5)),
    ("attacks.below", ("relative", 1e-6)),
    ("attacks.above", ("relative", 1e-6)),
    ("attacks.time_step", EXACT),
    ("attacks.solref", EXACT),
    ("attacks.rigid.above", ("share", 0.5)),
    ("attacks.random.above", ("share", 0.5)),
    ("attacks.", ("share", 0.05)),
    ("shake.play_over_law", ("relative", 0.02)),
    ("shake.", EXACT),
    ("second.", ("share", 0.2)),
    ("friction.sigma_first", ("relative", 1e-6)),
    ("friction.mu", EXACT),
    ("friction.stray", EXACT),
    ("friction.", ("share", 0.05)),
)
"""By the beginning of a key, first match; a key that none matches must be equal."""

_IGNORED: Final = ("failures", "position_error", "angle_error", "rate_upper_95", "why")
"""Words of keys that are printed but not compared: errors have limits of their own."""


def baseline_path(level: Level) -> Path:
    """The committed file."""
    return FOLDER / f"{level}.json"


def read_baseline(path: Path) -> dict[str, Any]:
    """Cases by name; empty if there is no such file.

    Raises
    ------
    InputError:
        The file is none of ours.
    """
    if not path.exists():
        return {}
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except ValueError as error:
        raise InputError(f"{path} is not JSON: {error}") from error
    if not isinstance(document, dict) or document.get("format") != FORMAT:
        raise InputError(f"{path} is not a baseline of format {FORMAT}")
    return dict(document["cases"])


def baseline_document(rows: list[dict[str, Any]], effort: dict[str, Any]) -> dict[str, Any]:
    """What is committed of a run."""
    cases = {
        row["case"]: {k: v for k, v in row.items() if k not in ("case", "failures")} for row in rows
    }
    return {"format": FORMAT, "effort": effort, "cases": cases}


def differences(row: Mapping[str, Any], was: Mapping[str, Any]) -> list[str]:
    """Where a row is farther from its baseline than it may be, a line each."""
    return [
        f"{key}: {_short(now)}, in the baseline {_short(then)}"
        for key, now, then, trials in _pairs("", row, was)
        if not _within(key, now, then, trials)
    ]


def _pairs(
    prefix: str, now: Any, then: Any, trials: float = 1.0
) -> Iterator[tuple[str, Any, Any, float]]:
    """Leaves of the baseline beside those of the row; keys that only the row has are no matter."""
    if isinstance(now, dict) and isinstance(then, dict):
        trials = then.get("trials", then.get("attacks", trials))
        for key, value in then.items():
            if not any(word in key for word in _IGNORED):
                yield from _pairs(f"{prefix}{key}.", now.get(key), value, trials)
    elif isinstance(now, list) and isinstance(then, list) and len(now) == len(then):
        for a, b in zip(now, then, strict=True):
            yield from _pairs(prefix, a, b, trials)
    elif prefix.startswith("second.") and (now is None or then is None):
        return  # not installed, here or there
    else:
        yield prefix.rstrip("."), now, then, trials


def _within(key: str, now: Any, then: Any, trials: float) -> bool:
    if now == then:
        return True
    numbers = (int, float)
    if not (isinstance(now, numbers) and isinstance(then, numbers)):
        return False
    if isinstance(now, bool) or isinstance(then, bool):
        return False
    kind, limit = next((t for start, t in TOLERANCES if key.startswith(start)), EXACT)
    if key.endswith("penetration"):
        kind, limit = "factor", 1.5
    off = abs(now - then)
    if kind == "relative":
        return off <= limit * abs(then)
    if kind == "share":
        return off <= max(limit * trials, 1.0)
    if kind == "factor":
        return now <= max(limit * then, 1e-4)
    return off <= limit


def _short(value: Any) -> str:
    return f"{value:.10g}" if isinstance(value, float) else str(value)
