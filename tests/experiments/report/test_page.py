"""The page as a text: what it says, that it stands alone, and that names are text."""

from __future__ import annotations

import json
import re
import shlex
import shutil
from base64 import b64decode, b64encode
from collections.abc import Callable
from hashlib import sha256
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from experiments.cli import parser
from experiments.escape.document import escape_document
from experiments.escape.run import Escape
from experiments.io.intervals import wilson
from experiments.io.one_line import printable
from experiments.io.outcome_words import END_WORDS
from experiments.replay.run import DEEPEST_AT_REST, DEEPEST_MOVING
from experiments.report import content, files, replay
from experiments.report.content import MOST_FAILURES, Cell, Column, Report, Section, Table
from experiments.report.page_html import page_html
from experiments.report.shell import quoted
from experiments.study.report.names import percent
from sim.closing.judge import OUTCOMES
from tests.experiments.commands.runner import here
from tests.experiments.report.conftest import DATA, KINDS, page_of
from tests.experiments.small import cage_of, t_case

VOID = {"meta", "img", "input", "br", "link"}


class Elements(HTMLParser):
    """Every element by name, text inside them, and the policy."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.names: list[str] = []
        self.attributes: list[tuple[str, str, str | None]] = []
        self.inside: dict[str, list[str]] = {}
        self.policy = ""
        self.feed(page)
        self.close()
        assert self.open == [], "elements that are not closed"

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        self.names.append(tag)
        self.attributes += [(tag, name, value) for name, value in attrs]
        if given.get("http-equiv") == "Content-Security-Policy":
            self.policy = given["content"] or ""
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag: str) -> None:
        assert self.open, tag
        assert self.open.pop() == tag, tag

    def handle_data(self, data: str) -> None:
        for tag in self.open[-1:]:
            self.inside.setdefault(tag, []).append(data)

    @property
    def text(self) -> str:
        kept = [" ".join(v) for k, v in self.inside.items() if k not in ("script", "style")]
        return " ".join(kept)


@pytest.fixture(scope="session")
def read(pages: dict[str, Path]) -> Callable[[str], Elements]:
    return lambda kind: Elements(pages[kind].read_text(encoding="utf-8"))


@pytest.mark.parametrize("kind", KINDS)
def test_it_stands_alone(kind: str, read: Callable[[str], Elements]) -> None:
    page = read(kind)
    directives = dict(part.strip().split(" ", 1) for part in page.policy.split(";"))
    assert directives["default-src"] == "'none'"
    assert directives["img-src"] == directives["media-src"] == "data:"

    def fingerprint(tag: str) -> str:
        text = "".join(page.inside[tag])
        return f"'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'"

    assert directives["script-src"] == fingerprint("script")
    assert directives["style-src"] == fingerprint("style")
    assert page.names.count("script") == page.names.count("style") == 1
    assert not {"link", "iframe", "object", "embed", "form", "base"} & set(page.names)
    for tag, name, value in page.attributes:
        assert not name.startswith("on"), (tag, name)
        assert name != "style", tag  # the policy would forbid it
        if name == "src":
            assert (value or "").startswith(("data:image/", "data:video/mp4")), tag
        if name == "href":
            assert (value or "").startswith("#"), value


@pytest.mark.parametrize("kind", KINDS)
def test_settings_stand_beside_every_rate(kind: str, read: Callable[[str], Elements]) -> None:
    page = read(kind)
    facts = dict(zip(page.inside["dt"], "|".join(page.inside["bdi"]).split("|"), strict=False))
    assert set(facts) > {"seed", "time step", "friction", "deepest finger"} or kind == "failed"
    for word in ("eed", "time step", "friction", "eepest"):
        assert word in page.text, word


@pytest.mark.parametrize("kind", KINDS)
def test_its_commands_are_ones(kind: str, read: Callable[[str], Elements]) -> None:
    commands = [line for line in read(kind).inside.get("code", []) if " " in line]
    assert commands
    for line in commands:
        words = shlex.split(line.replace("CASE", "pliers"))
        if words[:2] == ["python", "-m"]:
            assert words[2] == "experiments.jams"
        elif words[0] == "icage":
            parser().parse_args(words[1:])


def test_the_answer_of_a_replay(read: Callable[[str], Elements]) -> None:
    low, high = wilson(8, 8)
    assert (
        f"8 of 8 closings from the guaranteed sets of T ended in the target grasp (95 %: "
        f"{percent(low)} to {percent(high)})" in _answer(read("replay"))
    )
    assert "✓ everything checked held" in read("replay").text
    assert "6 of 8 closings" in _answer(read("failed"))
    assert "✗ not everything held" in read("failed").text


def _answer(page: Elements) -> str:
    """The sentence, its name put together again."""
    words = "".join(page.inside["p"])
    return words.replace("sets of  ended", "sets of T ended")


def test_a_failed_trial_has_its_seed_and_is_played_again(
    runs: Path, read: Callable[[str], Elements], capsys: Any
) -> None:
    page = read("failed")
    commands = [line for line in page.inside["code"] if line.startswith("icage replay-trial")]
    assert commands == [f"icage replay-trial {runs / 'failed'} {k}" for k in (2, 5)]
    done = here(capsys, *shlex.split(commands[0])[1:])
    assert done.code == 1  # it ended in the target: the record of these is spoilt
    assert "outcome was 'jammed', is 'target'" in done.out


def test_failed_trials_of_a_study_are_played_again(
    runs: Path, read: Callable[[str], Elements], capsys: Any
) -> None:
    found = json.loads((runs / "study" / "study.json").read_text())["found"]
    assert found["failed"] > 0
    page = read("study")
    commands = [line for line in page.inside["code"] if line.startswith("icage replay-trial")]
    wanted = [f"icage replay-trial {runs / 'study'} {k}" for k in found["failed_trials"]]
    assert commands == wanted
    done = here(capsys, *shlex.split(commands[0])[1:])
    assert done.code == 0, done
    assert "the same to the last bit" in done.out


def test_a_shake_is_asked_again(read: Callable[[str], Elements], capsys: Any) -> None:
    (command,) = [line for line in read("shake.json").inside["code"] if line.startswith("icage")]
    assert here(capsys, *shlex.split(command)[1:]).code == 0


def test_figures_are_in_the_page(runs: Path, read: Callable[[str], Elements]) -> None:
    sources = [
        v or "" for tag, name, v in read("replay").attributes if (tag, name) == ("img", "src")
    ]
    media, _, data = sources[0].partition(";base64,")
    assert media == "data:image/svg+xml"
    assert b64decode(data) == (runs / "replay" / "regions.svg").read_bytes()
    assert (
        len([1 for tag, name, _ in read("study").attributes if (tag, name) == ("img", "src")]) == 2
    )


def test_a_video_is_in_the_page_or_linked(
    runs: Path, tmp_path: Path, read: Callable[[str], Elements], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert "video" in read("failed").names
    monkeypatch.setattr(files.film, "__defaults__", (100,))
    page = Elements(page_of(runs / "failed", tmp_path / "a.html"))
    assert "video" not in page.names
    (link,) = [
        v for tag, name, v in page.attributes if (tag, name) == ("a", "href") and v[0] != "#"
    ]
    assert (tmp_path / link).resolve() == (runs / "failed" / "replay.mp4").resolve()
    assert "is not in this page" in page.text
    (runs / "failed" / "replay.mp4").write_bytes(b"no film")
    assert "is no MP4" in page_of(runs / "failed", tmp_path / "a.html")


HOSTILE = " ".join((
    "</title></style></script><script>document.title='hit'</script>",
    '"><img src=x onerror=alert(1)>',
    "' onmouseover='alert(1)",
    "a\u202eb\u200f",
    "red \x1b[31m\x00 bell\x07",
    "\u05d0\u05d1 `x` &amp; {braces} %s",
))  # fmt: skip


@pytest.mark.parametrize(
    "kind", ["escape.json", "shake.json", "regress.json", "jams.json", "replay"]
)
def test_a_hostile_name_is_text(
    kind: str, runs: Path, tmp_path: Path, read: Callable[[str], Elements]
) -> None:
    name, source = HOSTILE, runs / kind
    document = json.loads((source / "replay.json" if kind == "replay" else source).read_text())
    was = json.dumps(document)
    word = {"escape.json": "T", "regress.json": "disc_hammer", "jams.json": "L_best"}.get(kind, "T")
    text = was.replace(json.dumps(word), json.dumps(name))
    assert text != was
    out = tmp_path / "run"
    if kind == "replay":
        shutil.copytree(source, out)
        (out / "replay.json").write_text(text)
    else:
        out = tmp_path / "run.json"
        out.write_text(text)
    content = page_of(out, tmp_path / "page.html")
    page = Elements(content)
    assert sorted(set(page.names)) == sorted(set(read(kind).names) | set(page.names) & {"bdi"})
    assert page.names.count("script") == 1
    assert page.names.count("img") == read(kind).names.count("img")
    assert printable(name) in "".join(page.inside["bdi"])
    assert not any(c in content for c in "\u202e\u200f\x1b\x00\x07")


@pytest.mark.parametrize("name", ["my 'run'", "a\u202eb", "-x", "tab\there", "$HOME `id`"])
def test_a_folder_of_any_name_is_a_word_of_a_shell(name: str) -> None:
    import subprocess

    done = subprocess.run(
        ["bash", "-c", f"printf %s {quoted(name)}"], capture_output=True, check=True,
        env={"LC_ALL": "C.UTF-8", "PATH": "/usr/bin:/bin"},
    )  # fmt: skip
    assert done.stdout.decode().removeprefix("./") == name
    assert quoted(name).isprintable()


def test_without_its_table_a_study_names_failures(runs: Path, tmp_path: Path) -> None:
    shutil.copytree(runs / "study", tmp_path / "s")
    (tmp_path / "s" / "trials.parquet").unlink()
    page = Elements(page_of(tmp_path / "s", tmp_path / "s.html"))
    assert "trials.parquet is not there" in page.text


@pytest.mark.parametrize("kind", ["replay", "escape.json"])
def test_its_place_and_the_same_bytes(kind: str, runs: Path, capsys: Any) -> None:
    result = here(capsys, "report", str(runs / kind))
    assert result.code == 0, result
    place = runs / kind / "report.html" if kind == "replay" else runs / "escape.html"
    first = place.read_bytes()
    assert here(capsys, "report", str(runs / kind)).code == 0
    assert place.read_bytes() == first


def test_a_study_of_many_trials_has_a_small_page(monkeypatch: pytest.MonkeyPatch) -> None:
    """The bound of a list is kept, and what is left off is said."""
    rows = [(Cell(str(k), float(k)), Cell("x")) for k in range(5000)]
    table = Table.cut("t", (Column("n", "number"), Column("w")), rows, "", "the file")
    assert (len(table.rows), table.left_off) == (content.MOST_ROWS, 5000 - content.MOST_ROWS)
    page = page_html(Report("a", "study", None, "b", (), (Section("s", (table,)),)))
    assert "1000 rows are shown, 4000 more are left off: the file has all." in page
    assert len(page) < 200_000
    assert MOST_FAILURES <= 200


def test_every_failed_trial_is_counted(
    runs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(replay, "MOST_FAILURES", 1)
    page = Elements(page_of(runs / "failed", tmp_path / "a.html"))
    assert "1 rows are shown, 1 more are left off: trials.parquet has all." in page.text
    assert sum("replay-trial" in line for line in page.inside["code"]) == 1


def test_limits_and_outcomes_are_those_of_a_replay() -> None:
    assert (replay.DEEPEST_MOVING, replay.DEEPEST_AT_REST) == (DEEPEST_MOVING, DEEPEST_AT_REST)
    assert set(END_WORDS) == set(OUTCOMES)


def test_the_kept_attack_is_as_the_command_writes_one() -> None:
    """The file of these tests has today's keys."""
    from experiments.cases.with_discs import PhysicalCase

    blank = Escape(PhysicalCase.of(t_case(), cage_of("T")), 1, 0)
    kept = json.loads((DATA / "escape.json").read_text())
    assert {*escape_document(blank), "given"} == set(kept)


