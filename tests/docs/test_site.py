"""Where Sphinx is installed, the site is built, warnings as errors; it fetches nothing."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from experiments.environment import ROOT

FETCHED = re.compile(
    r"<(?:script|img|iframe|source|video|embed|object)\b[^>]*?\b(?:src|srcset|data)=\"(?:https?:)?//"
    r"|<link\b(?![^>]*rel=\"(?:canonical|index|search|next|prev)\")[^>]*?\bhref=\"(?:https?:)?//"
    r"|@import\s+(?:url\()?[\"']?(?:https?:)?//|url\([\"']?(?:https?:)?//"
)
"""What a browser would fetch from another host by itself; a link that a reader presses is none."""


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    for needed in ("sphinx", "myst_parser", "furo"):
        pytest.importorskip(needed, reason="the site is optional: pip install icage[docs]")
    out = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "docs", "--here", "--out", str(out)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stdout + done.stderr
    return out


@pytest.mark.slow
def test_the_site_has_every_page_and_fetches_nothing(site: Path):
    pages = list(site.rglob("*.html"))
    assert len(pages) > 60
    for page in [*pages, *site.rglob("*.css")]:
        found = FETCHED.search(page.read_text(encoding="utf-8"))
        assert found is None, f"{page.name}: {found and found[0]}"


@pytest.mark.slow
def test_help_texts_docstrings_and_citations_are_on_the_site(site: Path):
    commands = (site / "docs/commands.html").read_text(encoding="utf-8")
    assert "--friction-figure FILE" in commands
    api = (site / "docs/api.html").read_text(encoding="utf-8")
    assert 'id="icage.Cage.escape_path"' in api
    assert 'id="sim.replay"' in api
    theory = (site / "docs/theory.html").read_text(encoding="utf-8")
    assert re.search(r'href="references.html#bunis2018"', theory)
    assert re.search(r'href="formats.html#icage-query[^"]*">\[docs/formats.md', theory)


@pytest.mark.parametrize(
    "bad",
    [
        '<script src="https://cdn.example/mathjax.js">',
        '<link rel="stylesheet" href="//fonts.example/a.css">',
        "@import url(https://fonts.example/b.css)",
        '<img alt="" src="http://a.example/b.png">',
    ],
)
def test_what_is_fetched_is_found(bad: str):
    assert FETCHED.search(bad)
    assert not FETCHED.search('<a href="https://example.org">there</a><img src="../a.svg">')
