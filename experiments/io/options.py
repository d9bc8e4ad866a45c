"""Option values that several commands take, and checks made before any work is done."""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from icage.errors import InputError, OutputError
from icage.formats.whole_files import check_folder_writable, check_writable

UNITS = ("m", "mm", "cm")


def number(text: str) -> float:
    """A finite number."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"{text!r} is not a finite number")
    return value


def positive(text: str) -> float:
    """A finite number above zero."""
    value = number(text)
    if value <= 0.0:
        raise argparse.ArgumentTypeError(f"{text!r} is not above 0")
    return value


def not_negative(text: str) -> float:
    """A finite number, zero or above."""
    value = number(text)
    if value < 0.0:
        raise argparse.ArgumentTypeError(f"{text!r} is below 0")
    return value


def one_coefficient(text: str) -> float:
    """A coefficient of friction, where others take several."""
    if "," in text:
        raise argparse.ArgumentTypeError(f"{text!r}: one coefficient is needed, the largest")
    return not_negative(text)


def not_negative_list(text: str) -> tuple[float, ...]:
    """Finite numbers, zero or above, with commas between them."""
    return tuple(not_negative(part.strip()) for part in text.split(","))


def count(text: str) -> int:
    """A whole number from 1 to ten million."""
    return _whole(text, 1, 10_000_000)


def seed(text: str) -> int:
    """A whole number that a random generator may start from."""
    return _whole(text, 0, 2**63 - 1)


def row_index(text: str) -> int:
    """The number of a row of a table, from 0."""
    return _whole(text, 0, 10_000_000)


def port_number(text: str) -> int:
    """A port that a user may listen on, 0 for any."""
    return _whole(text, 0, 65535)


def _whole(text: str, low: int, high: int) -> int:
    if not (text.isascii() and text.isdigit() and len(text) <= 20 and low <= int(text) <= high):
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from {low} to {high}")
    return int(text)


def file_name(text: str) -> str:
    """The path of a file or folder; an empty one would mean the current folder."""
    if not text:
        raise argparse.ArgumentTypeError("'' names no file")
    return text


def add_json(parser: argparse.ArgumentParser) -> None:
    """``--json FILE|-``."""
    parser.add_argument(
        "--json",
        metavar="FILE|-",
        type=lambda text: "-" if text == "/dev/stdout" else text,
        help="write the answer as JSON, - for standard output; otherwise a summary is printed",
    )


def add_any_code(parser: Any) -> None:
    """``--any-code``."""
    parser.add_argument(
        "--any-code",
        action="store_true",
        help="take what other sources of the same version have computed, before or on other "
        "machines; the record says so",
    )


def check_output(option: str, target: str | None, *inputs: Path) -> None:
    """Refuse an output file that cannot be made, or is one of the inputs, before any work.

    Raises
    ------
    InputError:
        Its folder is missing, it is a folder itself, it may not be written, or it is an input.
    """
    if target is None or target == "-":
        return
    path = Path(target)
    check_text(option, path)
    try:
        if path.is_dir():
            raise InputError(f"{option} {target!r} is a folder; a file name is needed")
        if not path.parent.is_dir():
            raise InputError(f"{option} {target!r}: there is no folder {str(path.parent)!r}")
        if _is_one_of(path, inputs):
            raise InputError(f"{option} {target!r} would overwrite an input file")
        check_writable(path)
    except OutputError as error:
        raise InputError(f"{option} {error}") from error
    except (OSError, ValueError) as error:
        raise InputError(f"{option} {target!r} cannot be written: {reason(error)}") from error


def same(one: str, other: str) -> bool:
    """Whether two paths name the same file, there or not yet."""
    return Path(one).resolve() == Path(other).resolve()


def check_folder(
    option: str, folder: Path, names: Sequence[str] = (), inputs: Sequence[Path] = ()
) -> None:
    """Refuse an output folder that cannot be made or written to, before any work.

    ``names`` are the files that will be written there.

    Raises
    ------
    InputError:
        It or the nearest folder above it is a file, or may not be written to, or its disk is
        full; its name is no text; one of the files is an input or a folder.
    """
    check_text(option, folder)
    try:
        nearest = next(part for part in (folder, *folder.absolute().parents) if part.exists())
        if not nearest.is_dir():
            raise InputError(
                f"{option} {str(folder)!r}: {str(nearest)!r} is a file; a folder is needed"
            )
        check_folder_writable(nearest)
        for name in names:
            if (folder / name).is_dir():
                raise InputError(f"{option} {str(folder)!r}: {name} is a folder there")
            if _is_one_of(folder / name, inputs):
                raise InputError(f"{option} {str(folder)!r}: {name} would overwrite an input file")
    except (OSError, ValueError) as error:
        raise InputError(
            f"{option} {str(folder)!r} cannot be written to: {reason(error)}"
        ) from error


def check_text(option: str, path: Path) -> None:
    """Refuse an output path that is no UTF-8: libraries and pages that name it could not.

    Raises
    ------
    InputError:
        It is none.
    """
    try:
        str(path).encode()
    except UnicodeEncodeError as error:
        raise InputError(
            f"{option} {str(path)!r} is no UTF-8 text; another name is needed"
        ) from error


def _is_one_of(path: Path, inputs: Sequence[Path]) -> bool:
    return any(path.exists() and given.exists() and path.samefile(given) for given in inputs)


def reason(error: OSError | ValueError) -> str:
    """Why a path cannot be used, without the path again."""
    return (error.strerror if isinstance(error, OSError) else None) or str(error)
