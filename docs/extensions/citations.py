"""Bracketed citations, ``[docs/theory.md, Sec. 4]`` or ``[Bunis2018, Eq. (3)]``, become links.

They are plain text on a forge and in the code's docstrings; tests/test_citations.py sees to it that
each leads somewhere. Here each is a link to that section, or to the paper in the references.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from docutils import nodes
from sphinx.application import Sphinx

CITATION = re.compile(
    r"\[(?P<page>docs/[\w/-]+)\.md(?:,\s(?P<places>[^\[\]]+))?\]"
    r"|\[(?P<key>[A-Z][A-Za-z]*\d{4}[a-z]?)(?:,\s[^\[\]]+)?\]"
)
REFERENCES = "docs/references"


def headings(app: Sphinx, page: str) -> Iterator[tuple[str, str]]:
    """Text and anchor of every heading of a page."""
    for link in app.env.tocs[page].findall(nodes.reference):
        yield " ".join(link.astext().split()), link["anchorname"]


def anchor_of(app: Sphinx, page: str, places: str) -> str:
    """The anchor of the first place cited: a section by its number, or a heading by its begin."""
    for heading, anchor in headings(app, page):
        number = re.match(r"[\d.]*\d", heading)
        first = places.split(", ")[0]
        if number and first == f"Sec. {number[0]}":
            return anchor
        if heading == places or heading.startswith(f"{places} "):
            return anchor
    return ""


def link(app: Sphinx, here: str, found: re.Match[str]) -> nodes.Node:
    """The link of one citation; a page that this site has not stays plain text."""
    page, anchor = found["page"], ""
    if found["key"]:
        page, anchor = REFERENCES, f"#{found['key'].lower()}"
    if page not in app.env.found_docs:
        return nodes.Text(found[0])
    if found["places"]:
        anchor = anchor_of(app, page, " ".join(found["places"].split()))
    uri = app.builder.get_relative_uri(here, page) + anchor
    return nodes.reference("", found[0], refuri=uri, internal=True)


def with_links(app: Sphinx, here: str, text: str) -> list[nodes.Node]:
    """A text cut at its citations, each of them a link."""
    parts: list[nodes.Node] = []
    at = 0
    for found in CITATION.finditer(text):
        parts += [nodes.Text(text[at : found.start()]), link(app, here, found)]
        at = found.end()
    return [*parts, nodes.Text(text[at:])] if parts else []


def link_citations(app: Sphinx, page: nodes.document, here: str) -> None:
    """Put links where a page or a docstring cites; what is code or a link already stays."""
    closed = (nodes.literal, nodes.literal_block, nodes.reference, nodes.title)
    for text in list(page.findall(nodes.Text)):
        above = text.parent
        while above is not None and not isinstance(above, closed):
            above = above.parent
        parts = [] if above is not None else with_links(app, here, text.astext())
        if parts and text.parent is not None:
            text.parent.replace(text, parts)


def anchor_references(app: Sphinx, page: str, text: list[str]) -> None:
    """Give each entry of the references its key as an anchor."""
    if page == REFERENCES:
        text[0] = re.sub(
            r"^- \*\*\[(\w+)\]\*\*",
            lambda entry: f'- <span id="{entry[1].lower()}"></span>**[{entry[1]}]**',
            text[0],
            flags=re.MULTILINE,
        )


def setup(app: Sphinx) -> dict[str, bool]:
    """Called by Sphinx."""
    app.connect("source-read", anchor_references)
    app.connect("doctree-resolved", link_citations)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
