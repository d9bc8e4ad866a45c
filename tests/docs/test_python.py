"""All Python on the pages is run: examples say what they say there, other code runs to its end."""

from __future__ import annotations

import contextlib
import doctest
import io
import re
from pathlib import Path

import pytest

from experiments.environment import ROOT
from tests.docs.blocks import blocks, name, with_blocks

PAGES = [page for page in with_blocks("python") if name(page) != "README.md"]
"""The README's is run in tests/experiments/commands/test_docs.py, where its output is looked at."""
NOT_HERE = {"docs/cluster.md": "needs a Slurm cluster and dask-jobqueue"}
"""Pages whose code is compiled only, and why."""
NEEDS = {"docs/explore.md": "anywidget"}
FLAGS = doctest.IGNORE_EXCEPTION_DETAIL | doctest.NORMALIZE_WHITESPACE


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_the_python_of_a_page_is_true(page: Path, monkeypatch: pytest.MonkeyPatch):
    if name(page) in NEEDS:
        pytest.importorskip(NEEDS[name(page)], reason=f"{NEEDS[name(page)]} is optional")
    monkeypatch.chdir(ROOT)
    text = page.read_text(encoding="utf-8")
    found = doctest.testfile(str(page), module_relative=False, optionflags=FLAGS)
    assert found.failed == 0
    plain = [block for block in blocks(page, "python") if ">>>" not in block.text]
    assert found.attempted or plain
    names: dict[str, object] = {}
    for block in plain:
        code = compile(block.text, str(block), "exec")
        if name(page) not in NOT_HERE:
            with contextlib.redirect_stdout(io.StringIO()):
                exec(code, names)
    assert len(re.findall(r"^>>>", text, re.MULTILINE)) <= found.attempted


def test_pages_that_are_compiled_only_are_still_there():
    assert set(NOT_HERE) | set(NEEDS) <= {name(page) for page in PAGES}
