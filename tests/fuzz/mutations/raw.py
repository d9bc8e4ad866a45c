"""Bytes flipped, lost, doubled, moved; an input cut off, or grown together with another one."""

from __future__ import annotations

import math
import struct
from random import Random
from typing import Final

LONGEST: Final = 300_000
"""[byte] No mutation makes more of an input: files of the largest size are tests of their own."""


def spoiled(content: bytes, others: tuple[bytes, ...], random: Random) -> bytes:
    """The content with one to eight such faults."""
    data = bytearray(content)
    for _ in range(random.choice((1, 1, 1, 2, 3, 8))):
        random.choice(_WAYS)(data, others, random)
    return bytes(data[:LONGEST])


def _span(data: bytearray, random: Random) -> slice:
    start = random.randrange(len(data) + 1)
    return slice(start, min(start + int(2.0 ** random.uniform(0, 10)), len(data)))


def _flip(data: bytearray, others: tuple[bytes, ...], random: Random) -> None:
    if data:
        data[random.randrange(len(data))] ^= 1 << random.randrange(8)


def _replace(data: bytearray, others: tuple[bytes, ...], random: Random) -> None:
    if data:
        data[random.randrange(len(data))] = random.choice((0, 9, 10, 32, 34, 45, 48, 127, 128, 255))


def _lose(data: bytearray, others: tuple[bytes, ...], random: Random) -> None:
    del data[_span(data, random)]


def _double(data: bytearray, others: tuple[bytes, ...], random: Random) -> None:
    span = _span(data, random)
    data[span] = data[span] * random.choice((2, 2, 3, 50))


def _put_in(data: bytearray, others: tuple[bytes, ...], random: Random) -> None:
    at = random.randrange(len(data) + 1)
    data[at:at] = random.randbytes(random.randint(1, 12))


def _cut_off(data: bytearray, others: tuple[bytes, ...], random: Random) -> None:
    del data[random.randrange(len(data) + 1) :]


def _splice(data: bytearray, others: tuple[bytes, ...], random: Random) -> None:
    other = random.choice(others)
    data[random.randrange(len(data) + 1) :] = other[random.randrange(len(other) + 1) :]


def _move(data: bytearray, others: tuple[bytes, ...], random: Random) -> None:
    span = _span(data, random)
    piece = data[span]
    del data[span]
    at = random.randrange(len(data) + 1)
    data[at:at] = piece


def binary(content: bytes, others: tuple[bytes, ...], random: Random) -> bytes:
    """Numbers of four or eight bytes replaced, where they stand one after another."""
    data = bytearray(content)
    for _ in range(random.choice((1, 1, 2, 5))):
        form = random.choice(_FORMS)
        size = struct.calcsize(form)
        if len(data) < size + 4:
            break
        at = random.choice((random.randrange(len(data) - size), 80, 84, 96, 100))
        at = min(at, len(data) - size)
        values = _FLOATS if form[-1] in "fd" else _WHOLE
        data[at : at + size] = struct.pack(form, random.choice(values))
    return bytes(data)


_FORMS: Final = ("<f", "<f", "<f", "<I", "<d", ">f", "<H")
_FLOATS: Final = (0.0, -0.0, 1.0, -1.0, 1e-45, 1e-38, 1e38, -3e38, 1e12, 1e-12, 9.000001,
                  math.inf, -math.inf, math.nan)  # fmt: skip
_WHOLE: Final = (0, 1, 2, 3, 49, 50, 51, 255, 1_000, 65_535)

_WAYS: Final = (_flip, _replace, _lose, _double, _put_in, _cut_off, _splice, _move)