def test_a_rate_has_its_interval(runs: Path, read: Callable[[str], Elements]) -> None:
    found = json.loads((runs / "study" / "study.json").read_text())["found"]
    text = read("study").text
    one = found["independent"]
    for of in ("trials", "closed"):
        low, high = wilson(one["target"], one[of])
        assert f"{percent(low)} to {percent(high)}" in text
    for variable in found["variables"].values():
        for line in variable["bins"]:
            if line["closed"]:
                low, high = wilson(line["target"], line["closed"])
                assert f"{percent(low)} to {percent(high)}" in text


def test_pictures_that_are_no_pictures_are_left_out(runs: Path, tmp_path: Path) -> None:
    shutil.copytree(runs / "replay", tmp_path / "r")
    picture = tmp_path / "r" / "regions.svg"
    for text in ("<svg", "<html/>", '<!DOCTYPE a [<!ENTITY x "y">]><svg/>', "\0"):
        picture.write_text(text)
        page = Elements(page_of(tmp_path / "r", tmp_path / "r.html"))
        assert "img" not in page.names
        assert "A picture is left out" in page.text
    picture.write_text('<svg xmlns="http://www.w3.org/2000/svg"><script>alert(1)</script></svg>')
    page = Elements(page_of(tmp_path / "r", tmp_path / "r.html"))  # an image runs nothing
    assert page.names.count("script") == 1
    assert re.search(r"base64,", "".join(v or "" for _, n, v in page.attributes if n == "src"))


def test_numbers_are_sorted_as_numbers(read: Callable[[str], Elements]) -> None:
    keys = [v for tag, name, v in read("replay").attributes if name == "data-key"]
    assert keys
    assert np.isfinite([float(key or "nan") for key in keys]).all()
