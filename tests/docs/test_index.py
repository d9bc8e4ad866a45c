"""The index leads to every page, and every page begins by saying what it is for."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from experiments.environment import ROOT
from tests.docs.blocks import name, pages

DOCS = ROOT / "docs"
WRITTEN = [page for page in pages() if page.is_relative_to(DOCS) and "studies" not in page.parts]


@pytest.mark.parametrize("page", [p for p in WRITTEN if p.name != "index.md"], ids=name)
def test_the_index_lists_the_page(page: Path):
    """Nobody finds a page that the index lacks: give it a line there, what it is for."""
    index = (DOCS / "index.md").read_text(encoding="utf-8")
    assert f"]({page.relative_to(DOCS).as_posix()})" in index


@pytest.mark.parametrize("page", WRITTEN, ids=name)
def test_a_page_begins_with_a_title_and_a_sentence(page: Path):
    title, first, *_ = re.split(r"\n\s*\n", page.read_text(encoding="utf-8"), maxsplit=2)
    assert re.fullmatch(r"# \S.*", title)
    assert len(first) > 8
