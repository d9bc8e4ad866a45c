"""Faults of JSON: values, keys, nesting; written by hand, so that keys may stand twice."""

from __future__ import annotations

import json
from copy import deepcopy
from random import Random
from typing import Any, Final

from tests.fuzz.mutations.values import NO_NUMBERS, NUMBERS, WORDS, near, number


class Written(str):
    """Text that stands in the JSON as it is."""


class Pairs(list[tuple[str, Any]]):
    """An object whose keys may stand twice."""


def spoiled(content: bytes, others: tuple[bytes, ...], random: Random) -> bytes:
    """The content with one to five such faults; as it is if it is no JSON."""
    try:
        tree = json.loads(content, object_pairs_hook=Pairs)
    except (ValueError, RecursionError):
        return content
    root: list[Any] = [tree]
    for _ in range(random.choice((1, 1, 1, 2, 5))):
        holder, key = random.choice(_places(root))
        random.choice(_WAYS)(holder, key, root, random)
    return written(root[0]).encode("utf-8", "surrogatepass")


def written(value: Any) -> str:
    """The JSON text, without recursion: nesting may be deep."""
    out: list[str] = []
    waiting: list[Any] = [value]
    while waiting:
        one = waiting.pop()
        if isinstance(one, Written):
            out.append(one)
        elif isinstance(one, Pairs):
            items: list[Any] = [Written("{")]
            for k, (key, inner) in enumerate(one):
                items += [Written(("," if k else "") + json.dumps(key) + ":"), inner]
            waiting += reversed([*items, Written("}")])
        elif isinstance(one, list):
            items = [Written("[")]
            for k, inner in enumerate(one):
                items += [Written("," if k else ""), inner]
            waiting += reversed([*items, Written("]")])
        else:
            out.append(json.dumps(one))
    return "".join(out)


def _places(root: list[Any]) -> list[tuple[Any, int]]:
    """Every value as (what holds it, where in it)."""
    found: list[tuple[Any, int]] = []
    waiting: list[Any] = [root]
    while waiting and len(found) < 20_000:
        holder = waiting.pop()
        for k, item in enumerate(holder):
            found.append((holder, k))
            inner = item[1] if isinstance(holder, Pairs) else item
            if isinstance(inner, list):
                waiting.append(inner)
    return found


def _get(holder: Any, k: int) -> Any:
    return holder[k][1] if isinstance(holder, Pairs) else holder[k]


def _set(holder: Any, k: int, value: Any) -> None:
    holder[k] = (holder[k][0], value) if isinstance(holder, Pairs) else value


def _value(holder: Any, k: int, root: list[Any], random: Random) -> None:
    old = _get(holder, k)
    is_number = isinstance(old, int | float) and not isinstance(old, bool)
    if is_number and random.random() < 0.6:
        new = near(repr(old), random)
        _set(holder, k, Written(new) if new.strip() else None)
        return
    _set(holder, k, random.choice((
        None, True, False, [], Pairs(), [[]], [None], Pairs([("", None)]), "", random.choice(WORDS),
        Written(random.choice(NUMBERS)), Written(number(random)), Written(number(random)),
        Written(random.choice(NO_NUMBERS[:4])), "" if isinstance(old, list) else str(old)[:100],
    )))  # fmt: skip


def _drop(holder: Any, k: int, root: list[Any], random: Random) -> None:
    if holder is not root:
        del holder[k]


def _again(holder: Any, k: int, root: list[Any], random: Random) -> None:
    """A key or an item twice, or very often."""
    if holder is not root:
        holder[k:k] = [holder[k]] * random.choice((1, 1, 2, 20, 2_100))


def _rename(holder: Any, k: int, root: list[Any], random: Random) -> None:
    if isinstance(holder, Pairs):
        key, inner = holder[k]
        holder[k] = (random.choice((key.upper(), key + "s", "", *WORDS[:8])), inner)


def _move(holder: Any, k: int, root: list[Any], random: Random) -> None:
    """Another value of the same document."""
    other = _get(*random.choice(_places(root)))
    try:
        _set(holder, k, deepcopy(other))
    except RecursionError:  # moved into itself before, so deep that it is copied as text
        _set(holder, k, Written(written(other)))


def _nest(holder: Any, k: int, root: list[Any], random: Random) -> None:
    depth, old = random.choice((1, 2, 900, 1_100, 60_000)), written(_get(holder, k))
    left, right = random.choice((("[", "]"), ('{"a":', "}")))
    _set(holder, k, Written(left * depth + old + right * depth))


def _order(holder: Any, k: int, root: list[Any], random: Random) -> None:
    inner = _get(holder, k)
    if isinstance(inner, list):
        random.choice((random.shuffle, list[Any].reverse))(inner)


def _spread(holder: Any, k: int, root: list[Any], random: Random) -> None:
    """Every number within: larger, smaller, moved, or with other digits."""
    scale, shift = 10.0 ** random.randint(-13, 13), random.choice((0.0, 0.0, 1e3, 1e9, 1e12))
    noise = random.choice((0.0, 0.0, 1e-16, 1e-12, 1e-7, 1e-3))
    waiting = [(holder, k)]
    while waiting:
        at, j = waiting.pop()
        inner = _get(at, j)
        if isinstance(inner, list):
            waiting += [(inner, i) for i in range(len(inner))]
        elif isinstance(inner, float) or (isinstance(inner, int) and not isinstance(inner, bool)):
            try:
                new = (float(inner) + noise * random.uniform(-1, 1)) * scale + shift
            except OverflowError:
                continue
            _set(at, j, Written(repr(new)))


_WAYS: Final = (
    _value,
    _value,
    _value,
    _value,
    _drop,
    _again,
    _rename,
    _move,
    _nest,
    _order,
    _spread,
)
