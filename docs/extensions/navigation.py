"""The table of contents, read from the lists of docs/index.md.

On a forge the index is a page of lists under bold captions. Here each list is the navigation under
that caption, so that order and grouping are written once. A page that the lists lack is found all
the same: a note of the folder of decisions or a result of a study in its place, any other last.
"""

from __future__ import annotations

import re
from pathlib import Path, PurePosixPath
from posixpath import normpath

from sphinx.application import Sphinx

INDEX = "docs/index"
STUDIES = "docs/studies"


def toctree(pages: list[str], caption: str = "", *, hidden: bool = True) -> str:
    """The directive that puts these pages, from the source folder, into the navigation."""
    options = [f":caption: {caption}"] if caption else []
    options += [":hidden:"] if hidden else []
    return "\n".join(["", "```{toctree}", *options, "", *[f"/{page}" for page in pages], "```", ""])


def listed(index: str) -> dict[str, list[str]]:
    """The pages of the site that each list of the index links to, by the list's caption."""
    groups: dict[str, list[str]] = {}
    caption = ""
    for line in index.splitlines():
        heading = re.fullmatch(r"\*\*(.+)\*\*", line)
        if heading:
            caption = heading[1]
            groups[caption] = []
        elif caption and line.startswith("- "):
            links = re.findall(r"\]\(([^)#]+)\.md\)", line)
            groups[caption] += [normpath(PurePosixPath(INDEX).parent / link) for link in links]
    return groups


def contents(index: str, found: set[str]) -> str:
    """All toctrees of the index, for the pages found in the source folder."""
    groups = listed(index)
    taken = {page for pages in groups.values() for page in pages}
    rest = sorted(found - taken - {INDEX})
    studies = {page for page in rest if page.startswith("docs/studies/")}
    decisions = [page for page in rest if page.startswith("docs/decisions/")]
    groups.setdefault("Decisions", []).extend(decisions)
    groups.setdefault("Further", []).extend(set(rest) - studies - set(decisions))
    return "".join(toctree(pages, caption) for caption, pages in groups.items() if pages)


def add_contents(app: Sphinx, page: str, text: list[str]) -> None:
    """Append what the navigation needs to the pages that lead to others."""
    found = set(app.env.found_docs)
    if page == INDEX:
        text[0] += contents(text[0], found)
    elif page == STUDIES:
        results = sorted(one for one in found if one.startswith("docs/studies/"))
        text[0] += toctree(results) if results else ""


def front_door(app: Sphinx, failed: Exception | None) -> None:
    """``index.html`` of the folder leads to the index, which stands in ``docs`` like its source."""
    if failed is None and app.builder.name == "html":
        door = '<!doctype html><meta charset="utf-8"><title>icage</title>'
        door += f'<meta http-equiv="refresh" content="0; url={INDEX}.html">'
        door += f'<a href="{INDEX}.html">The documents of icage</a>\n'
        (Path(app.outdir) / "index.html").write_text(door, encoding="utf-8")


def setup(app: Sphinx) -> dict[str, bool]:
    """Called by Sphinx."""
    app.connect("source-read", add_contents)
    app.connect("build-finished", front_door)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
