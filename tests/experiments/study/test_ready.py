"""The committed studies: their pages are what today's code writes, and their pictures are small."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest

from experiments.study.ready.__main__ import OUT, ready
from experiments.study.ready.pages import page_of, write_pages
from experiments.study.run.finished import read_finished
from icage.errors import InputError

DOCS = OUT.parent
SMALL = 75_000
"""[byte] A picture that a page shows."""

NAMES = sorted(one.name for one in ready())


def test_every_ready_study_is_committed() -> None:
    assert sorted(path.parent.name for path in OUT.glob("*/study.json")) == NAMES


@pytest.mark.parametrize("name", NAMES)
def test_its_page_is_what_the_code_writes_today(name: str) -> None:
    """If not: ``python -m experiments.study.ready.pages`` writes them all."""
    page = (OUT / name / "results.md").read_text(encoding="utf-8")
    assert page == page_of(read_finished(OUT / name))


def test_an_old_page_is_seen_and_written_again(tmp_path: Path) -> None:
    for name in NAMES[:2]:
        shutil.copytree(OUT / name, tmp_path / name, ignore=shutil.ignore_patterns("*.parquet"))
    page = tmp_path / NAMES[1] / "results.md"
    new = page.read_text(encoding="utf-8")
    page.write_text(new.replace("closed", "shut"), encoding="utf-8")
    assert write_pages(tmp_path) == [NAMES[1]]
    assert page.read_text(encoding="utf-8") == new
    assert write_pages(tmp_path) == []


@pytest.mark.parametrize(
    ("was", "now"),
    [('"seed": 0', '"seed": "0"'), ('"finished": true', '"finished": false'), ("{", "["),
     ('"name"', '"name": "twice", "name"'), ('"icage-study/1"', '"icage-replay/1"')],
)  # fmt: skip
def test_a_document_that_is_none_of_ours_is_no_page(was: str, now: str, tmp_path: Path) -> None:
    text = (OUT / NAMES[0] / "study.json").read_text(encoding="utf-8")
    folder = tmp_path / NAMES[0]
    folder.mkdir()
    (folder / "study.json").write_text(text.replace(was, now, 1), encoding="utf-8")
    with pytest.raises(InputError):
        read_finished(folder)
    with pytest.raises(InputError):
        write_pages(tmp_path)
    assert sorted(p.name for p in folder.iterdir()) == ["study.json"]


def test_pictures_that_pages_show_are_there_and_small() -> None:
    shown: set[Path] = set()
    for page in DOCS.glob("studies*.md"):
        for link in re.findall(r"\]\(([^)#]+\.(?:svg|png))\)", page.read_text(encoding="utf-8")):
            shown.add((page.parent / link).resolve())
    assert shown
    for path in shown:
        assert path.stat().st_size <= SMALL, path
