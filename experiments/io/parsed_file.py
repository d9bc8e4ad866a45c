"""A file of a format that somebody may have got wrong, read in one go."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from icage.errors import InputError
from icage.formats.streams import up_to


def parsed_file(
    path: Path, parse: Callable[[str], Any], kind: str, largest: int, error: type[InputError]
) -> Any:
    """What ``parse`` makes of a text of at most ``largest`` bytes; ``kind`` names its format.

    Raises
    ------
    error:
        It is larger, cannot be read, or is of no such format.
    """
    try:
        content = up_to(path, largest + 1)
        if len(content) > largest:
            raise error(f"{str(path)!r} is larger than {largest} bytes")
        return parse(content.decode("utf-8").replace("\r\n", "\n"))
    except OSError as found:
        raise error(f"{str(path)!r} cannot be read: {found.strerror}") from found
    except (ValueError, RecursionError) as found:
        raise error(f"{str(path)!r} is not {kind}: {found}") from found
