"""The page as one text: data, style and one module inlined, and a policy that lets nothing else in.

The scripts of ``page/`` import one another as modules do. Inlined they are one module: the lines of
their imports are dropped, and every name at their top is theirs alone.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import Any, Final

from experiments.io.page_policy import page_policy
from icage.errors import InputError
from icage.formats.json_out import json_text

PAGE: Final = Path(__file__).parent / "page"

MODULES: Final = (
    "svg.js", "query.js", "hand.js", "words.js", "verdict.js", "scale.js", "view.js", "gestures.js",
    "slice.js", "stage.js", "route.js", "places.js", "friction.js", "numbers.js", "texts.js",
    "explore.js",
)  # fmt: skip
"""Files of the module, each after those that it imports."""

LARGEST: Final = 8_000_000
"""Characters of a page: a phone still opens it at once, and a letter carries it."""

_IMPORT = re.compile(r"^import \{[^}]*\} from \"\./[a-z_]+\.js\";\n", re.MULTILINE)
_EXPORT = re.compile(r"^export (?=(?:async )?(?:function|const|class) )", re.MULTILINE)

_START = """
const data = JSON.parse(document.getElementById("icage-data").textContent);
window.icage = mount(document.getElementById("icage"), data);
"""


def module_text() -> str:
    """The page's module without exports: a function ``mount(element, data)`` and what it needs."""
    return inlined_modules(())


def inlined_modules(more: Sequence[str]) -> str:
    """The page's module and more files of ``page/``, each after those that it imports."""
    return "\n".join(_inlined(name) for name in (*MODULES, *more))


def style_text() -> str:
    """The page's style sheet."""
    return (PAGE / "page.css").read_text(encoding="utf-8")


def page_html(document: dict[str, Any], summary: str) -> str:
    """The page of a document, as ``explore_document`` makes it.

    ``summary`` stands there where no scripts run. Whatever a name holds is text: the data cannot
    end its element, and the policy runs no script but this one.

    Raises
    ------
    InputError:
        The page would have more than ``LARGEST`` characters.
    """
    script, style = module_text() + _START, style_text()
    name = document["plan"]["name"] or "object"
    html = TEMPLATE.format(
        policy=_META.format(page_policy(script, style)),
        title=escape(f"{name}: how far may the hand open?"),
        style=style,
        summary=escape(summary),
        data=data_text(document),
        script=script,
    )
    if len(html) > LARGEST:
        raise InputError(
            f"the page of {name} would have {len(html) / 1e6:.1f} million characters; up to "
            f"{LARGEST / 1e6:g} million are allowed: simplify the outline (--tolerance)"
        )
    return html


def _inlined(name: str) -> str:
    text = (PAGE / name).read_text(encoding="utf-8")
    return _EXPORT.sub("", _IMPORT.sub("", text))


def data_text(document: dict[str, Any]) -> str:
    """JSON without a character that could end its element or begin another."""
    text = json_text(document)
    for character in "<>&\u2028\u2029":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return text


_META: Final = """<meta http-equiv="Content-Security-Policy" content="{}">
"""

TEMPLATE: Final = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
{policy}<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>{title}</title>
<style>{style}</style>
</head>
<body>
<div id="icage" class="icage"><noscript><pre>{summary}</pre>
<p>This page answers by a script, which does not run here.</p></noscript></div>
<script type="application/json" id="icage-data">{data}</script>
<script type="module">{script}</script>
</body>
</html>
"""
"""Of every page; what stands in braces is put in."""
