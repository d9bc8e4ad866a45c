"""Links between pages lead to a file that is there, and to a heading of it, without Sphinx."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from experiments.environment import ROOT
from tests.docs.blocks import FENCE, name, pages

LINK = re.compile(r"\]\(([^)\s]+)\)")
INLINE = re.compile(r"(``|`)[^`\n]*\1")


def slug(heading: str) -> str:
    """The anchor that a forge, and the site, give a heading."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def anchors(page: Path) -> set[str]:
    text = FENCE.sub("", page.read_text(encoding="utf-8")).replace("`", "")
    return {slug(heading.strip()) for heading in re.findall(r"^#+ (.+)$", text, re.MULTILINE)}


def broken(page: Path, text: str) -> list[str]:
    """Relative links of a page that lead nowhere, or out of the checkout."""
    found: list[str] = []
    for link in LINK.findall(INLINE.sub("", FENCE.sub("", text))):
        if link.startswith(("https://", "http://", "mailto:")):
            continue
        path, _, anchor = link.partition("#")
        target = (page.parent / path).resolve() if path else page
        there = target.is_file() and target.is_relative_to(ROOT)
        if not there or (anchor and anchor not in anchors(target)):
            found.append(link)
    return found


@pytest.mark.parametrize("page", pages(), ids=name)
def test_links_lead_somewhere(page: Path):
    assert not broken(page, page.read_text(encoding="utf-8"))


@pytest.mark.parametrize(
    "link", ["nowhere.md", "theory.md#no-such-heading", "../../outside.md", "#nor-here", "studies/"]
)
def test_a_planted_link_is_found(link: str):
    assert broken(ROOT / "docs/index.md", f"See [there]({link}).") == [link]


def test_right_links_pass():
    text = "[a](theory.md#32-cells-and-passes) [b](formats.md#exit-codes) [c](../README.md) [d](https://a.b)"
    assert not broken(ROOT / "docs/index.md", text)
