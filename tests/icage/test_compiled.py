"""The kernel cache goes by the content of all kernels, and plain Python gives the same numbers."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import pytest

from icage.kernels.compiled import kernel_digest
from icage.kernels.search import explore

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
        cwd=Path(__file__).parents[2], env={**os.environ, **environment},
    )  # fmt: skip
    return done.stdout


def test_a_change_in_any_kernel_makes_every_cached_one_stale() -> None:
    cache = explore._cache  # type: ignore[attr-defined]
    assert cache._cache_file._source_stamp == kernel_digest()


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


@pytest.mark.slow
def test_compiled_and_plain_paths_agree() -> None:
    assert answer() == answer(NUMBA_DISABLE_JIT="1")


def test_the_t_shape_of_the_theory() -> None:
    """sigma_0 = 3.3, sigma_max about 1.96 sigma_0."""
    sigma_0, _, sigma_max = (float(word) for word in answer().split())
    assert sigma_0 == pytest.approx(3.3, rel=1e-12)
    assert sigma_max / sigma_0 == pytest.approx(1.96, abs=0.01)
