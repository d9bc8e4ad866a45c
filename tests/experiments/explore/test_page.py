"""The page as a file: what is in it, and what cannot get into it."""

from __future__ import annotations

import json
import re
from base64 import b64decode, b64encode
from functools import cache
from hashlib import sha256
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

import icage
from experiments.explore import page_html as html_of
from experiments.explore.document import explore_document
from experiments.explore.encoded import doubles, indices
from experiments.explore.live.page import LIVE_MODULES
from experiments.explore.page_html import MODULES, PAGE, inlined_modules, page_html
from experiments.io.one_line import one_line
from icage.cells.query_tables import query_tables
from icage.errors import InputError
from models import CASES
from tests.experiments.commands.runner import here
from tests.experiments.explore.placements import SIX, cage_of

HOSTILE = "</script><!--<script>alert(1)</script>\u202e\"'&amp;<b>\u2028"
SVG = "http://www.w3.org/2000/svg"
T = str(CASES / "T_best.json")


class Elements(HTMLParser):
    """The elements of a page, and what stands in its scripts and styles."""

    def __init__(self, text: str) -> None:
        super().__init__(convert_charrefs=True)
        self.names: list[str] = []
        self.inside: dict[str, list[str]] = {}
        self.policy = ""
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.names.append(tag)
        given = dict(attrs)
        if given.get("http-equiv") == "Content-Security-Policy":
            self.policy = given["content"] or ""

    def handle_data(self, data: str) -> None:
        if self.names and self.names[-1] in ("script", "style", "title"):
            self.inside.setdefault(self.names[-1], []).append(data)

    def handle_endtag(self, tag: str) -> None:
        if self.names and self.names[-1] == tag:
            self.names.append("")


@cache
def page_of(name: str, called: str | None = None) -> str:
    cage = cage_of(name)
    document = explore_document(cage, query_tables(cage), called or name, "mm")
    return page_html(document, "a summary")


def data_of(page: str) -> dict[str, Any]:
    scripts = "".join(Elements(page).inside["script"])
    return json.loads(scripts[: scripts.index("\n}\n") + 2])


def decoded(field: dict[str, str]) -> np.ndarray:
    types = {"Float64Array": "<f8", "Uint16Array": "<u2", "Uint32Array": "<u4"}
    return np.frombuffer(b64decode(field["data"]), dtype=types[field["type"]])


@pytest.mark.parametrize("name", SIX)
def test_the_tables_come_back_bit_for_bit(name: str):
    tables = query_tables(cage_of(name))
    query = data_of(page_of(name))["query"]
    for key, array in {
        "piece_start": tables.pieces.start,
        "corners": tables.pieces.corners,
        "normals": tables.pieces.normals,
        "cells": tables.cage.cells,
        "level": tables.cage.level,
        "parent": tables.cage.parent,
        "stamp": tables.cage.stamp,
        "outside": tables.outside,
        "outside_level": tables.outside_level,
    }.items():
        assert (decoded(query[key]) == array.ravel()).all(), key
    assert query["polygon_first"] == tables.polygon_first
    assert query["grasp_nodes"] == list(tables.cage.grasp_nodes)


def test_arrays_keep_infinities_and_large_numbers():
    values = np.array([np.inf, -0.0, 5e-324, 0.1])
    assert (decoded(doubles(values)).view(np.int64) == values.view(np.int64)).all()
    assert decoded(indices(np.array([0, 65535]))).tolist() == [0, 65535]
    assert decoded(indices(np.array([[65536, 1]]))).tolist() == [65536, 1]
    assert decoded(indices(np.empty((0, 3), dtype=np.int64))).tolist() == []


def test_the_page_of_the_pliers_is_small():
    assert len(page_of("pliers").encode()) < 500_000


def test_the_regions_are_those_of_the_plan():
    cage = cage_of("pliers")
    drawn = data_of(page_of("pliers"))["drawn_regions"]
    for level in ("sigma_max", "sigma_first"):
        for finger, region in enumerate(cage.regions(level), 1):
            (rings,) = (r["rings"] for r in drawn if (r["finger"], r["level"]) == (finger, level))
            shape = shapely.union_all([shapely.Polygon(ring) for ring in rings])
            assert shape.symmetric_difference(region).area < 5e-3 * region.area


