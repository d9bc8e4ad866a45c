"""Data of the shipped objects and of the hand, and the one loader that finds it."""

from __future__ import annotations

from pathlib import Path

OBJECTS = Path(__file__).resolve().parent / "objects"
CASES = Path(__file__).resolve().parent / "cases"
"""Solved problems: what the planner is checked against."""
HARD = Path(__file__).resolve().parent / "hard"
"""Cages with disc fingers that are hard on planner or physics."""
FRICTION = Path(__file__).resolve().parent / "friction"
"""Grasps of the shipped objects that keep most of their guarantee with friction."""
HAND = Path(__file__).resolve().parent / "hand"


def object_names() -> tuple[str, ...]:
    """Names of the shipped objects.

    >>> object_names()
    ('pliers', 'saw', 'wrench')
    """
    return tuple(sorted(file.parent.name for file in OBJECTS.glob("*/outline.json")))


def outline_path(name: str) -> Path:
    """Case file without a grasp: the outline of a shipped object and the command that made it."""
    return _folder(name) / "outline.json"


def case_paths(name: str) -> tuple[Path, ...]:
    """Case files of a shipped object's documented grasps, in the order of its README."""
    return tuple(sorted((_folder(name) / "cases").glob("*.json")))


def case_path(name: str) -> Path:
    """Case file of a shipped object's first grasp."""
    return case_paths(name)[0]


def grasp_cases() -> dict[str, Path]:
    """Name to case file of every documented grasp of a shipped object.

    >>> list(grasp_cases())[:2]
    ['pliers/1_best', 'pliers/2_paper_shape']
    """
    return {f"{name}/{path.stem}": path for name in object_names() for path in case_paths(name)}


def _folder(name: str) -> Path:
    if name not in object_names():
        raise KeyError(f"no shipped object {name!r}; there are {', '.join(object_names())}")
    return OBJECTS / name
