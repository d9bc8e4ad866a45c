"""A changed function put in the place of the one that is loaded: its code, so that all who hold it
under whatever name, behind whatever decorator, call the changed one."""

from __future__ import annotations

import ast
import importlib
import inspect
from collections.abc import Iterator
from functools import cached_property
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any

from experiments.environment import ROOT


def functions_in(path: Path) -> dict[str, ast.FunctionDef]:
    """Functions and methods of a file by qualified name; those within functions belong to them."""
    found: dict[str, ast.FunctionDef] = {}
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.FunctionDef):
            found[node.name] = node
        if isinstance(node, ast.ClassDef):
            for inner in node.body:
                if isinstance(inner, ast.FunctionDef):
                    found[f"{node.name}.{inner.name}"] = inner
    return found


def put(path: Path, name: str, changed: ast.FunctionDef) -> None:
    """Give the loaded function this name's changed code, in this process.

    Raises
    ------
    LookupError:
        No function of that name is loaded.
    """
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        for k, one in enumerate(body if isinstance(body, list) else []):
            if isinstance(one, ast.FunctionDef) and one.lineno == changed.lineno:
                body[k] = changed
    whole = compile(ast.fix_missing_locations(tree), str(path), "exec", dont_inherit=True)
    new = next((code for code in _codes(whole) if code.co_qualname == name), None)
    module = importlib.import_module(".".join(path.relative_to(ROOT).with_suffix("").parts))
    loaded = [one for one in _functions(module) if _is(one, name, path)]
    if new is None or not loaded:
        raise LookupError(name)
    for function in loaded:
        function.__code__ = new


def _is(function: FunctionType, name: str, path: Path) -> bool:
    code = function.__code__
    return code.co_qualname == name and Path(code.co_filename) == path


def _codes(code: CodeType) -> Iterator[CodeType]:
    for inner in code.co_consts:
        if isinstance(inner, CodeType):
            yield inner
            yield from _codes(inner)


def _functions(module: ModuleType) -> Iterator[FunctionType]:
    for value in list(vars(module).values()):
        if inspect.isclass(value):
            if value.__module__ == module.__name__:
                for member in list(vars(value).values()):
                    yield from _behind(member)
        else:
            yield from _behind(value)


def _behind(value: Any) -> Iterator[FunctionType]:
    """The plain functions behind a decorated one."""
    for _ in range(6):
        if isinstance(value, property):
            value = value.fget
        elif isinstance(value, cached_property):
            value = value.func
        elif isinstance(value, staticmethod | classmethod):
            value = value.__func__
        elif hasattr(value, "plain"):  # a kernel
            value = value.plain
        else:
            if isinstance(value, FunctionType):
                yield value
            value = getattr(value, "__wrapped__", None)
