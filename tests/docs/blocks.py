"""The pages, and the code on them: what is between fences, and commands that are indented."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from experiments.environment import ROOT

SKIPPED = {"out", "build", "dist", "tests"}
"""Folders of the checkout whose Markdown is no page, besides hidden ones."""

FENCE = re.compile(r"^```(\w*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
PROGRAM = re.compile(r"^    ((?:icage|python3?|pip|dask|git) .*)$", re.MULTILINE)


@dataclass(frozen=True)
class Block:
    """Code between fences; ``line`` is where it begins in its page."""

    page: Path
    line: int
    language: str
    text: str

    def __str__(self) -> str:
        return f"{self.page.relative_to(ROOT)}:{self.line}"


def pages() -> list[Path]:
    """Every page in Markdown, of the whole checkout."""
    folders = [p for p in ROOT.iterdir() if p.is_dir() and p.name not in SKIPPED]
    found = [p for folder in folders if folder.name[0] != "." for p in folder.rglob("*.md")]
    return sorted([*ROOT.glob("*.md"), *found])


def blocks(page: Path, language: str) -> list[Block]:
    text = page.read_text(encoding="utf-8")
    return [
        Block(page, text.count("\n", 0, found.start()) + 2, found[1], found[2])
        for found in FENCE.finditer(text)
        if found[1] == language
    ]


def with_blocks(language: str) -> list[Path]:
    return [page for page in pages() if blocks(page, language)]


def name(page: Path) -> str:
    return str(page.relative_to(ROOT))


@dataclass(frozen=True)
class Example:
    """A command after the prompt ``$`` and what the page says that it prints."""

    command: str
    shown: str


def examples(session: str) -> list[Example]:
    """The commands of a console block. A line that ends with a backslash goes on in the next."""
    found: list[Example] = []
    command: str | None = None
    shown: list[str] = []
    going_on = False
    for line in session.splitlines():
        if going_on:
            command = f"{command}\n{line}"
        elif line.startswith("$ "):
            if command is not None:
                found.append(Example(command, "\n".join(shown)))
            command, shown = line[2:], []
        else:
            assert command is not None, f"no prompt before {line!r}"
            shown.append(line)
        going_on = command is not None and not shown and command.endswith("\\")
    assert command is not None, "no command"
    return [*found, Example(command, "\n".join(shown))]


def arguments(command: str) -> list[str]:
    """The words of a command, its comment left out."""
    return shlex.split(command.replace("\\\n", " "), comments=True)


def commands(page: Path) -> Iterator[list[str]]:
    """The words of every command that a page shows, in consoles, indented, or in plain fences."""
    text = page.read_text(encoding="utf-8")
    for block in blocks(page, "console"):
        yield from (arguments(example.command) for example in examples(block.text))
    for found in PROGRAM.findall(FENCE.sub("", text)):
        yield arguments(found)
