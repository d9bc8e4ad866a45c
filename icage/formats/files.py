"""Read a user's file with the errors a user can act on, before any parser sees it."""

from __future__ import annotations

from pathlib import Path

from icage.errors import FormatError
from icage.formats.streams import up_to


def read_bytes(path: Path, limit: int, what: str) -> bytes:
    """Content of a file of at most ``limit`` bytes.

    Raises
    ------
    FormatError:
        No such file, a folder, not readable, a pipe that nobody writes to, empty, or too large.
    """
    try:
        if path.is_dir():
            raise FormatError(f"{path} is a folder; {what} is needed")
        if not path.exists():
            raise FormatError(f"{path} does not exist; {what} is needed")
        content = up_to(path, limit + 1)
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else error
        raise FormatError(f"{str(path)!r} cannot be read: {reason}") from error
    if len(content) > limit:
        raise FormatError(f"{path} is larger than {limit / 1e6:g} MB, the most {what} may have")
    if not content:
        raise FormatError(f"{path} is empty; {what} is needed")
    return content


def decode(content: bytes, where: str) -> str:
    """UTF-8 text, with or without a byte order mark.

    Raises
    ------
    FormatError:
        Not UTF-8, or bytes that no text has.
    """
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise FormatError(f"{where} is not UTF-8 text (byte {error.start})") from error
    if "\0" in text:
        raise FormatError(f"{where} is not text (byte {text.index(chr(0))} is zero)")
    return text
