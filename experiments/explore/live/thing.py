"""The object of a live page, as it goes from one process to another, and questions about it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Final

import numpy as np

from icage.arrays import FloatArray
from icage.case import Case
from icage.errors import InputError
from icage.formats.json_text import a_number, points, required
from icage.outline import Outline

MOST_CONTACTS: Final = 16
"""Contacts that are read; how many a hand may have is for the planner to say."""


@dataclass(frozen=True)
class Thing:
    """What does not change while the page is open; ``tolerance`` [unit] is the drawing's."""

    name: str
    unit: Any
    vertices: FloatArray
    tolerance: float = 0.0

    @cached_property
    def outline(self) -> Outline:
        """The object, checked once in each process."""
        return Outline(self.vertices)

    def case(self, radius: float, contacts: FloatArray | None = None) -> Case:
        """The object with fingers of some radius and, perhaps, a grasp."""
        bare = Case(self.name, self.unit, self.outline, radius)
        return bare if contacts is None else replace(bare, target=contacts)

    def case_asked(self, question: dict[str, Any]) -> Case:
        """The case of a question with ``radius`` and ``contacts``."""
        return self.case(question["radius"], np.array(question["contacts"], dtype=np.float64))


def asked_radius(body: dict[str, Any], key: str = "radius") -> float:
    """A finger radius in a question, [unit].

    Raises
    ------
    InputError:
        It is none.
    """
    radius = a_number(required(body, key, "the question"), key)
    if radius < 0.0:
        raise InputError(f"{key} is {radius:g}; 0 or more is needed")
    return radius


def asked_contacts(body: dict[str, Any]) -> list[list[float]]:
    """Finger centres in a question, [unit].

    Raises
    ------
    InputError:
        They are no list of points.
    """
    value = required(body, "contacts", "the question")
    return points(value, "contacts", least=2, most=MOST_CONTACTS).tolist()
