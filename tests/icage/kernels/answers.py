"""What the planner answers on small objects, all of it, as plain numbers.

``python -m tests.icage.kernels.answers`` records them anew: where an answer was meant to change.
"""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Callable
from enum import Enum
from functools import cache
from pathlib import Path
from typing import Any, Final

import numpy as np

import icage
from icage.cage import Cage
from icage.cells.membership import query
from icage.grasps.of_one_hand import grasps_of_hand
from icage.hand import HandShape
from icage.outline import Outline
from icage.planner import plan
from icage.sampling import draw_starts
from tests.oracles.geometry import Floats
from tests.oracles.polygons import FAMILIES
from tests.oracles.targets import random_target

RECORDED: Final = Path(__file__).with_name("answers.json")

OBJECTS: Final = {
    **{f"{family}-{seed}": (family, seed, 0.0) for family in sorted(FAMILIES) for seed in (1, 2)},
    **{f"{family}-disc": (family, 5, 0.03) for family in sorted(FAMILIES)},
}
"""Random polygons with a grasp, for points and for discs: family, seed, radius [diameter]."""

SIZES: Final = {1: 1.0, 2: 40.0, 5: 0.2}
"""By seed, times what the oracles draw: a length that is left out is not hidden by being one."""

SEARCHED: Final = {
    "triangle": [[0, 0], [1, 0], [0.4, 0.8]],
    "notched": [[0, 0], [4, 0], [4, 2], [2, 1], [0, 2]],
}
"""Outlines whose best grasps are searched."""

HANDS: Final = 40


@cache
def cage_of(name: str) -> Cage:
    """The plan of one of the objects."""
    return plan(*_target(name))


def _target(name: str) -> tuple[Floats, Floats, float]:
    """Vertices, contacts and radius of one of the objects, somewhere in the plane."""
    family, seed, radius = OBJECTS[name]
    size = SIZES[seed]
    target = random_target(np.random.default_rng(seed), family, radius)
    away = size * np.array([3.0, -0.7])
    return size * target.vertices + away, size * target.contacts + away, size * target.radius


def _plan(name: str) -> Any:
    cage = cage_of(name)
    return [cage.status, cage.sigma_0, cage.sigma_first, cage.sigma_max, cage.sigma_max_upper,
            cage.sigma_max_lower, cage.grasps, cage.punctures, cage.escape_path]  # fmt: skip


def _by_the_paper(name: str) -> Any:
    cage = cage_of(name)
    other = plan(cage.outline, cage.contacts, cage.finger_radius, method="contact-space")
    return [other.status, other.sigma_first, other.sigma_max, other.grasps, other.punctures]


def _moved(name: str) -> Any:
    """Contacts that are off by nearly as much as is allowed."""
    vertices, contacts, radius = _target(name)
    off = 3e-7 * cage_of(name).outline.diameter
    cage = plan(vertices, contacts + off * np.array([[1, -1], [-1, 0], [0, 1]]), radius)
    return [cage.status, cage.sigma_0, cage.sigma_first, cage.sigma_max, cage.contacts]


def _regions(name: str) -> Any:
    found = cage_of(name).regions("sigma_first")
    return [[shape.area, shape.length, shape.bounds, shape.centroid.coords[0]] for shape in found]


def _query(name: str) -> Any:
    cage = cage_of(name)
    rng = np.random.default_rng(7)
    rows = np.tile(cage.target_placement.as_array(), (HANDS, 1))
    rows[:, :2] += 0.02 * cage.outline.diameter * rng.normal(size=(HANDS, 2))
    rows[:, 2] += 0.05 * rng.normal(size=HANDS)
    rows[:, 3] *= rng.uniform(0.98, 1.3, HANDS)
    found = query(cage, rows)
    return [found.verdict, found.in_cage, found.margin]


def _starts(name: str) -> Any:
    return draw_starts(cage_of(name), "guaranteed", 5, np.random.default_rng(3))


def _friction(name: str) -> Any:
    return cage_of(name).friction(0.2)


def _place(name: str) -> Any:
    return icage.place(cage_of(name), opening_error=True)


def _grasps_of_its_hand(name: str) -> Any:
    cage = cage_of(name)
    outline = cage.outline
    return grasps_of_hand(outline, HandShape.from_contacts(cage.contacts))


def _sublevels(name: str) -> Any:
    cage = cage_of(name)
    return icage.sublevels(cage.outline, cage.hand)


def _search(name: str) -> Any:
    outline = Outline(SIZES[2] * np.array(SEARCHED[name]))
    return [case.contacts for case in icage.load(outline).grasps(top=2)]


ASKED: Final[dict[str, Callable[[str], Any]]] = {
    "plan": _plan, "moved": _moved, "paper": _by_the_paper, "regions": _regions, "query": _query,
    "starts": _starts, "friction": _friction, "place": _place, "hand": _grasps_of_its_hand,
}  # fmt: skip


def questions() -> list[tuple[str, str]]:
    """What is asked, and of which object."""
    whole = [("sublevels", name) for name in OBJECTS if name.endswith("-1")]
    found = [("search", name) for name in SEARCHED]
    return [(asked, name) for asked in ASKED for name in OBJECTS] + whole + found


def answer(asked: str, name: str) -> Any:
    """The answer as plain numbers and words; of a question that is refused, which error."""
    try:
        return told({**ASKED, "sublevels": _sublevels, "search": _search}[asked](name))
    except icage.errors.IcageError as error:
        return type(error).__name__


def told(value: Any) -> Any:
    """Numbers and words of a value, and of what it holds."""
    if isinstance(value, np.ndarray):
        return told(value.tolist())
    if isinstance(value, Enum | np.generic):
        return told(value.value if isinstance(value, Enum) else value.item())
    if isinstance(value, complex):
        return [value.real, value.imag]
    if value is None or isinstance(value, str | bool | int | float):
        return value if not isinstance(value, float) else _digits(value)
    if isinstance(value, dict):
        return [[told(key), told(inner)] for key, inner in value.items()]
    if isinstance(value, list | tuple):
        return [told(inner) for inner in value]
    if isinstance(value, Outline | HandShape | Cage):
        return type(value).__name__
    if dataclasses.is_dataclass(value):
        names = [field.name for field in dataclasses.fields(value) if field.name[0] != "_"]
        return [[name, told(getattr(value, name))] for name in names]
    return type(value).__name__


def _digits(value: float) -> float | str:
    """Thirteen of them; no number as a word, for JSON has none."""
    return float(f"{value:.13g}") if np.isfinite(value) else repr(value)


if __name__ == "__main__":
    found = {f"{asked} {name}": answer(asked, name) for asked, name in questions()}
    lines = (f" {json.dumps(key)}: {json.dumps(value)}" for key, value in found.items())
    RECORDED.write_text("{\n" + ",\n".join(lines) + "\n}\n")
