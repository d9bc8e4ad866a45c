"""Faults of DXF: group codes and their values, entities, sections."""

from __future__ import annotations

from random import Random
from typing import Final

from tests.fuzz.mutations.values import WORDS, near, scalar

Tag = list[str]

_ENTITIES: Final = (
    "LINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE", "LWPOLYLINE", "POLYLINE", "VERTEX", "SEQEND",
    "INSERT", "HATCH", "SOLID", "TEXT", "3DFACE", "REGION", "ATTRIB", "DIMENSION", "ENDSEC", "EOF",
    "SECTION", "BLOCK", "ENDBLK", "TABLE", "LAYER", "POINT", "XLINE", "MESH", "NOSUCH",
)  # fmt: skip


def spoiled(content: bytes, others: tuple[bytes, ...], random: Random) -> bytes:
    """The content with one to six such faults, more in its entities than elsewhere."""
    lines = content.decode("latin-1").replace("\r\n", "\n").split("\n")
    tags = [[code, value] for code, value in zip(lines[::2], lines[1::2], strict=False)]
    places = [k for k, tag in enumerate(tags) if tag[1].strip() == "ENTITIES"]
    for _ in range(random.choice((1, 1, 2, 3, 6))):
        if not tags:
            break
        first = places[-1] if places and random.random() < 0.7 and places[-1] < len(tags) else 0
        random.choice(_WAYS)(tags, random.randrange(first, len(tags)), random)
    return (
        "\n".join(f"{code}\n{value}" for code, value in tags).encode("latin-1", "replace") + b"\n"
    )


def _value(tags: list[Tag], k: int, random: Random) -> None:
    if tags[k][0].strip() == "0":
        tags[k][1] = random.choice(_ENTITIES)
    elif tags[k][0].strip() in ("2", "8", "6", "3", "7"):
        others = [tag[1] for tag in tags if tag[0].strip() in ("2", "8")]
        tags[k][1] = random.choice((*WORDS, *others))
    else:
        tags[k][1] = near(tags[k][1], random) if random.random() < 0.6 else scalar(random)


def _code(tags: list[Tag], k: int, random: Random) -> None:
    tags[k][0] = str(random.choice((
        0, 1, 2, 5, 8, 9, 10, 11, 20, 21, 30, 40, 41, 42, 43, 50, 51, 62, 66, 67, 70, 71, 72, 73,
        74, 90, 91, 100, 210, 220, 230, 330, 999, 1000, 1071, -1, 99999, "", "x",
    )))  # fmt: skip


def _lose(tags: list[Tag], k: int, random: Random) -> None:
    del tags[k : k + random.choice((1, 1, 2, 6, 40))]


def _double(tags: list[Tag], k: int, random: Random) -> None:
    span = [list(tag) for tag in tags[k : k + random.choice((1, 2, 6, 20))]]
    tags[k:k] = span * random.choice((1, 1, 3, 100))


def _swap(tags: list[Tag], k: int, random: Random) -> None:
    j = random.randrange(len(tags))
    tags[k], tags[j] = tags[j], tags[k]


def _put_in(tags: list[Tag], k: int, random: Random) -> None:
    code = random.choice(("10", "20", "40", "41", "42", "43", "50", "62", "66", "67", "70", "210"))
    tags[k:k] = [[code, scalar(random)]]


def _insert(tags: list[Tag], k: int, random: Random) -> None:
    """A block that stands in the drawing, or in itself."""
    blocks = [tag[1] for tag in tags if tag[0].strip() == "2"]
    tags[k:k] = [["0", "INSERT"], ["8", "0"], ["2", random.choice((*blocks, "A"))],
                 ["10", scalar(random)], ["20", "0"], ["41", scalar(random)],
                 ["70", scalar(random)], ["44", "1"]]  # fmt: skip


_WAYS: Final = (_value, _value, _value, _value, _code, _lose, _double, _swap, _put_in, _insert)
