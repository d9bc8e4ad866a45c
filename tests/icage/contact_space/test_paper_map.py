"""docs/paper_map.md and the tags in the code say the same, both ways."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
TAG = re.compile(r"\[Bunis2018, ([^\]]+)\]")
ROW = re.compile(r"^\| ([^|]+) \| ([^|]+) \| `([^`]+)`([^|]*) \| `([^`]+)` \|", re.MULTILINE)


def tags_in(path: Path) -> set[str]:
    text = " ".join(path.read_text().split())  # a tag may be broken by a line's end
    return {tag for tags in TAG.findall(text) for tag in tags.split(", ")}


def tags_in_the_code() -> dict[str, set[str]]:
    files = [p for folder in ("icage", "sim", "experiments") for p in (ROOT / folder).rglob("*.py")]
    found: dict[str, set[str]] = {}
    for path in files:
        for tag in tags_in(path):
            found.setdefault(tag, set()).add(path.relative_to(ROOT).as_posix())
    return found


MAP = (ROOT / "docs" / "paper_map.md").read_text()


def rows(text: str = MAP) -> dict[str, tuple[str, str, str]]:
    """Tag -> file, names in it, test."""
    return {
        tag.strip(): (file, names.strip(), test) for tag, _, file, names, test in ROW.findall(text)
    }


def tags_without_a_row(text: str = MAP) -> set[str]:
    return tags_in_the_code().keys() - rows(text).keys()


def test_every_tag_of_the_code_has_a_row() -> None:
    assert not tags_without_a_row()


def test_every_item_of_the_paper_has_a_row() -> None:
    items = {f"Def. {k}" for k in range(1, 10)} | {f"Eq. ({k})" for k in range(1, 6)}
    items |= {"Lemma 4.1", "Prop. 4.2", "Lemma 4.3", "Lemma 4.4", "Thm. 1"}
    items |= {f"Fig. {k}" for k in range(2, 9)}
    assert items <= rows().keys()


@pytest.mark.parametrize("tag", sorted(rows()))
def test_every_row_leads_to_its_tag_and_test(tag: str) -> None:
    file, names, test = rows()[tag]
    assert tag in tags_in(ROOT / file), f"{file} does not name {tag}"
    source = (ROOT / file).read_text()
    for name in names.split():
        assert re.search(rf"^(class|def) {name}\b", source, re.MULTILINE), (file, name)
    assert (ROOT / test).is_file()


@pytest.mark.parametrize("tag", ["Eq. (4)", "Lemma 4.1"])
def test_a_missing_row_is_seen(tag: str) -> None:
    lines = [line for line in MAP.splitlines() if not line.startswith(f"| {tag} ")]
    assert tags_without_a_row("\n".join(lines)) == {tag}
