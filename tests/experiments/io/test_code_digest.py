"""Which code computes: the same sources have the same digest, wherever and however they lie."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from experiments.environment import ROOT
from experiments.io.code_digest import _NOT, DECIDES, _sources, code_digest, digest_of
from experiments.io.versions import said_of_code

ONE = ("icage/**/*.py",)


def tree(folder: Path, **contents: bytes) -> Path:
    for name, content in contents.items():
        path = folder / "icage" / f"{name}.py"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    return folder


def test_line_ends_do_not_count_and_all_else_does(tmp_path: Path):
    one = digest_of(tree(tmp_path / "a", x=b"a = 1\nb = 2\n", y=b""), ONE)
    assert one == digest_of(tree(tmp_path / "b", x=b"a = 1\r\nb = 2\r\n", y=b""), ONE)
    others = [
        {"x": b"a = 1\nb = 3\n", "y": b""},
        {"x": b"a = 1\nb = 2\n", "z": b""},
        {"x": b"a = 1\n", "y": b"b = 2\n"},
        {"x": b"a = 1\nb = 2\n"},
    ]
    found = {digest_of(tree(tmp_path / str(k), **o), ONE) for k, o in enumerate(others)}
    assert len(found | {one}) == 5
    assert digest_of(tmp_path / "nowhere", ONE) == "none"


def test_it_covers_what_decides_a_row_and_nothing_that_draws():
    names = {name for room in DECIDES.values() for name, _ in _sources(ROOT, room)}
    assert names >= {
        "icage/outline.py", "icage/kernels/locate.py", "icage/grasps/search.py",
        "sim/world/scene.py", "models/hand/hand.xml", "experiments/study/run/shard.py",
        "experiments/study/inputs/variants.py", "experiments/collection/rows.py",
    }  # fmt: skip
    assert not [name for name in names if name.startswith((*_NOT, "tests", "experiments/figures"))]
    assert code_digest().count(" ") == len(DECIDES) - 1
    assert "none" not in code_digest()


@pytest.mark.parametrize("any_code", [True, False])
def test_what_is_said_is_said_on(any_code: bool):
    new = {"versions": {"code": "b"}}
    assert said_of_code(None, new, False) == {}
    old = {"versions": {"code": "a"}, "other_code": ["c", "b"], "any_code": True}
    said = said_of_code(old, new, any_code)
    assert said == {"other_code": ["a", "c"] if any_code else ["c"], "any_code": True}


def test_a_plan_does_not_read_it():
    code = (
        "import sys; from experiments.cli import main; main(['plan', 'pliers']); "
        "assert 'experiments.io.code_digest' not in sys.modules"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
