"""Faults of any text: its numbers, its words, its lines."""

from __future__ import annotations

import re
from random import Random
from typing import Final

from tests.fuzz.mutations import raw
from tests.fuzz.mutations.values import WORDS, near, scalar

_NUMBER: Final = re.compile(r"(?<![\w/#.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
_WORD: Final = re.compile(r"[A-Za-z_][\w-]*")


def spoiled(content: bytes, others: tuple[bytes, ...], random: Random) -> bytes:
    """The content with one to four such faults; of binary files the numbers."""
    if b"\0" in content:
        return raw.binary(content, others, random)
    text = content.decode("utf-8", "replace")
    for _ in range(random.choice((1, 1, 2, 4))):
        text = random.choice(_WAYS)(text, others, random)
    return text.encode("utf-8", "surrogatepass")


def one_of(pattern: re.Pattern[str], text: str, random: Random) -> re.Match[str] | None:
    """One place where the pattern is found; None if there is none."""
    found = list(pattern.finditer(text))
    return random.choice(found) if found else None


def put(text: str, found: re.Match[str], new: str) -> str:
    """The text with another thing in the place of what was found."""
    return text[: found.start()] + new + text[found.end() :]


def _number(text: str, others: tuple[bytes, ...], random: Random) -> str:
    found = one_of(_NUMBER, text, random)
    if found is None:
        return text
    return put(text, found, near(found[0], random) if random.random() < 0.6 else scalar(random))


def _many_numbers(text: str, others: tuple[bytes, ...], random: Random) -> str:
    """All of them larger or smaller, or as one other is."""
    power, keep = 10.0 ** random.randint(-170, 170), random.random()
    scale = 10.0 ** random.randint(-13, 13) if keep < 0.7 else power

    def changed(found: re.Match[str]) -> str:
        try:
            return repr(float(found[0]) * scale)
        except (ValueError, OverflowError):
            return found[0]

    return _NUMBER.sub(changed, text)


def _word(text: str, others: tuple[bytes, ...], random: Random) -> str:
    found, other = one_of(_WORD, text, random), one_of(_WORD, text, random)
    if found is None or other is None:
        return text
    return put(text, found, random.choice((other[0], other[0].swapcase(), random.choice(WORDS))))


def _lines(text: str, others: tuple[bytes, ...], random: Random) -> str:
    lines = text.splitlines(keepends=True)
    if not lines:
        return text
    k, n = random.randrange(len(lines)), random.choice((1, 1, 2, 5))
    way = random.randrange(5)
    if way == 0:
        del lines[k : k + n]
    elif way == 1:
        lines[k:k] = lines[k : k + n] * random.choice((1, 2, 40))
    elif way == 2:
        j = random.randrange(len(lines))
        lines[k], lines[j] = lines[j], lines[k]
    elif way == 3:
        theirs = random.choice(others).decode("utf-8", "replace").splitlines(keepends=True)
        lines[k:k] = theirs[:n]
    else:
        random.shuffle(lines)
    return "".join(lines)


def _ends(text: str, others: tuple[bytes, ...], random: Random) -> str:
    return random.choice((
        text.replace("\n", "\r\n"), text.replace("\n", "\r"), text.replace("\n", " "),
        "\ufeff" + text, text + "\0", " \n\t" + text, text.upper(), text.lower(),
        text.replace(" ", "\u00a0"), text.replace(",", ";"), text.replace(".", ","),
    ))  # fmt: skip


_WAYS: Final = (_number, _number, _number, _many_numbers, _word, _lines, _ends)
