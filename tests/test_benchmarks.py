"""What of the benchmarks must be right: the page, the lookups, the peers; run as commands."""

from __future__ import annotations

import re
import subprocess
import sys

import pytest

from experiments.environment import ROOT


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, *arguments], cwd=ROOT, capture_output=True, text=True, check=False
    )


def test_the_page_is_what_was_measured():
    done = run("-m", "benchmarks.report", "--check")
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("name", ["figures", "timing"])
def test_examples(name: str):
    done = run("-m", "doctest", f"benchmarks/{name}.py", "-v")
    assert done.returncode == 0, done.stdout + done.stderr
    assert re.search(r"\b[1-9]\d* passed", done.stdout), done.stdout


def test_an_unknown_benchmark_is_refused_by_name():
    done = run("-m", "benchmarks", "--only", "nothing")
    assert done.returncode == 2
    assert "'nothing'" in done.stderr
    assert "planner" in done.stderr


SLOWER = """
import json, sys
from benchmarks import __main__ as front
base = json.loads(front.baseline_path("closing").read_text())
slow = {k: 2 * v if k.endswith("seconds_per_closing") else v for k, v in base.items()}
sys.exit(10 * front.tell({"closing": [base]}) + front.tell({"closing": [base, slow, slow]}))
"""


def test_what_is_slower_than_its_baseline_is_counted():
    """None of the baseline itself, and the closings on each of five targets at half the speed."""
    done = run("-c", SLOWER)
    assert done.returncode == 5, done.stdout + done.stderr
    assert done.stdout.count("WORSE (by more than 25%)") == 5


JOINS = """
import numpy as np
from benchmarks.peers import grid_flood
from scipy.cluster.hierarchy import DisjointSet
sets = DisjointSet(range(7))
grid_flood._join(sets, np.array([[1, 1, 0], [2, 5, 2]]), np.array([[3, 0, 4], [4, 6, 4]]))
print(sorted(sorted(one) for one in sets.subsets()))
"""


def test_a_flood_joins_what_is_free_in_both_slices():
    """Its levels on regular polygons are the same without: there a rigid hand escapes as soon."""
    done = run("-c", JOINS)
    assert done.stdout.strip() == "[[0], [1, 3], [2, 4], [5, 6]]", done.stdout + done.stderr


@pytest.mark.slow
@pytest.mark.first
def test_peers_are_right_where_the_answer_is_known():
    done = run("-m", "benchmarks.peers", "--check")
    assert done.returncode == 0, done.stdout + done.stderr
