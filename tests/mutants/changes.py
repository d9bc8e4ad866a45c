"""The changes that are made to a function: one at a time, each of a kind that a slip could make.

What is written as the size of ``np.empty`` is left as it is: room that is longer than it needs to
be, which is what adding one makes of it, holds nothing that anybody reads.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator
from copy import copy, deepcopy
from dataclasses import dataclass
from typing import Final

_COMPARED: Final[dict[type[ast.cmpop], tuple[type[ast.cmpop], ...]]] = {
    ast.Lt: (ast.LtE, ast.GtE), ast.LtE: (ast.Lt, ast.Gt),
    ast.Gt: (ast.GtE, ast.LtE), ast.GtE: (ast.Gt, ast.Lt),
    ast.Eq: (ast.NotEq,), ast.NotEq: (ast.Eq,),
    ast.Is: (ast.IsNot,), ast.IsNot: (ast.Is,), ast.In: (ast.NotIn,), ast.NotIn: (ast.In,),
}  # fmt: skip

_COMPUTED: Final[dict[type[ast.operator], type[ast.operator]]] = {
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult,
    ast.FloorDiv: ast.Mult, ast.Mod: ast.FloorDiv, ast.BitOr: ast.BitAnd, ast.BitAnd: ast.BitOr,
    ast.LShift: ast.RShift, ast.RShift: ast.LShift, ast.Pow: ast.Mult,
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Change:
    """What was changed, and where."""

    function: str
    line: int
    kind: str
    before: str
    after: str
    node: int
    """Which of the function's nodes, in the order of ``_inner``."""
    edit: int
    """Which of the changes that this node can have."""

    @property
    def name(self) -> str:
        """In one line."""
        return f"{self.function} line {self.line}: {self.before} -> {self.after}"


Edit = tuple[str, Callable[[ast.AST], None]]


def changes_of(function: ast.FunctionDef, name: str) -> Iterator[Change]:
    """Every change of a function.

    >>> (f,) = ast.parse("def f(x):\\n    return x < 2").body
    >>> [change.after for change in changes_of(f, "f")]
    ['x <= 2', 'x >= 2', '3']
    """
    for k, node in enumerate(_inner(function)):
        for number, (kind, edit) in enumerate(_edits(node)):
            new = copy(node)
            if isinstance(new, ast.Compare):
                new.ops = list(new.ops)
            edit(new)
            yield Change(name, getattr(node, "lineno", 0), kind, _text(node), _text(new), k, number)


def changed(function: ast.FunctionDef, change: Change) -> ast.FunctionDef:
    """The function with one change.

    >>> (f,) = ast.parse("def f(x):\\n    return x < 2").body
    >>> ast.unparse(changed(f, list(changes_of(f, "f"))[1]).body[0])
    'return x >= 2'
    """
    new = deepcopy(function)
    node = list(_inner(new))[change.node]
    _edits(node)[change.edit][1](node)
    return new


def statement_lines(function: ast.FunctionDef, line: int) -> range:
    """The lines of the innermost statement on a line, of a block only those of its head.

    >>> (f,) = ast.parse("def f(x):\\n    if (x or\\n       1):\\n        return (2,\\n    3)").body
    >>> list(statement_lines(f, 3)), list(statement_lines(f, 5))
    ([2, 3], [4, 5])
    """
    found = range(function.lineno, function.lineno + 1)
    for node in ast.walk(function):
        if isinstance(node, ast.stmt) and node is not function:
            body = getattr(node, "body", None)
            last = (node.end_lineno or node.lineno) if not body else body[0].lineno - 1
            lines = range(node.lineno, max(last, node.lineno) + 1)
            if line in lines and (len(lines) < len(found) or line not in found):
                found = lines
    return found


def _inner(node: ast.AST) -> Iterator[ast.AST]:
    """What computes: no types, no words of errors, no documentation, no default of an argument."""
    for name, field in ast.iter_fields(node):
        if name in ("annotation", "returns", "decorator_list", "args") and not isinstance(
            node, ast.Call
        ):
            continue
        for child in field if isinstance(field, list) else [field]:
            if not isinstance(child, ast.AST) or isinstance(child, ast.Raise | ast.JoinedStr):
                continue
            if isinstance(child, ast.Call) and ast.unparse(child.func) == "np.empty":
                continue
            yield child
            yield from _inner(child)


def _edits(node: ast.AST) -> list[Edit]:
    """Kind and change in place, for each change of this very node."""
    match node:
        case ast.Compare(ops=[op, *_]):
            return [(_kind(op, new()), _set_compared(new)) for new in _COMPARED[type(op)]]
        case ast.BinOp(op=op) | ast.AugAssign(op=op) if type(op) in _COMPUTED:
            new = _COMPUTED[type(op)]
            return [(_kind(op, new()), lambda at: setattr(at, "op", new()))]
        case ast.BoolOp(op=op):
            other = ast.Or if isinstance(op, ast.And) else ast.And
            return [(_kind(op, other()), lambda at: setattr(at, "op", other()))]
        case ast.UnaryOp(op=ast.USub()):
            return [("sign left out", lambda at: setattr(at, "op", ast.UAdd()))]
        case ast.Constant(value=bool()):
            return [("bool", lambda at: setattr(at, "value", not node.value))]
        case ast.Constant(value=int() | float()):
            return [("number", lambda at: setattr(at, "value", node.value + 1))]
        case ast.Break():
            return [("break to continue", _to_continue)]
        case ast.Continue():
            return [("continue to break", _to_break)]
        case ast.If() | ast.While() | ast.IfExp():
            return [("condition turned", _turn)]
        case _:
            return []


_SIGNS: Final = {
    "Lt": "<", "LtE": "<=", "Gt": ">", "GtE": ">=", "Eq": "==", "NotEq": "!=", "Add": "+",
    "Sub": "-", "Mult": "*", "Div": "/",
}  # fmt: skip


def _kind(old: ast.AST, new: ast.AST) -> str:
    names = [type(one).__name__ for one in (old, new)]
    return " to ".join(_SIGNS.get(name, name) for name in names)


def _set_compared(new: type[ast.cmpop]) -> Callable[[ast.AST], None]:
    def edit(at: ast.AST) -> None:
        assert isinstance(at, ast.Compare)
        at.ops[0] = new()

    return edit


def _turn(at: ast.AST) -> None:
    assert isinstance(at, ast.If | ast.While | ast.IfExp)
    at.test = ast.UnaryOp(ast.Not(), at.test)


def _to_continue(at: ast.AST) -> None:
    at.__class__ = ast.Continue  # type: ignore[assignment]


def _to_break(at: ast.AST) -> None:
    at.__class__ = ast.Break  # type: ignore[assignment]


def _text(node: ast.AST) -> str:
    if isinstance(node, ast.If | ast.While):
        word = "if" if isinstance(node, ast.If) else "while"
        return f"{word} {ast.unparse(node.test)}"
    return ast.unparse(node)
