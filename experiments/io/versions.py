"""Versions of everything that can change a number, for the record of a run."""

from __future__ import annotations

import platform
from collections.abc import Mapping
from functools import cache
from importlib.metadata import version
from typing import Any, Final

import icage
from experiments.io.code_digest import code_digest
from sim.closing.outcome import RULES

CODE: Final = "code"
"""Key of the digest of our sources."""

RECORDED: Final = ("mujoco", "numpy", "scipy", "shapely", "numba")


def versions() -> dict[str, str]:
    """Name to version: icage, Python, the libraries that compute, our closings, the digest of our
    sources, the platform.
    """
    return {
        "icage": icage.__version__,
        "python": platform.python_version(),
        **_of_libraries(),
        "closings": RULES,
        CODE: code_digest(),
        "platform": f"{platform.system()} {platform.machine()}",
    }


@cache
def _of_libraries() -> dict[str, str]:
    """Read once: each of them is a whole document that has to be parsed."""
    return {name: version(name) for name in RECORDED}


ANY_CODE_OPTION: Final = "--any-code"

ANY_CODE: Final = "any_code"
"""Key of a document whose rows may come from other code than is recorded; ..."""

OTHER_CODE: Final = "other_code"
"""... and of the list of what earlier parts are known to come from."""


def said_of_code(
    old: Mapping[str, Any] | None, new: Mapping[str, Any], any_code: bool
) -> dict[str, Any]:
    """What the record of a run that goes on says of other code; nothing where there was none.

    ``old`` and ``new`` have ``versions``; what the old one says is said on.
    """
    old = old or {}
    known = {str(one) for one in old.get(OTHER_CODE, ())}
    if any_code and "versions" in old:
        known.add(str(old["versions"].get(CODE, "none")))
    known.discard(new["versions"][CODE])
    said: dict[str, Any] = {OTHER_CODE: sorted(known)} if known else {}
    if any_code or old.get(ANY_CODE):
        said[ANY_CODE] = True
    return said


def hint_of_code(old: Mapping[str, Any], new: Mapping[str, Any]) -> str:
    """What a refusal adds where only the code differs: that it may be overruled."""
    only = old.get(CODE) != new.get(CODE) and {**old, CODE: 0} == {**new, CODE: 0}
    return f" ({ANY_CODE_OPTION} goes on all the same, and the record says so)" if only else ""
