"""Every console on a page is run, in the page's order, and prints what the page shows."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.docs.blocks import name, with_blocks
from tests.docs.console import same, wrong

PAGES = with_blocks("console")


@pytest.mark.slow
@pytest.mark.parametrize("page", PAGES, ids=name)
def test_consoles_print_what_is_shown(page: Path, tmp_path: Path):
    """Half a minute of one core for all of them: they search, plan, close and study."""
    assert not wrong(page, tmp_path)


@pytest.mark.parametrize(
    ("shown", "printed"),
    [
        ("sigma 50.44187 mm", "sigma 50.44188 mm"),
        ("one\n...\nfour", "one\ntwo\nthree\nfour"),
        ("...", ""),
        ("deepest 3.7e-07", "deepest 5.1e-07"),
    ],
)
def test_what_counts_as_the_same(shown: str, printed: str):
    assert same(shown, printed)


@pytest.mark.parametrize(
    ("shown", "printed"),
    [
        ("sigma 50.44 mm", "sigma 50.49 mm"),
        ("sigma 50.44 mm", "sigma 50.44 cm"),
        ("one\ntwo", "one"),
        ("one\n...\nfour", "one\ntwo\nthree"),
        ("", "a warning"),
        ("99 of 100", "98 of 100"),
    ],
)
def test_what_does_not(shown: str, printed: str):
    assert not same(shown, printed)
