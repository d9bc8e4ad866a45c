"""Every bracketed citation in code and documents leads to a reference or to a section of a page.

A citation is ``[Key]`` or ``[docs/page.md]``, with the places meant after commas: ``Eq. (4)``,
``Sec. 2.5``, or a heading of the page. Keys stand in docs/references.md.
"""

from __future__ import annotations

import io
import re
import tokenize
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FOLDERS = ("icage", "sim", "experiments", "models", "benchmarks", "tests", "docs")

BRACKET = re.compile(r"\[([^\[\]`]+)\](?!\()")
KEY = re.compile(r"([A-Z][A-Za-z]*\d{4}[a-z]?)(?:, (.+))?")
PAGE = re.compile(r"((?:[\w.-]+/)*[\w-]+\.md)(?:, (.+))?")
PLACE = re.compile(
    r"(Sec\. [IVX\d]+([-.][A-Z\d]+)*|Eq\. \(\d+\)|(Def|Fig|Thm)\. \d+|(Lemma|Prop\.) \d+\.\d+"
    r"|Table \d+( \(\w\)(, \(\w\))*)?|ccwerrboundA)(, |$)"
)
LOOKS_CITED = re.compile(
    r"(?<![\d.])(1[89]|20)\d\d[a-z]?\b|[A-Z][a-z]+(1[89]|20)\d\d|\bSec\. |\bEq\. |\bFig\. |\.md\b"
    r"|\b(contract|theory|ecosystem)\b|\bnotes? \d"
)
"""Text in brackets that means a source, whether it is written as it should be or not."""


def keys() -> set[str]:
    text = (ROOT / "docs" / "references.md").read_text(encoding="utf-8")
    return set(re.findall(r"^- \*\*\[(\w+)\]\*\* ", text, re.MULTILINE))


KEYS = keys()


def prose_of(path: Path, text: str) -> str:
    """What is meant for readers: comments and strings of code, a page without its code."""
    if path.suffix == ".py":
        parts: list[str] = []
        for token in tokenize.generate_tokens(io.StringIO(text).readline):
            if token.type == tokenize.COMMENT:
                parts.append(token.string.lstrip("# "))
            elif token.type == tokenize.STRING and '"""' in token.string:
                parts.append(token.string)
        text = "\n".join(parts)
    else:
        text = re.sub(r"^```.*?^```", "", text, flags=re.DOTALL | re.MULTILINE)
        text = re.sub(r"^    .*$", "", text, flags=re.MULTILINE)
    text = re.sub(r"(``|`)[^`\n]*\1", "", text)
    return " ".join(text.split())  # a citation may be broken by a line's end


def citations(path: Path, text: str) -> Iterator[str]:
    """Brackets that are citations or look like one."""
    for found in BRACKET.findall(prose_of(path, text)):
        if KEY.fullmatch(found) or LOOKS_CITED.search(found):
            yield found


def headings(page: Path) -> list[str]:
    text = page.read_text(encoding="utf-8").replace("`", "")
    return re.findall(r"^#+ (.+)$", text, re.MULTILINE)


def fault(citation: str) -> str | None:
    """What is wrong with a citation, or None."""
    by_key = KEY.fullmatch(citation)
    if by_key is not None:
        key, places = by_key.groups()
        if key not in KEYS:
            return f"[{citation}]: {key} is not in docs/references.md"
        if places and PLACE.sub("", places + ", ").strip(", "):
            return f"[{citation}]: no place of a paper"
        return None
    by_page = PAGE.fullmatch(citation)
    if by_page is None:
        return f"[{citation}]: neither a key nor a page"
    page, places = by_page.groups()
    if not (ROOT / page).is_file():
        return f"[{citation}]: there is no {page}"
    if places is None:
        return None
    there = headings(ROOT / page)
    if any(heading == places or heading.startswith(f"{places} [") for heading in there):
        return None
    if all(one.startswith("Sec. ") for one in places.split(", ")):
        numbers = {re.split(r"\.? ", heading)[0] for heading in there}
        if {one.removeprefix("Sec. ") for one in places.split(", ")} <= numbers:
            return None
    if any(heading.split(" [")[0].startswith(f"{places} ") for heading in there):
        return None  # the heading of a command begins with its name
    return f"[{citation}]: {page} has no such section"


