"""Mutants that can change no answer, each with its reason: ``equivalent.json``."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, Final

LISTED: Final = Path(__file__).with_name("equivalent.json")


def reasons(mutants: dict[tuple[str, str, str], list[str]]) -> dict[str, str]:
    """By the name of each listed mutant why it is equivalent.

    ``mutants`` are the names of all by file and function, text of the line, and change; several
    if a line has the same change several times: ``nth`` says which of them, from 0.

    Raises
    ------
    LookupError:
        A listed one is not among them: the function was edited, the reason may hold no longer.
    """
    found: dict[str, str] = {}
    for entry in _entries():
        key = (str(entry["in"]), str(entry["line"]), str(entry["change"]))
        names = mutants.get(key, [])
        nth = entry.get("nth", range(len(names)))
        for k in [nth] if isinstance(nth, int) else nth:
            if k >= len(names):
                raise LookupError(f"{LISTED.name}: there is no such mutant: {entry}")
            found[names[k]] = str(entry["why"])
        if not names:
            raise LookupError(f"{LISTED.name}: there is no such mutant: {entry}")
    return found


def _entries() -> list[dict[str, Any]]:
    return list(json.loads(LISTED.read_text(encoding="utf-8")))
