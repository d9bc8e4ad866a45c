"""Pictures and videos that lie beside a document: on the page, or left out and said."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Final
from urllib.parse import quote
from xml.etree import ElementTree

from experiments.io.own_files import DamagedError, UnreadableError, open_own, read_own
from experiments.report.content import Film, Part, Picture, Words

LARGEST_PICTURE: Final = 3_000_000
LARGEST_VIDEO: Final = 8_000_000
"""[byte] Larger ones are not put into the page, which would no longer open at once."""

_SVG: Final = "{http://www.w3.org/2000/svg}svg"
_PNG: Final = b"\x89PNG\r\n\x1a\n"


def picture(folder: Path, name: str, title: str, words: str) -> list[Part]:
    """A picture of the folder; nothing if there is none, a sentence if it is no use.

    A picture stands in the page as an image: a browser runs no script in it and loads nothing for
    it, whatever is in the file.
    """
    if not os.path.lexists(folder / name):
        return []
    try:
        data = read_own(folder / name, LARGEST_PICTURE)
        media = _media(data, name)
    except (UnreadableError, DamagedError) as error:
        return [Words(f"A picture is left out: {error}.")]
    return [Picture(title, media, data, words)]


def _media(data: bytes, name: str) -> str:
    if data.startswith(_PNG):
        return "image/png"
    try:
        if b"<!ENTITY" in data:
            raise DamagedError(f"{name} is no picture of ours")
        root = ElementTree.fromstring(data)
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise DamagedError(f"{name} is damaged: {error}") from error
    if root.tag != _SVG:
        raise DamagedError(f"{name} is no SVG")
    return "image/svg+xml"


def film(folder: Path, name: str, page: Path, embed: int = LARGEST_VIDEO) -> list[Part]:
    """A video of the folder: in the page up to ``embed`` bytes, else a link from ``page`` to it."""
    path = folder / name
    if not os.path.lexists(path):
        return []
    try:
        with open_own(path) as stream:
            size = os.fstat(stream.fileno()).st_size
            head = stream.read(12)
    except (OSError, UnreadableError) as error:
        return [Words(f"The video is left out: {error}.")]
    if head[4:8] != b"ftyp":
        return [Words(f"The video is left out: {name} is no MP4.")]
    link = quote(os.path.relpath(path.resolve(), page.parent.resolve()).replace(os.sep, "/"))
    if size > embed:
        words = (
            f"{name}, {size / 1e6:.1f} MB, is not in this page (up to {embed / 1e6:g} MB are): the "
            "link works while it lies where it did."
        )
        return [Film(name, link, None, words)]
    try:
        data = read_own(path, embed)
    except (UnreadableError, DamagedError) as error:
        return [Words(f"The video is left out: {error}.")]
    return [Film(name, link, data, f"{name}, {size / 1e6:.1f} MB, is in this page.")]