def pages() -> list[Path]:
    found = [p for folder in FOLDERS for p in (ROOT / folder).rglob("*") if p.is_file()]
    chosen = [p for p in found if p.suffix in (".py", ".md")]
    return sorted([*chosen, ROOT / "README.md", ROOT / "CHANGELOG.md"])


def test_every_citation_leads_somewhere() -> None:
    faults: list[str] = []
    count = 0
    for path in pages():
        if path == Path(__file__):
            continue  # below are citations that lead nowhere
        for citation in citations(path, path.read_text(encoding="utf-8")):
            count += 1
            wrong = fault(citation)
            if wrong is not None:
                faults.append(f"{path.relative_to(ROOT)}: {wrong}")
    assert not faults, "\n".join(faults)
    assert count > 100


def test_every_reference_is_cited() -> None:
    cited: set[str] = set()
    for path in pages():
        if path.name not in ("references.md", Path(__file__).name):
            for citation in citations(path, path.read_text(encoding="utf-8")):
                cited.add(citation.split(",")[0])
    assert cited >= KEYS, KEYS - cited


def test_pages_named_in_code_exist() -> None:
    """Also without brackets: ``docs/...`` in a docstring or a comment is a promise."""
    for path in pages():
        for name in re.findall(
            r"\bdocs/[\w/-]+\.(?:md|svg|png)\b", path.read_text(encoding="utf-8")
        ):
            if path != Path(__file__):
                assert (ROOT / name).is_file(), f"{path.relative_to(ROOT)} names {name}"


@pytest.mark.parametrize(
    "good",
    ["Bunis2018", "Bunis2018, Sec. IV-A, Eq. (2)", "Saltelli2010, Table 2 (b), (f)",
     "docs/theory.md", "docs/theory.md, Sec. 2.5", "docs/theory.md, Sec. 3.2, Sec. 4",
     "docs/formats.md, Exit codes", "docs/formats.md, icage query"],
)  # fmt: skip
def test_a_right_citation_passes(good: str) -> None:
    assert list(citations(Path("a.md"), f"As it is said. [{good}]")) == [good]
    assert fault(good) is None


@pytest.mark.parametrize(
    "bad",
    ["Nobody2018", "Bunis2018, page 3", "contract", "theory.md, 4", "ecosystem notes, Sec. 5",
     "docs/theory.md, Sec. 99", "docs/nowhere.md", "docs/formats.md, No such heading",
     "Douglas and Peucker 1973", "physics note 0.4, Miquel", "Dekker1971, Hida2001"],
)  # fmt: skip
def test_a_planted_citation_is_found(bad: str) -> None:
    broken = bad.replace(", ", ",\n")  # over two lines
    planted = f'"""A sentence of a docstring.\n\nMore of it. [{broken}]\n"""\n'
    assert list(citations(Path("a.py"), planted)) == [bad]
    assert fault(bad) is not None
    assert list(citations(Path("a.py"), f"x = 1  # [{bad}]\n")) == [bad]
    assert list(citations(Path("a.md"), f"Text [{bad}] and more.")) == [bad]


def test_code_and_links_are_no_citations() -> None:
    assert not list(citations(Path("a.py"), 'x = table["theory"]\ny = a[2018]\n'))
    assert not list(citations(Path("a.md"), "See [the theory](theory.md) and `[contract]`."))


def broken_links(page: Path, text: str) -> list[str]:
    """Relative links of a page that lead nowhere."""
    links = re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", re.sub(r"(``|`)[^`\n]*\1", "", text))
    return [k for k in links if "://" not in k and not (page.parent / k).exists()]


def test_links_of_all_pages_lead_somewhere() -> None:
    for page in (p for p in pages() if p.suffix == ".md"):
        assert not broken_links(page, page.read_text(encoding="utf-8")), page


def test_every_page_is_in_the_index() -> None:
    index = ROOT / "docs" / "index.md"
    linked = set(re.findall(r"\]\(([^)#]+\.md)\)", index.read_text(encoding="utf-8")))
    there = {p.relative_to(index.parent).as_posix() for p in (ROOT / "docs").glob("*.md")}
    there |= {f"decisions/{p.name}" for p in (ROOT / "docs" / "decisions").glob("*.md")}
    assert there - {"index.md"} <= linked


def test_a_planted_broken_link_is_found() -> None:
    text = "See [this](theory.md), [that](nowhere.md) and [there](https://example.org/a.md)."
    assert broken_links(ROOT / "docs" / "index.md", text) == ["nowhere.md"]
