"""Parts of pages that are made when the site is: help texts and docstrings cannot go stale there.

On a forge such a place is a comment in the page's source, ``<!-- site: commands -->``, beside which
the page says how to see the same without the site.
"""

from __future__ import annotations

import argparse
import os
import re
from collections.abc import Callable

from docutils import nodes
from sphinx import addnodes
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment
from sphinx.util.nodes import make_refnode

MARK = re.compile(r"^<!-- site: (.+) -->$", re.MULTILINE)


def commands() -> str:
    """``icage COMMAND --help`` of every command, under a heading each."""
    from experiments.cli import parser

    os.environ["COLUMNS"] = "88"
    (action,) = (a for a in parser()._actions if isinstance(a, argparse._SubParsersAction))
    parts: list[str] = []
    for name, command in sorted(action.choices.items()):
        parts += [f"## icage {name}", "", "```text", command.format_help().rstrip(), "```", ""]
    return "\n".join(parts)


def members(names: str) -> str:
    """The docstrings of these names, ``module name name ...``."""
    module, *found = names.split()
    parts = ["```{eval-rst}", f".. py:currentmodule:: {module}", ""]
    for name in found:
        kind = "autoclass" if name[0].isupper() else "autofunction"
        kind = "autoexception" if name.endswith("Error") else kind
        parts += [f".. {kind}:: {module}.{name}", ""]
    return "\n".join([*parts, "```"])


def made(found: re.Match[str]) -> str:
    """What stands in the place of one comment."""
    kind, _, rest = found[1].partition(" ")
    makers: dict[str, Callable[[], str]] = {
        "commands": commands,
        "members": lambda: members(rest),
    }
    return makers[kind]()


def fill(app: Sphinx, page: str, text: list[str]) -> None:
    """Put what is made into a page, before it is read."""
    text[0] = MARK.sub(made, text[0])


ITEM = re.compile(r"\w[\w, *]*:$")


def plain_docstring(
    app: Sphinx, what: str, name: str, value: object, options: object, lines: list[str]
) -> None:
    """Tell napoleon what our docstrings mean, before it reads them.

    Items of a section stand as ``name:``, which numpydoc writes without the colon; and a sentence
    with a colon under an attribute is a sentence, no type: an empty comment before it says so.
    """
    inside = False
    for k, line in enumerate(lines):
        underlined = k + 1 < len(lines) and re.fullmatch(r"-{3,}", lines[k + 1])
        inside = bool(underlined) or inside
        if inside and ITEM.fullmatch(line):
            lines[k] = line[:-1]
    if what in ("attribute", "data", "property") and not inside:
        lines[:0] = ["..", ""]


def plain_signature(
    app: Sphinx,
    what: str,
    name: str,
    value: object,
    options: object,
    takes: str | None,
    gives: str | None,
) -> tuple[str, str | None] | None:
    """Names of array types as they are written, without what Sphinx wraps them in."""
    if takes is None:
        return None
    wrapped = re.compile(r"TypeAliasForwardRef\('(\w+)'\)")
    return wrapped.sub(r"\1", takes), gives and wrapped.sub(r"\1", gives)


def link_of_error(
    app: Sphinx, env: BuildEnvironment, wanted: addnodes.pending_xref, text: nodes.TextElement
) -> nodes.reference | None:
    """Docstrings name an error without its module."""
    name = wanted["reftarget"]
    if wanted.get("reftype") != "exc" or "." in name:
        return None
    for module in ("icage.errors", "icage.sampling"):
        found = env.domains.python_domain.objects.get(f"{module}.{name}")
        if found is not None:
            page, anchor = found.docname, found.node_id
            return make_refnode(app.builder, wanted["refdoc"], page, anchor, text, name)
    return None


def setup(app: Sphinx) -> dict[str, bool]:
    """Called by Sphinx."""
    app.connect("source-read", fill)
    app.connect("autodoc-process-docstring", plain_docstring, priority=100)
    app.connect("autodoc-process-signature", plain_signature)
    app.connect("missing-reference", link_of_error)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
