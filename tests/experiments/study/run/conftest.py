"""Studies in folders of their own."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.experiments.study.studies import Studied


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """For studies that are left alone, each run once."""
    return tmp_path_factory.mktemp("studies")


@pytest.fixture
def study(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Studied:
    """One that a test runs and spoils."""
    return Studied(tmp_path / "out", capsys)
