"""One server for the tests of a module."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from experiments.explore.live.server import LiveServer
from icage.formats.load import load
from tests.experiments.explore.live.asking import served


@pytest.fixture(scope="module")
def pliers() -> Iterator[LiveServer]:
    """The live page of the pliers."""
    with served(load("pliers"), friction=(0.0, 0.2)) as server:
        yield server
