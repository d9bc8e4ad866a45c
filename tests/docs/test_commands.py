"""Every command that a page shows exists, with the options that it is given there.

Consoles are run besides (test_console.py). What is indented takes minutes or other machines, or is
run by tests of its own; here its options are read by the program's own parser, modules are found.
"""

from __future__ import annotations

import contextlib
import importlib.util
import io
from pathlib import Path

import pytest

from experiments.cli import parser
from experiments.environment import ROOT
from tests.docs.blocks import commands, name, pages

SHOWN = [(page, words) for page in pages() for words in commands(page)]
OTHERS = {"pip", "dask", "git", "mkdir", "printf", "cat", "head"}
"""Programs that are not ours."""


def fault(words: list[str]) -> str | None:
    """What is wrong with a command, or None."""
    program, *rest = words
    if program in ("python", "python3"):
        if rest[:1] != ["-m"]:
            return f"{program} without -m"
        if rest[1] != "experiments":
            return None if importlib.util.find_spec(rest[1]) else f"there is no module {rest[1]}"
        rest = rest[2:]
    elif program != "icage":
        return None if program in OTHERS else f"unknown program {program}"
    said = io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
        try:
            parser().parse_args(rest)
        except SystemExit as stop:
            return None if stop.code == 0 else said.getvalue()
        except Exception as error:
            return str(error)
    return None


@pytest.mark.parametrize("page", sorted({page for page, _ in SHOWN}), ids=name)
def test_commands_of_a_page_exist(page: Path):
    faults = [
        f"{' '.join(words)}: {fault(words)}" for p, words in SHOWN if p == page and fault(words)
    ]
    assert not faults, "\n".join(faults)


def test_there_are_commands_on_the_pages():
    assert len(SHOWN) > 60


@pytest.mark.parametrize(
    "wrong",
    ["icage plane pliers", "icage plan pliers --mu 0.1", "python -m experiments.no_such", "icages"],
)
def test_a_wrong_command_is_found(wrong: str):
    assert fault(wrong.split()) is not None


def test_every_command_is_in_the_table_of_commands():
    import experiments.commands

    page = (ROOT / "docs/commands.md").read_text(encoding="utf-8")
    for module in Path(experiments.commands.__path__[0]).glob("[a-z]*.py"):
        assert f"`icage {module.stem.replace('_', '-')}`" in page
