"""Any text as a terminal, a log, a page and a figure can take it.

Names come from files and folders that anybody may have made: control characters, which a terminal
obeys, and marks that turn the direction of reading are shown as escapes, and what a page or a
figure would take for markup stands for itself.
"""

from __future__ import annotations

import re
from typing import Final, TextIO

LONGEST: Final = 800
"""Characters of a line that somebody reads; a file name may be longer."""

_MARKUP: Final = re.compile(r"([\\`*\[\]<>|&$~]|(?<!\w)_|_(?!\w))")
"""What Markdown, and HTML in it, would read; an underscore within a word is none."""


def one_line(message: str) -> str:
    r"""Spaces for line breaks, escapes for what cannot be printed, no middle if it is too long.

    >>> one_line("a bell\n and \x07")
    'a bell and \\x07'
    """
    line = printable(" ".join(message.split()))
    if len(line) > LONGEST:
        line = f"{line[: LONGEST // 2]} ... {line[-LONGEST // 2 :]}"
    return line


def printable(text: str) -> str:
    r"""Escapes for what cannot be printed, line breaks among it.

    >>> printable("red \x1b[31m, backwards \u202e")
    'red \\x1b[31m, backwards \\u202e'
    """
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def markdown(text: str) -> str:
    r"""Text as it stands on a page, whatever is in it.

    >>> print(markdown("pliers/1_best"), markdown("a|b <img> $x$ _y_"))
    pliers/1_best a\|b \<img\> \$x\$ \_y\_
    """
    return _MARKUP.sub(r"\\\1", printable(text))


def in_figure(text: str) -> str:
    r"""Text as it stands in a figure: no mathematics.

    >>> in_figure("$x$ of pliers")
    '\\$x\\$ of pliers'
    """
    return printable(text).replace("$", r"\$")


class PrintableStream:
    """A text stream that writes nothing a terminal would obey, but line breaks and tabs."""

    def __init__(self, stream: TextIO) -> None:
        self.stream = stream

    def write(self, text: str) -> int:
        """All of it, shown."""
        self.stream.write("".join(map(_shown, _BREAKS.split(text))))
        return len(text)

    def writelines(self, lines: list[str]) -> None:
        """One after the other."""
        for line in lines:
            self.write(line)

    def __getattr__(self, name: str) -> object:
        """Everything else is the stream's."""
        return getattr(self.stream, name)


def unguarded(stream: TextIO) -> TextIO:
    """The stream itself, for a progress bar, which has to move about the terminal."""
    return stream.stream if isinstance(stream, PrintableStream) else stream


_BREAKS: Final = re.compile("([\n\t])")


def _shown(part: str) -> str:
    return part if part in ("\n", "\t") else printable(part)
