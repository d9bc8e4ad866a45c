"""A report as one HTML text that stands alone, and a policy that lets nothing else in.

Every text is escaped where it is put in, marks that nobody sees are shown as escapes, and a name
that is written from right to left is kept apart from what surrounds it. Without a script the page
is whole, but for sorting and filtering.
"""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterator
from html import escape
from pathlib import Path
from typing import Final

import icage
from experiments.io.one_line import printable
from experiments.io.page_policy import page_policy
from experiments.report.chart_html import chart_html
from experiments.report.content import (
    Cell,
    Chart,
    Column,
    Command,
    Film,
    Part,
    Picture,
    Report,
    Section,
    Table,
    Words,
)

PAGE: Final = Path(__file__).parent / "page"

MARK: Final = '<meta name="generator" content="icage report">'
"""By which a page of ours is known."""

_KINDS: Final = {
    "replay": "closings from placements in the cage",
    "study": "a study of errors",
    "regress": "the planner against physics",
    "escape": "attacks on the cage",
    "shake": "the closed hand, shaken",
    "jams": "friction",
}

_FILTER_FROM: Final = 6
"""Rows from which on a table has a field to filter it."""


def page_html(report: Report) -> str:
    """The page of a report."""
    script = (PAGE / "report.js").read_text(encoding="utf-8")
    style = (PAGE / "report.css").read_text(encoding="utf-8")
    numbers = iter(range(1, 1_000_000))
    return _TEMPLATE.format(
        policy=page_policy(script, style, "img-src data:", "media-src data:"),
        mark=MARK,
        title=shown(f"{report.title}: {_KINDS[report.kind]}"),
        style=style,
        name=f"<bdi>{shown(report.title)}</bdi>",
        kind=_KINDS[report.kind],
        badge=_badge(report.held),
        answer=_isolated(report.answer, report.title),
        facts="".join(
            f"<div><dt>{shown(name)}</dt><dd><bdi>{shown(value)}</bdi></dd></div>"
            for name, value in report.facts
        ),
        contents="".join(
            f'<li><a href="#part-{k}">{shown(section.title)}</a></li>'
            for k, section in enumerate(report.sections, 1)
        ),
        sections="".join(
            _section(section, k, numbers) for k, section in enumerate(report.sections, 1)
        ),
        version=shown(icage.__version__),
        script=script,
    )


def shown(text: str) -> str:
    """A text as HTML, whatever is in it."""
    return escape(printable(text))


def _worded(text: str) -> str:
    """A sentence in which what stands between backticks is code."""
    parts = shown(text).split("`")
    if len(parts) % 2 == 0:
        return "`".join(parts)
    return "".join(f"<code>{part}</code>" if k % 2 else part for k, part in enumerate(parts))


def _isolated(text: str, name: str) -> str:
    """A sentence in which the direction of a name touches nothing around it."""
    if not name:
        return shown(text)
    return f"<bdi>{shown(name)}</bdi>".join(shown(part) for part in text.split(name))


def _badge(held: bool | None) -> str:
    if held is None:
        return ""
    words = "✓ everything checked held" if held else "✗ not everything held"
    return f'<p class="badge {"good" if held else "bad"}">{words}</p>'


def _section(section: Section, k: int, numbers: Iterator[int]) -> str:
    inside = "".join(_part(part, numbers) for part in section.parts)
    return f'<section id="part-{k}"><h2>{shown(section.title)}</h2>{inside}</section>'


def _part(part: Part, numbers: Iterator[int]) -> str:
    match part:
        case Words():
            return f"<p>{_worded(part.text)}</p>"
        case Command():
            return f"<p>{_worded(part.words)}</p><pre><code>{shown(part.line)}</code></pre>"
        case Table():
            return _table(part, next(numbers))
        case Chart():
            return chart_html(part, shown)
        case Picture():
            return _picture(part)
        case Film():
            return _film(part)


def _table(table: Table, k: int) -> str:
    heads = "".join(
        f'<th scope="col" data-kind="{one.kind}">{shown(one.name)}</th>' for one in table.columns
    )
    rows = "".join(_row(row, table.columns) for row in table.rows)
    filtered = ' data-filter=""' if len(table.rows) >= _FILTER_FROM else ""
    left = ""
    if table.left_off:
        left = (
            f'<p class="note">{len(table.rows)} rows are shown, {table.left_off} more are left '
            f"off: {shown(table.more_in)} has all.</p>"
        )
    beside = f'<p class="note">{_worded(table.beside)}</p>' if table.beside else ""
    return (
        f'<div class="table"{filtered}><h3 id="table-{k}">{shown(table.title)}</h3>'
        f'<div class="scroll" role="region" aria-labelledby="table-{k}" tabindex="0">'
        f'<table aria-labelledby="table-{k}"><thead><tr>{heads}</tr></thead>'
        f"<tbody>{rows}</tbody></table></div>{left}{beside}</div>"
    )


def _row(row: tuple[Cell, ...], columns: tuple[Column, ...]) -> str:
    cells: list[str] = []
    for k, (cell, column) in enumerate(zip(row, columns, strict=True)):
        key = "" if cell.key is None else f' data-key="{cell.key!r}"'
        text = shown(cell.text)
        text = f"<code>{text}</code>" if column.kind == "command" else f"<bdi>{text}</bdi>"
        tag, more = ("th", ' scope="row"') if k == 0 else ("td", "")
        cells.append(f'<{tag}{more} class="{column.kind}"{key}>{text}</{tag}>')
    return f"<tr>{''.join(cells)}</tr>"


def _picture(picture: Picture) -> str:
    data = b64encode(picture.data).decode("ascii")
    return (
        f'<figure class="paper"><img alt="{shown(picture.title)}" '
        f'src="data:{picture.media};base64,{data}">'
        f"<figcaption><b>{shown(picture.title)}.</b> {shown(picture.words)}</figcaption></figure>"
    )


def _film(film: Film) -> str:
    if film.data is None:
        return (
            f'<p>The video: <a href="{shown(film.link)}">{shown(film.name)}</a>. '
            f"{shown(film.words)}</p>"
        )
    data = b64encode(film.data).decode("ascii")
    return (
        f'<figure class="film"><video controls preload="metadata" aria-label="{shown(film.name)}" '
        f'src="data:video/mp4;base64,{data}"></video>'
        f"<figcaption>{shown(film.words)}</figcaption></figure>"
    )


_TEMPLATE: Final = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
{mark}
<meta http-equiv="Content-Security-Policy" content="{policy}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>{title}</title>
<style>{style}</style>
</head>
<body class="report">
<a class="skip" href="#part-1">To the results</a>
<header>
<p class="kind">{kind}</p>
<h1>{name}</h1>
{badge}
<p class="answer">{answer}</p>
<dl class="facts">{facts}</dl>
<nav aria-label="Contents"><ul>{contents}</ul></nav>
</header>
<main>{sections}</main>
<footer><p class="note">Written by icage {version}. This page asks nobody for anything.</p></footer>
<script>{script}</script>
</body>
</html>
"""
