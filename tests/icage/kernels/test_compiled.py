"""The kernel cache goes by the content of all kernels, and plain Python gives the same numbers."""

from __future__ import annotations

import importlib.util
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from icage.cells.kernels.search import explore
from icage.kernels import background
from icage.kernels import compiled as module
from icage.kernels.compiled import compiled, compiled_borrowing
from icage.kernels.digest import kernel_sources
from icage.kernels.machine import TOOLS

SCRIPT = """
from icage.outline import Outline
from icage.planner import plan
tee = [(-5.15, 4.65), (-5.15, 1.1), (-1.65, 1.1), (-1.65, -7.15), (1.65, -7.15), (1.65, 1.1),
       (5.15, 1.1), (5.15, 4.65)]
cage = plan(Outline(tee), [(-1.65, 1.1), (1.65, 1.1), (0.0, 4.65)])
print(repr(cage.sigma_0), repr(cage.sigma_first), repr(cage.sigma_max))
"""


def answer(**environment: str) -> str:
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT], check=True, capture_output=True, text=True,
        cwd=Path(__file__).parents[3], env={**os.environ, **environment},
    )  # fmt: skip
    return done.stdout


def test_a_change_in_any_kernel_makes_every_cached_one_stale() -> None:
    cache = explore.dispatcher._cache  # type: ignore[attr-defined]
    assert cache._cache_file._source_stamp == kernel_sources().digest
    assert cache._cache_file._index_name.endswith(f".{TOOLS}.nbi")
    assert TOOLS in cache._cache_file._data_name(1)


def test_stale_machine_code_is_not_loaded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """numba compares the stamp that we set with the one in its index when it loads."""
    import numba

    source = tmp_path / "one_for_the_cache.py"
    source.write_text("def one():\n    return 1\n")
    spec = importlib.util.spec_from_file_location(source.stem, source)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, source.stem, module)  # numba pickles it by its name
    spec.loader.exec_module(module)

    def hits(stamp: str) -> int:
        dispatcher = numba.njit(cache=True)(module.one)
        dispatcher._cache._cache_file._source_stamp = stamp
        assert dispatcher() == 1
        return sum(dispatcher.stats.cache_hits.values())

    assert [hits("first"), hits("first"), hits("second")] == [0, 1, 0]


ONE_KERNEL = """
import sys
import llvmlite, numba  # numba first looks which llvmlite it has
llvmlite.__version__ = sys.argv[1]
from icage.kernels.compiled import compiled, machine_code_at_once
from icage.kernels.compiling import when_compiling
from one_for_the_cache import one
when_compiling(lambda: print("compiling"))
machine_code_at_once()
one = compiled(one)
print(one(1), one(1.0))
"""


@pytest.mark.slow
def test_environments_of_one_checkout_keep_their_caches_apart(tmp_path: Path) -> None:
    """And whoever asked is told of a compilation, once, and only where nothing is cached."""
    (tmp_path / "one_for_the_cache.py").write_text("def one(x):\n    return x + 1\n")
    (tmp_path / "cache").mkdir()
    root = str(Path(__file__).parents[3])
    path = {
        "PYTHONPATH": os.pathsep.join([root, str(tmp_path)]),
        "NUMBA_CACHE_DIR": str(tmp_path / "cache"),
    }

    def told(version: str) -> bool:
        done = subprocess.run(
            [sys.executable, "-c", ONE_KERNEL, version], check=True, capture_output=True, text=True,
            cwd=tmp_path, env={**os.environ, **path},
        )  # fmt: skip
        words = done.stdout.split()
        assert words[-2:] == ["2", "2.0"]
        assert words[:-2] in ([], ["compiling"])
        return words[:-2] != []

    assert [told(version) for version in ("A", "A", "B", "A", "B")] == [1, 0, 1, 0, 0]
    names = [file.name for file in (tmp_path / "cache").glob("*/*.nbi")]
    assert sorted(name[-6:] for name in names) == ["eA.nbi", "eB.nbi"]


RENAMED = """
import sys
from typing import NamedTuple
from icage.kernels.digest import kernel_sources
from icage.kernels.machine import stamped
import one_with_a_class as module
call = stamped(module.one, kernel_sources())
given = getattr(module, sys.argv[1])(2.0)
print(call(given), sum(call.stats.cache_hits.values()))
"""


def test_a_cache_that_names_a_class_that_is_no_more_is_stale(tmp_path: Path) -> None:
    source = tmp_path / "one_with_a_class.py"
    root = Path(__file__).parents[3]
    path = os.pathsep.join([str(root), str(tmp_path)])
    own = {"PYTHONPATH": path, "NUMBA_CACHE_DIR": str(tmp_path / "cache"), background.SWITCH: "0"}
    (tmp_path / "cache").mkdir()
    told = []
    for name in ("Old", "New", "New"):
        text = f"class {name}(NamedTuple):\n    x: float\n\n\ndef one(given):\n    return given.x\n"
        source.write_text(f"from typing import NamedTuple\n\n\n{text}")
        done = subprocess.run(
            [sys.executable, "-B", "-c", RENAMED, name], check=True, capture_output=True, text=True,
            cwd=tmp_path, env={**os.environ, **own},
        )  # fmt: skip
        told.append(done.stdout.split())
    assert told == [["2.0", "0"], ["2.0", "0"], ["2.0", "1"]]


