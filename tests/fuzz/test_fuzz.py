"""A slice of ``python -m tests.fuzz``, and its own parts: an outcome that is wrong is seen."""

from __future__ import annotations

import json
from collections.abc import Generator
from dataclasses import replace
from pathlib import Path
from random import Random

import pytest

from tests.fuzz.campaign import Campaign
from tests.fuzz.job import MOST_MEMORY, MOST_SECONDS, Job, Outcome, fault
from tests.fuzz.kinds import KINDS, Spoiled, job_of
from tests.fuzz.minimize import smaller
from tests.fuzz.mutations import chunks, dxf_tags, json_tree, markup, raw, text
from tests.fuzz.worker import Guard

SLICE = 12
"""Inputs of each kind; their folders take the command that makes them longer than this."""

RECORDED = ("study-json", "replay-json", "replay-table")
"""Kinds that begin from what long commands have left."""


@pytest.fixture(scope="module")
def campaign() -> Generator[Campaign]:
    campaign = Campaign(14, None)
    yield campaign
    campaign.guard.close()


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind not in RECORDED])
def test_a_slice_of_the_campaign(kind: str, campaign: Campaign) -> None:
    tally = campaign.run(kind, 600.0, SLICE)
    assert tally.total == SLICE
    assert not tally.faults, f"python -m tests.fuzz --seed 14 --formats {kind} --most {SLICE}"


@pytest.mark.slow
@pytest.mark.parametrize("kind", RECORDED)
def test_a_slice_of_what_was_recorded(kind: str, campaign: Campaign) -> None:
    test_a_slice_of_the_campaign(kind, campaign)


@pytest.mark.parametrize("kind", [kind for kind, one in KINDS.items() if isinstance(one, Spoiled)])
def test_what_mutations_begin_from_is_read(kind: str, campaign: Campaign) -> None:
    """Else nothing but the first check of a format would be tried."""
    if kind in RECORDED:
        pytest.skip("recorded by the command itself")
    one = KINDS[kind]
    assert isinstance(one, Spoiled)
    call, arguments = one.asked[1 % len(one.asked)]
    contents = list(dict.fromkeys(one.seeds()))
    found = [
        campaign.guard.run(Job({**one.beside(), one.name: content}, arguments, call))
        for content in contents[:: 1 + len(contents) // 40]
    ]
    assert not [fault(outcome) for outcome in found if fault(outcome)]
    assert sum(outcome.code == 0 for outcome in found) >= 0.5 * len(found)


def test_an_input_is_named_by_kind_seed_and_number() -> None:
    for kind in ("case", "svg", "dxf", "png", "options", "geometry", "laws"):
        assert job_of(kind, 3, 5) == job_of(kind, 3, 5)
        assert job_of(kind, 3, 5) != job_of(kind, 4, 5)


@pytest.mark.parametrize(
    ("wrong", "word"),
    [
        ({"code": 1, "err": "icage: error: internal: KeyError (our fault)\n"}, "exit 1"),
        ({"code": None, "err": "the process died"}, "ended"),
        ({"err": "a.py:3: RuntimeWarning: divide by zero\n  x / y\n"}, "noise"),
        ({"code": 1, "err": "Traceback (most recent call last):\n  x\nKeyError: 1\n"}, "traceback"),
        ({"code": 2, "err": ""}, "lines"),
        ({"code": 2, "err": "icage: error: one thing\nicage: error: another\n"}, "lines"),
        ({"code": 2, "err": "icage: error: a bell \x07 rings\n"}, "lines"),
        ({"code": 0, "err": "icage: error: wrong, but all is well\n"}, "lines"),
        ({"code": 2, "err": "icage: error: it is wrong\n", "new": ("a.svg",)}, "files"),
        ({"seconds": MOST_SECONDS + 1.0}, "time"),
        ({"peak": MOST_MEMORY + 1}, "memory"),
    ],
)
def test_a_wrong_outcome_is_seen(wrong: dict[str, object], word: str) -> None:
    good = Outcome(0, "icage: warning: a hole left out\n", 0.1, 300_000_000)
    assert fault(good) == ""
    assert fault(Outcome(2, "icage: error: it is wrong\n", 0.1, 300_000_000)) == ""
    assert fault(replace(good, **wrong)).startswith(word)


def test_a_fault_that_is_planted_is_found_made_smaller_and_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a guard that takes every file with three bytes of a kind for a fault."""

    class Planted:
        def run(self, job: Job) -> Outcome:
            wrong = job.files[job.spoiled].count(b"]") >= 3
            return Outcome(1 if wrong else 0, "icage: planted 17\n" if wrong else "", 0.0, 0)

    campaign = Campaign(1, tmp_path, Planted())  # type: ignore[arg-type]
    tally = campaign.run("plan", 600.0, 5)
    assert list(tally.faults) == ["exit N: icage: planted N\n"]
    (kept,) = tmp_path.iterdir()
    assert (kept / "plan.json").read_bytes() == b"]]]"
    assert json.loads((kept / "JOB.txt").read_text().partition("\n")[2])["fault"]


def test_a_worker_that_dies_or_hangs_is_replaced(monkeypatch: pytest.MonkeyPatch) -> None:
    guard = Guard()
    try:
        monkeypatch.setattr("tests.fuzz.worker.PATIENCE", 1.0)
        deep = Job({"a.json": b"{}"}, ("a.json",), "no such call")
        assert fault(guard.run(deep)).startswith("traceback: KeyError")
        hanging = Job({}, (), "hang")
        assert fault(guard.run(hanging)).startswith("ended: still at work after 0.")
        monkeypatch.setattr("tests.fuzz.worker.PATIENCE", 60.0)
        assert fault(guard.run(Job({}, (), "die"))) == "ended: the process died"
        assert guard.run(Job({}, ("--version",))).code == 0
        assert guard.started == 3
    finally:
        guard.close()


def test_smaller_keeps_what_matters() -> None:
    job = Job({"a": b"0123456789abcdef"}, (), spoiled="a")
    least = smaller(job, lambda one: b"7" in one.files["a"] and b"c" in one.files["a"])
    assert least.files["a"] == b"7c"


@pytest.mark.parametrize(
    "mutation",
    [raw.spoiled, raw.binary, text.spoiled, json_tree.spoiled, markup.spoiled, dxf_tags.spoiled,
     chunks.spoiled],
)  # fmt: skip
def test_mutations_take_anything(mutation: object) -> None:
    """What one of them has spoiled goes through the next one."""
    some = (b"", b"\x00", b"[1, 2", b'{"a": 1}', b"\xff\xd8\xff\xc0", b"\x89PNG\r\n\x1a\n", b"\n\n")
    for number in range(300):
        random = Random(number)
        content = random.choice((*some, random.randbytes(random.randrange(60))))
        assert isinstance(mutation(content, some, random), bytes)  # type: ignore[operator]