@pytest.mark.parametrize(
    "called", [HOSTILE, "]]>--></title></style>", "\x00\x1b[2J", "\u200f\u05d0"]
)
def test_a_hostile_name_is_text(called: str):
    page = page_of("cross_multi", called)
    elements, plain = Elements(page), Elements(page_of("cross_multi"))
    assert elements.names == plain.names
    name = data_of(page)["plan"]["name"]
    assert name == one_line(called)
    assert name.isprintable()
    (title,) = elements.inside["title"]
    assert title.startswith(name)


def test_the_policy_lets_in_this_script_and_style_and_nothing_else():
    elements = Elements(page_of("cross_multi"))
    directives = dict(part.strip().split(" ", 1) for part in elements.policy.split(";"))
    assert directives["default-src"] == "'none'"

    def fingerprint(text: str) -> str:
        return f"'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'"

    assert directives["style-src"] == fingerprint("".join(elements.inside["style"]))
    scripts = "".join(elements.inside["script"])
    assert directives["script-src"] == fingerprint(scripts[scripts.index("\n}\n") + 3 :])


def test_nothing_in_the_page_names_another_place():
    addresses = set(re.findall(r"(?:https?:)?//[\w.]+\.\w+[\w/.]*", page_of("cross_multi")))
    assert addresses == {SVG}
    for file in PAGE.iterdir():
        text = file.read_text(encoding="utf-8")
        assert not re.search(
            r"XMLHttp|WebSocket|innerHTML|eval\(|url\(|https?:", text.replace(SVG, "")
        )
        assert ("fetch(" in text) == (file.name == "asking.js")  # the live page asks its server
    assert "asking.js" not in MODULES


@pytest.mark.parametrize("more", [(), LIVE_MODULES])
def test_the_files_of_the_module_are_one_scope(more: tuple[str, ...]):
    text = inlined_modules(more)
    assert not re.search(r"^(import|export)\b", text, re.MULTILINE)
    tops = re.findall(r"^(?:async )?(?:function|const|let|class) (\w+)", text, re.MULTILINE)
    assert len(tops) == len(set(tops)) > 40
    assert {file.name for file in PAGE.glob("*.js")} == {*MODULES, *LIVE_MODULES}


def test_every_file_comes_after_those_that_it_imports():
    modules = (*MODULES, *LIVE_MODULES)
    for place, name in enumerate(modules):
        text = (PAGE / name).read_text(encoding="utf-8")
        for names, other in re.findall(r'^import \{ (.*) \} from "\./(.*)";$', text, re.MULTILINE):
            assert other in modules[:place], (name, other)
            exported = (PAGE / other).read_text(encoding="utf-8")
            for word in names.split(", "):
                assert re.search(rf"^export (const|function) {word}\b", exported, re.MULTILINE)
                assert len(re.findall(rf"\b{word}\b", text)) > 1, f"{name} needs no {word}"


def test_a_page_that_is_too_large_is_refused(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(html_of, "LARGEST", 1000)
    with pytest.raises(InputError, match="simplify the outline"):
        page_of("cross_multi", "large")


def test_the_command_writes_the_page(tmp_path: Path, capsys: Any):
    out = tmp_path / "t.html"
    result = here(capsys, "explore", T, "--out", str(out), "--friction", "0.3,0,0.1")
    assert result.code == 0, result
    plan = data_of(out.read_text(encoding="utf-8"))["plan"]
    assert [level["mu"] for level in plan["friction"]] == [0.0, 0.1, 0.3]
    cage = icage.plan(icage.load(T))
    assert plan["sigma_max"] == cage.sigma_max


def test_the_command_says_what_it_needs(tmp_path: Path, capsys: Any):
    wrong = here(capsys, "explore", T, "--out", str(tmp_path / "a.svg")).error_line()
    assert "ending in .html" in wrong
    out = str(tmp_path / "none" / "a.html")
    assert "there is no folder" in here(capsys, "explore", T, "--out", out).error_line()
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["rectangle_notcage", "stretching_not_a_cage"])
def test_contacts_that_are_no_cage_have_a_page(name: str, tmp_path: Path, capsys: Any):
    out = tmp_path / "no.html"
    assert here(capsys, "explore", str(CASES / f"{name}.json"), "--out", str(out)).code == 0
    data = data_of(out.read_text(encoding="utf-8"))
    assert data["plan"]["verdict"] == "not_a_cage"
    assert data["drawn_regions"] == []
