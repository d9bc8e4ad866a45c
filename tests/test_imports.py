"""Which way imports point where import-linter does not look: benchmarks use tests, never back."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from experiments.environment import ROOT

PACKAGES = ("icage", "sim", "models", "experiments")


def imported(path: Path) -> Iterator[str]:
    """Modules that a file names in its imports, also inside functions; relative ones whole."""
    package = path.relative_to(ROOT).parent.parts
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (one.name for one in node.names)
        elif isinstance(node, ast.ImportFrom):
            above = package[: len(package) - node.level + 1] if node.level else ()
            start = ".".join([*above, *([node.module] if node.module else [])])
            yield start
            yield from (f"{start}.{one.name}" for one in node.names)


def wrong(folder: str, *roots: str) -> list[str]:
    """Imports of these packages in the files of a folder."""
    return [
        f"{path.relative_to(ROOT)}: {name}"
        for path in sorted((ROOT / folder).rglob("*.py"))
        for name in imported(path)
        if name.split(".")[0] in roots
    ]


def test_no_test_imports_a_benchmark():
    assert not wrong("tests", "benchmarks")


@pytest.mark.parametrize("package", PACKAGES)
def test_what_is_shipped_imports_neither(package: str):
    assert not wrong(package, "benchmarks", "tests")


def test_oracles_are_independent_of_what_they_check():
    """All but those that compare the program with itself, and say so by their folder."""
    lines = wrong("tests/oracles", "icage", "sim", "experiments")
    independent = [line for line in lines if "/against_itself/" not in line]
    assert len(independent) < len(lines)
    assert [line for line in independent if not re.search(r": icage\.(hand|outline)\b", line)] == []


def test_an_import_is_seen_in_all_its_forms(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(f"{__name__}.ROOT", tmp_path)
    file = tmp_path / "tests" / "inner" / "test_it.py"
    file.parent.mkdir(parents=True)
    for line in (
        "import benchmarks", "import benchmarks.kills as k", "from benchmarks import kills",
        "def f():\n    from benchmarks.kills import survive", "from ...benchmarks import kills",
    ):  # fmt: skip
        file.write_text(line)
        assert wrong("tests", "benchmarks"), line
    file.write_text("import numpy\nfrom tests.oracles import kills\nfrom . import benchmarks")
    assert not wrong("tests", "benchmarks")
