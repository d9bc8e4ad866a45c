"""What all tests share: the solved problems, and hypothesis made repeatable."""

from __future__ import annotations

import os
from typing import Any

import pytest
from hypothesis import HealthCheck, settings

# tests compile what they need themselves: no process works on behind them
os.environ["ICAGE_COMPILE_BEHIND"] = "0"

settings.register_profile(
    "repeatable",
    derandomize=True,
    deadline=None,
    database=None,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile("repeatable")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """What is marked ``first`` comes first; all else stays in its order."""
    items.sort(key=lambda item: item.get_closest_marker("first") is None)


@pytest.fixture
def square() -> dict[str, Any]:
    """A case on the unit square that every parser accepts, as parsed JSON."""
    return {
        "format": "icage-case/1",
        "name": "square",
        "unit": "mm",
        "outline": {"vertices": [[0, 0], [1, 0], [1, 1], [0, 1]]},
        "finger_radius": 0.0,
        "grasp": {"contacts": [[0, 0.5], [1, 0.25], [1, 0.75]]},
    }
