"""Any text as one line that a terminal, a log and a table can take."""

from __future__ import annotations

from typing import Final

LONGEST: Final = 800
"""Characters of a line that somebody reads; a file name may be longer."""


def one_line(message: str) -> str:
    r"""Spaces for line breaks, escapes for what cannot be printed, no middle if it is too long.

    >>> one_line("a bell\n and \x07")
    'a bell and \\x07'
    """
    line = " ".join(message.split())
    line = "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in line)
    if len(line) > LONGEST:
        line = f"{line[: LONGEST // 2]} ... {line[-LONGEST // 2 :]}"
    return line
