"""The live page as one text, made as the page in a file is, and the policy it is served with."""

from __future__ import annotations

from html import escape
from typing import Any, Final

from experiments.explore.page_html import (
    TEMPLATE,
    data_text,
    inlined_modules,
    style_text,
)
from experiments.io.page_policy import page_policy

LIVE_MODULES: Final = (
    "asking.js", "track.js", "contact_stage.js", "contact_card.js", "proposals.js",
    "finger_size.js", "keeping.js", "closing.js", "live.js",
)  # fmt: skip
"""Files of the module that only the live page has, each after those that it imports."""

_START: Final = """
const data = JSON.parse(document.getElementById("icage-data").textContent);
window.icage = mountLive(document.getElementById("icage"), data);
"""


def live_page(data: dict[str, Any]) -> tuple[bytes, str]:
    """The page and its Content-Security-Policy: one script, one style, questions to its server."""
    script, style = inlined_modules(LIVE_MODULES) + _START, style_text()
    asked = ("connect-src 'self'", "img-src 'self'", "frame-ancestors 'none'")
    policy = page_policy(script, style, *asked)
    html = TEMPLATE.format(
        policy="",
        title=escape(f"{data['name']}: choose contacts, see the cage, close the hand"),
        style=style,
        summary="The live page of icage.",
        data=data_text(data),
        script=script,
    )
    return html.encode("utf-8"), policy
