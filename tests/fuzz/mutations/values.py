"""Values that somebody forgot: the ends of the numbers, and what is no number at all."""

from __future__ import annotations

from random import Random
from typing import Final

NUMBERS: Final = (
    "0", "-0", "-0.0", "1", "-1", "0.1", "1e-5", "1e-9", "1e-12", "1e-13", "1e-16", "1e-160",
    "1e-162", "1e-300", "2.2250738585072014e-308", "4.9e-324", "1e-400", "1e5", "1e9", "1e12",
    "1.0000001e12", "1e15", "1e16", "1e77", "1e154", "1e155", "1e200", "1e307", "1e308",
    "1.7976931348623157e308", "-1e308", "1e309", "1e999", "255", "256", "65535", "65536",
    "2147483647", "2147483648", "-2147483649", "4294967296", "9007199254740993",
    "9223372036854775807", "9223372036854775808", "18446744073709551616", "1" + "0" * 400,
    "9" * 5000, "0.30000000000000004", "0." + "0" * 400 + "1", "1." + "3" * 900,
)  # fmt: skip
"""Of ordinary size first: an input that is refused at once tries nothing behind the border."""

ORDINARY: Final = 18
"""The first so many are read by everything that reads numbers."""

NO_NUMBERS: Final = (
    "NaN", "nan", "-nan", "inf", "-Infinity", "1e", "e5", "0x10", "1_000", "1,5", "--1", "+", ".",
    "", " ", "null", "true", "١٢", "１", "1\u00a0000", "1\x00", "%s", "${a}", "\x1b[31m", "\u202e",
)  # fmt: skip

WORDS: Final = (
    "", " ", "a", "A" * 100, "x" * 5000, "../../etc", "/dev/null", ".", "..", "\n", "\r\n", "\t",
    "\\", '"', "'", "<b>", "&amp;", "|", "`", "$(a)", "\x1b[2J", "\u202e", "\ufeff", "\U0001f527",
    "e\u0301", "\ud7ff", "con", "nul", "-", "--", "=", "#", "None", "True", "[]", "{}",
)  # fmt: skip


def number(random: Random) -> str:
    """A number that is hard, mostly one that everything reads."""
    return random.choice(NUMBERS[:ORDINARY] if random.random() < 0.5 else NUMBERS)


def scalar(random: Random) -> str:
    """A number, or what is none."""
    return number(random) if random.random() < 0.7 else random.choice(NO_NUMBERS)


def near(text: str, random: Random) -> str:
    """A number near another one, or of another size."""
    try:
        value = float(text)
    except ValueError:
        return scalar(random)
    way = random.randrange(6)
    if way == 0:
        return repr(-value)
    if way == 1:
        return repr(value * 10.0 ** random.randint(-14, 14))
    if way == 2:
        return repr(value * (1.0 + random.choice((1, -1)) * 10.0 ** random.randint(-16, -1)))
    if way == 3:
        return repr(value + random.choice((1, -1)) * 10.0 ** random.randint(-16, 3))
    if way == 4:
        return f"{value:.{random.randint(0, 6)}g}"
    return scalar(random)
