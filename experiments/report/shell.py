"""Commands that play a failure again, as a shell takes them."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from typing import Final

from experiments.report.given import Given

_OPTIONS: Final = (
    "--width", "--unit", "--tolerance", "--pick", "--strokes", "--gap", "--safe", "--layers",
    "--section", "--axis", "--threshold", "--no-background", "--finger-radius", "--grasp",
)  # fmt: skip
"""Options of a case that a document may name; anything else in its place is no option of ours."""


def quoted(word: str) -> str:
    r"""A word of a command line, whatever is in it; marks that nobody sees as escapes of bash.

    >>> quoted("out/pliers"), quoted("my run"), quoted("a\u202eb"), quoted("-x")
    ('out/pliers', "'my run'", "$'a\\u202eb'", './-x')
    """
    if word.startswith("-"):
        word = f"./{word}"
    if word.isprintable():
        return shlex.quote(word)
    inside = "".join(_escaped(c) for c in word)
    return f"$'{inside}'"


def _escaped(character: str) -> str:
    if character in "'\\":
        return f"\\{character}"
    if character.isprintable():
        return character
    code = ord(character)
    if 0xDC80 <= code <= 0xDCFF:  # a byte of a name that is no UTF-8
        return f"\\x{code - 0xDC00:02x}"
    return (
        f"\\x{code:02x}" if code < 0x80 else f"\\U{code:08x}" if code > 0xFFFF else f"\\u{code:04x}"
    )


def replay_trial(folder: str, index: int) -> str:
    """The command that closes one recorded trial again."""
    return f"icage replay-trial {quoted(folder)} {index}"


def of_case(command: str, document: Given, options: Sequence[str]) -> str:
    """A command on the case that a document was made of; ``CASE`` where it does not say."""
    given = document.maybe_part("given")
    words = [command]
    if given is None:
        words.append("CASE")
    else:
        words.append(quoted(given.text("case")))
        for word in given.texts("options") if given.has("options") else ():
            words.append(word if word in _OPTIONS else _value(word))
    return " ".join([*words, *map(shlex.quote, options)])


def _value(word: str) -> str:
    """A value of an option: a number below zero is none."""
    try:
        float(word)
    except ValueError:
        return quoted(word)
    return shlex.quote(word)
