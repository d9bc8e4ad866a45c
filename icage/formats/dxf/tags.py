"""From the bytes of a DXF file to a document of ezdxf, within limits, without a word of its own.

A DXF file is a list of tags, pairs of a group code and a value. They are counted before ezdxf sees
them, because it needs some 10 microseconds and a few hundred bytes for each.
"""

from __future__ import annotations

import io
import logging
from collections.abc import Callable, Generator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, Final

from icage.errors import FormatError

MAX_TAGS: Final = 500_000
"""Pairs of a group code and a value in a file."""

MAX_STRUCTURES: Final = 60_000
"""Entities, objects, table entries: tags of group code 0."""

BINARY: Final = b"AutoCAD Binary DXF\r\n\x1a\x00"
"""A binary file begins with it."""

_SAME_FILE: Final = "save it again as DXF (ASCII, R2000 or later)"


@dataclass(frozen=True, slots=True, eq=False)
class Document:
    """What a file holds.

    Attributes
    ----------
    content:
        The document of ezdxf.
    insunits:
        $INSUNITS as the file has it; ezdxf would make one up. None if it has none.
    notes:
        Warnings, a sentence each.
    """

    content: Any
    insunits: int | None
    notes: tuple[str, ...]


def document(content: bytes) -> Document:
    """The document in the bytes of a DXF file.

    Raises
    ------
    FormatError:
        No DXF, cut off, too large, or so broken that ezdxf cannot read it.
    """
    if content.startswith(b"AC10") and b"\0" in content[:40]:
        raise FormatError("this is a DWG drawing, which is not read: save it as DXF")
    if content.startswith(BINARY):
        return _binary(content)
    return _text(content)


def _text(content: bytes) -> Document:
    from ezdxf.filemanagement import read

    text = content.decode("latin-1").replace("\r\n", "\n").replace("\r", "\n")
    if text.count("\n") > 2 * MAX_TAGS:
        raise _too_large("tags", MAX_TAGS)
    lines = text.removeprefix("\xef\xbb\xbf").split("\n")
    if lines[0].strip() not in ("0", "999"):
        raise FormatError("this is no DXF drawing: it does not begin with the group code 0")
    pairs = [(code.strip(), value) for code, value in zip(lines[::2], lines[1::2], strict=False)]
    if ("0", "EOF") not in ((code, value.strip()) for code, value in pairs[-1000:]):
        raise FormatError(f"the DXF file is cut off: it does not end with EOF; {_SAME_FILE}")
    if sum(code == "0" for code, _ in pairs) > MAX_STRUCTURES:
        raise _too_large("entities and objects", MAX_STRUCTURES)
    insunits = _insunits(pairs)
    encoding = _encoding(pairs)
    del pairs, lines
    with _silent():
        try:
            decoded = content.decode(encoding, errors="replace")
            return Document(read(io.StringIO(decoded, newline=None)), insunits, ())
        except Exception:  # it raises what it meets in a broken file; then it may repair
            pass
        repaired, notes = _read(lambda: _recovered(content))
    return Document(repaired, insunits, notes)


def _binary(content: bytes) -> Document:
    from ezdxf.document import Drawing
    from ezdxf.lldxf.tagger import binary_tags_loader

    with _silent():
        tags: list[Any] = []
        structures, insunits, awaited = 0, None, False

        def load() -> None:
            nonlocal structures, insunits, awaited
            for tag in binary_tags_loader(content, errors="replace"):
                tags.append(tag)
                structures += tag.code == 0
                if awaited and tag.code == 70:
                    insunits, awaited = int(tag.value), False
                awaited = awaited or (tag.code == 9 and tag.value == "$INSUNITS")
                if len(tags) > MAX_TAGS:
                    raise _too_large("tags", MAX_TAGS)
                if structures > MAX_STRUCTURES:
                    raise _too_large("entities and objects", MAX_STRUCTURES)

        _read(load)
        if not tags or tags[-1].value != "EOF":
            raise FormatError(f"the DXF file is cut off: it does not end with EOF; {_SAME_FILE}")
        return Document(_read(lambda: Drawing.load(iter(tags))), insunits, ())


def _recovered(content: bytes) -> tuple[Any, tuple[str, ...]]:
    from ezdxf import recover

    found, auditor = recover.read(io.BytesIO(content), errors="replace")
    faults = [*auditor.errors, *auditor.fixes]
    if not faults:
        return found, ()
    said = [" ".join(str(fault.message).split())[:120] for fault in faults]
    for one in said:
        if "invalid" in one and "value" in one:  # it takes digits that it finds for the number
            raise FormatError(one.replace("recovered invalid", "invalid").partition(" as ")[0])
    count = "a fault" if len(said) == 1 else f"{len(said)} faults"
    return found, (
        f"the DXF file has {count} of structure, which was repaired: look at the outline "
        f"(the first: {said[0]})",
    )


def _read(load: Callable[[], Any]) -> Any:
    """What ``load`` makes; whatever ezdxf meets in a broken file is one line for the user."""
    try:
        return load()
    except FormatError:
        raise
    except Exception as error:
        why = " ".join(str(error).split())[:160] or type(error).__name__
        raise FormatError(f"the DXF file cannot be read ({why}); {_SAME_FILE}") from error


def _insunits(pairs: list[tuple[str, str]]) -> int | None:
    """The value after the header variable, if it has one."""
    for k, (code, value) in enumerate(pairs[:-1]):
        if code == "9" and value.strip() == "$INSUNITS":
            number = pairs[k + 1][1].strip()
            return int(number) if number.isascii() and number.isdigit() else None
        if code == "0" and value.strip() == "ENDSEC":
            return None
    return None


def _encoding(pairs: list[tuple[str, str]]) -> str:
    """UTF-8 since R2007; before, the code page of the header."""
    from ezdxf.tools.codepage import toencoding

    header = {
        pairs[k][1].strip(): pairs[k + 1][1].strip()
        for k in range(min(len(pairs) - 1, 2_000))
        if pairs[k][0] == "9"
    }
    if header.get("$ACADVER", "AC1009") >= "AC1021":
        return "utf-8"
    return toencoding(header.get("$DWGCODEPAGE", "ansi_1252"))


def _too_large(what: str, limit: int) -> FormatError:
    return FormatError(
        f"the DXF file has more than {limit} {what}; write out the part alone, "
        "or curves in place of short lines"
    )


@contextmanager
def _silent() -> Generator[None]:
    """What ezdxf meets it says on standard error; the user gets one line instead."""
    logger = logging.getLogger("ezdxf")
    before = logger.level
    logger.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        logger.setLevel(before)
