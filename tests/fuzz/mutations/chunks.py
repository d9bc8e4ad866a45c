"""Faults of PNG and JPEG that pass the first check: sizes, kinds, sums made right again."""

from __future__ import annotations

import struct
import zlib
from random import Random
from typing import Final

_HEAD: Final = b"\x89PNG\r\n\x1a\n"
_CHUNKS: Final = (
    b"tEXt", b"iTXt", b"zTXt", b"pHYs", b"gAMA", b"PLTE", b"tRNS", b"iCCP", b"acTL", b"fcTL",
    b"eXIf", b"XXXX", b"IEND",
)  # fmt: skip
_SIZES: Final = (0, 1, 2, 3, 255, 256, 4_000, 65_535, 100_000, 2**31 - 1, 2**31, 2**32 - 1)


def spoiled(content: bytes, others: tuple[bytes, ...], random: Random) -> bytes:
    """The content with a fault in one chunk or segment."""
    return _png(content, random) if content.startswith(_HEAD) else _jpeg(content, random)


def _png(content: bytes, random: Random) -> bytes:
    chunks: list[tuple[bytes, bytes]] = []
    at = len(_HEAD)
    while at + 8 <= len(content):
        (length,) = struct.unpack(">I", content[at : at + 4])
        chunks.append((content[at + 4 : at + 8], content[at + 8 : at + 8 + length]))
        at += 12 + length
    if not chunks:
        return content
    k = random.randrange(len(chunks))
    kind, body = chunks[k]
    way = random.randrange(6)
    if way == 0 and len(chunks[0][1]) == 13:  # width, height, depth, colour, interlace
        kind, head = chunks[0]
        fields = list(struct.unpack(">IIBBBBB", head))
        j = random.randrange(7)
        fields[j] = (
            random.choice(_SIZES) if j < 2 else random.choice((0, 1, 2, 3, 4, 6, 8, 16, 255))
        )
        chunks[0] = kind, struct.pack(">IIBBBBB", *fields)
    elif way == 1:
        del chunks[k]
    elif way == 2:
        chunks.insert(random.randrange(len(chunks)), (kind, body))
    elif way == 3 and body:
        spoilt = bytearray(body)
        spoilt[random.randrange(len(spoilt))] = random.randrange(256)
        chunks[k] = kind, bytes(spoilt)
    elif way == 4:  # other pixels, packed well, too few or too many
        j = next((j for j, chunk in enumerate(chunks) if chunk[0] == b"IDAT"), 0)
        pixels = random.randbytes(8) * random.choice((1, 100, 10_000, 2_000_000))
        chunks[j] = b"IDAT", zlib.compress(pixels)
    else:
        kind = random.choice(_CHUNKS)
        packed = zlib.compress(b"\0" * random.choice((10, 5_000_000)))
        body = random.choice((b"", random.randbytes(9), b"a\0\0" + packed, b"a\0" + packed))
        chunks.insert(1, (kind, body))
    return _HEAD + b"".join(
        struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
        for kind, body in chunks
    )


def _jpeg(content: bytes, random: Random) -> bytes:
    data = bytearray(content)
    marks = [k for k in range(len(data) - 9) if data[k] == 0xFF and 0xC0 <= data[k + 1] <= 0xFE]
    if not marks:
        return content
    at = random.choice(marks)
    way = random.randrange(4)
    if way == 0:
        data[at + 1] = random.randrange(0xC0, 0xFF)
    elif way == 1:
        data[at + 2 : at + 4] = struct.pack(">H", random.choice((0, 1, 2, 17, 255, 65_535)))
    elif way == 2:
        frames = [k for k in marks if data[k + 1] in (0xC0, 0xC2)] or marks
        k = random.choice(frames)
        data[k + 5 : k + 9] = struct.pack(
            ">HH", random.choice((0, 1, 8, 4_000, 65_535)), random.choice((0, 1, 8, 4_000, 65_535))
        )
    else:
        data[at : at + 2] = random.randbytes(2)
    return bytes(data)