ACROSS_AN_UPDATE = """
import sys
from pathlib import Path
import numpy as np
import icage
from icage.kernels.compiled import machine_code_at_once
from icage.kernels.digest import kernel_sources
from icage.kernels.straight import corners
before = kernel_sources().digest
if sys.argv[1] == "update":
    inner = Path(icage.__file__).parent / "kernels" / "union_find.py"
    inner.write_text(inner.read_text() + "\\n# new\\n")
assert kernel_sources().changed() == (sys.argv[1] == "update")
assert kernel_sources().digest == before  # of what this process runs
machine_code_at_once()
x, y = np.array([0.0, 1.0, 2.0, 2.0]), np.array([0.0, 0.0, 0.0, 1.0])
print(corners(x, y, 0, 1e-9).tolist())
"""


def test_a_process_that_runs_across_an_update_keeps_no_machine_code(tmp_path: Path) -> None:
    """It would be that of the old sources under the stamp of the new ones."""
    root = Path(__file__).parents[3]
    ignored = shutil.ignore_patterns("__pycache__")
    shutil.copytree(root / "icage", tmp_path / "icage", ignore=ignored)
    for what, kept in (("update", False), ("no", True)):
        cache = tmp_path / what
        cache.mkdir()
        own = {"PYTHONPATH": str(tmp_path), "NUMBA_CACHE_DIR": str(cache), background.SWITCH: "0"}
        done = subprocess.run(
            [sys.executable, "-P", "-c", ACROSS_AN_UPDATE, what], check=True, capture_output=True,
            text=True, cwd=tmp_path, env={**os.environ, **own},
        )  # fmt: skip
        assert done.stdout == "[True, False, True, True]\n"
        assert any(cache.glob("*/straight.corners*.nbc")) == kept
        assert any(cache.glob("icage-kernels-*.json")) == kept


def test_no_place_for_a_cache_is_no_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """numba finds none for a function that has no file."""
    monkeypatch.setattr(module._process, "at_once", True)
    scope: dict[str, Any] = {}
    exec("def one(x):\n    return x + 1\n", scope)
    assert compiled(scope["one"])(1) == 2


@pytest.mark.slow
def test_compiled_and_plain_paths_agree() -> None:
    assert answer() == answer(NUMBA_DISABLE_JIT="1")


def test_the_t_shape_of_the_theory() -> None:
    """sigma_0 = 3.3, sigma_max about 1.96 sigma_0."""
    sigma_0, _, sigma_max = (float(word) for word in answer().split())
    assert sigma_0 == pytest.approx(3.3, rel=1e-12)
    assert sigma_max / sigma_0 == pytest.approx(1.96, abs=0.01)


LOADED = """
import sys
import numpy as np
from icage.kernels.compiled import machine_code_at_once
from icage.kernels.storage import stable_order
machine_code_at_once()
print(*stable_order(np.array([2.0, 1.0, 2.0])))
print("numba.np.npyimpl" in sys.modules, "scipy.linalg" in sys.modules)
"""


@pytest.mark.slow
def test_machine_code_is_loaded_without_what_compiles_it(tmp_path: Path) -> None:
    """And neither way loads scipy's linear algebra."""
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path), "ICAGE_COMPILE_BEHIND": "0"}

    def words() -> list[str]:
        done = subprocess.run(
            [sys.executable, "-c", LOADED], check=True, capture_output=True, text=True,
            cwd=Path(__file__).parents[3], env=environment,
        )  # fmt: skip
        return done.stdout.split()

    assert words() == ["1", "0", "2", "True", "False"]
    assert words() == ["1", "0", "2", "False", "False"]


@compiled
def _of_an_own_array(values):  # type: ignore[no-untyped-def]
    own = np.zeros(3)
    own[1] = values[0]
    return own.sum()


@compiled_borrowing
def _of_another(values):  # type: ignore[no-untyped-def]
    return 2.0 * _of_an_own_array(values)


@compiled_borrowing
def _array(values):  # type: ignore[no-untyped-def]
    return np.zeros(len(values))


def test_a_kernel_that_borrows_may_call_one_that_makes_arrays() -> None:
    assert _of_another.dispatcher(np.array([1.5])) == 3.0  # type: ignore[attr-defined]


def test_a_kernel_that_borrows_cannot_make_an_array() -> None:
    """References to it would be counted by nobody: it does not compile."""
    import numba

    with pytest.raises(numba.TypingError):
        _array.dispatcher(np.array([1.5]))  # type: ignore[attr-defined]


@compiled
def _scaled(value, factor):  # type: ignore[no-untyped-def]
    return value * factor


@compiled
def _by_numbers(value, own):  # type: ignore[no-untyped-def]
    return _scaled(value, 2) + _scaled(value, 3) + _scaled(value, own)


def test_a_number_that_stands_in_a_call_compiles_nothing_anew() -> None:
    # compiled here and now, whatever an earlier run has left in the cache
    _by_numbers.dispatcher._cache.load_overload = lambda *_: None  # type: ignore[attr-defined]
    assert _by_numbers.dispatcher(1.5, 4) == 13.5  # type: ignore[attr-defined]
    assert len(_scaled._numba_type_.dispatcher.signatures) == 1  # type: ignore[attr-defined]
