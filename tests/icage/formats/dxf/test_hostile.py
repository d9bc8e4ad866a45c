"""DXF files that mean harm, or are damaged: one line, before they cost time or memory."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from icage.errors import FormatError, InputError
from tests.fuzz.seeds.drawings import dxf
from tests.icage.formats.dxf.documents import box, by_hand, line, new, read
from tests.icage.formats.traced_files import refused


def block(name: str, body: str) -> str:
    return f"0\nBLOCK\n8\n0\n2\n{name}\n70\n0\n10\n0\n20\n0\n3\n{name}\n{body}0\nENDBLK\n8\n0\n"


def insert(name: str, more: str = "") -> str:
    return f"0\nINSERT\n8\n0\n2\n{name}\n10\n0\n20\n0\n{more}"


def with_blocks(blocks: str, entities: str) -> str:
    start = f"0\nSECTION\n2\nBLOCKS\n{blocks}0\nENDSEC\n"
    return f"{start}0\nSECTION\n2\nENTITIES\n{entities}0\nENDSEC\n0\nEOF\n"


def tower(copies: int, floors: int, top: str) -> str:
    """Each block inserts the next one so many times."""
    blocks = "".join(block(f"B{k}", insert(f"B{k + 1}") * copies) for k in range(floors))
    return with_blocks(blocks + block(f"B{floors}", top), insert("B0"))


def circle(radius: str) -> str:
    return f"0\nCIRCLE\n8\n0\n10\n0\n20\n0\n40\n{radius}\n"


def vertex(x: float, y: float, bulge: str) -> str:
    return f"0\nVERTEX\n8\n0\n10\n{x}\n20\n{y}\n42\n{bulge}\n"


POLYLINE = "0\nPOLYLINE\n8\n0\n66\n1\n70\n1\n"


@pytest.mark.parametrize(
    ("content", "why"),
    [
        (with_blocks(block("A", insert("A")), insert("A")), "block 'A' inserts itself"),
        (
            with_blocks(block("A", insert("B")) + block("B", insert("a")), insert("A")),
            "block 'a' inserts itself",
        ),
        (tower(10, 20, line(0, 0, 1, 1)), "more than 50000 curves"),
        (tower(1, 2_000, line(0, 0, 1, 1)), "nested more than 50 deep"),
        (
            with_blocks(block("A", box()), insert("A", "70\n32000\n71\n32000\n44\n1.0\n45\n1.0\n")),
            "more than 200000 entities",
        ),
        (by_hand(insert("NO")), "block 'NO', which the file does not have"),
        (by_hand(line(0, 0, 1, 1) * 100_000), "more than 500000 tags"),
        (by_hand("0\nPOINT\n" * 61_000), "more than 60000 entities"),
        *((by_hand(box() + circle(v)), "CIRCLE") for v in ("nan", "inf", "1e308", "1e400", "0")),
        (by_hand(box() + line(0, 0, 0, 1).replace("\n0\n 11", "\nnan\n 11")), "LINE .*finite"),
        (by_hand(f"{POLYLINE}{vertex(0, 0, 'nan')}{vertex(1, 1, '1')}0\nSEQEND\n"), "bulge nan"),
        (by_hand(box())[:-60], "cut off: it does not end with EOF"),
        (by_hand(""), "its model space has no entities"),
        ("", "is empty"),
        ("hello", "no DXF drawing"),
        ("\n" * 1_500_000, "more than 500000 tags"),
        (b"AC1027" + bytes(500), "DWG drawing, which is not read: save it as DXF"),
        (b"AutoCAD Binary DXF\r\n\x1a\x00" + bytes(range(256)) * 50, "cannot be read|cut off"),
        (np.random.default_rng(0).bytes(50_000), "no DXF drawing"),
    ],
    ids=lambda value: value if isinstance(value, str) and len(value) < 60 else "",
)
def test_it_is_refused_in_one_line(tmp_path: Path, content: str | bytes, why: str):
    with pytest.raises(FormatError, match=why) as caught:
        read(tmp_path, content, unit="mm")
    assert "\n" not in str(caught.value)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("spoil", ["lost", "nan"])
def test_any_tag_of_an_entity_may_be_spoiled(tmp_path: Path, spoil: str):
    """An answer or a refusal, whichever attribute it is and whatever ezdxf makes of it."""
    written = dxf()[-1].decode()
    entities = written.partition("ENTITIES\n")[2].partition("  0\nENDSEC")[0]
    lines = with_blocks(block("B", circle("2")), entities).splitlines()
    first = lines.index("ENTITIES")
    refusals: list[str] = []
    for at in range(first + 1, lines.index("ENDSEC", first) - 1, 2):
        new = [] if spoil == "lost" else [lines[at], spoil]
        content = "\n".join([*lines[:at], *new, *lines[at + 2 :]]) + "\n"
        try:
            read(tmp_path, content, unit="mm", pick="largest")
        except InputError as error:
            refusals.append(str(error))
    assert len(refusals) > 5
    assert not any("\n" in said for said in refusals)


@pytest.mark.parametrize("kind", ["ENDBLK", "BLOCK", "TABLE", "ENDTAB", "VERTEX", "SEQEND", "EOF"])
def test_what_is_no_entity_among_entities(tmp_path: Path, kind: str):
    content = by_hand(box() + f"0\n{kind}\n8\n0\n" + box(3, 2))
    try:
        found = read(tmp_path, content, unit="mm", pick="largest").outline.area
    except FormatError as error:
        found = str(error)
    assert found == pytest.approx(800.0) or "\n" not in str(found)


def test_an_insertion_of_no_block_is_refused(tmp_path: Path):
    content = with_blocks(block("A", box()), "0\nINSERT\n8\n0\n10\n0\n20\n0\n" + box())
    with pytest.raises(FormatError, match="name has to be a string"):
        read(tmp_path, content, unit="mm")


def test_an_external_reference_is_refused(tmp_path: Path):
    document, space = new()
    document.add_xref_def("/etc/passwd.dxf", "OUTSIDE")
    space.add_blockref("OUTSIDE", (0, 0))
    with pytest.raises(FormatError, match="'OUTSIDE' is in another file"):
        read(tmp_path, document)


def test_a_spline_of_broken_numbers_is_refused(tmp_path: Path):
    document, space = new()
    space.add_spline_control_frame([(0, 0), (5, 9), (9, 0), (3, -3)], degree=3)
    spline = space.query("SPLINE")[0]
    spline.knots = [0, 0, 0, 0, 2, 1, 1, 1]
    with pytest.raises(FormatError, match="SPLINE .* not in order"):
        read(tmp_path, document)
    spline.knots = [0, 0, 0, 0, 1, 1, 1, 1]
    spline.weights = [1, -1, 1, 1]
    with pytest.raises(FormatError, match="SPLINE .* weights"):
        read(tmp_path, document)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("content", "why"),
    [
        (by_hand("".join(line(*p) for p in np.random.default_rng(0).random((49_000, 4)).round(4))),
         "a tangle"),
        (tower(10, 20, ""), "more than 200000 entities"),
        (by_hand(box())[:-60], "cut off"),
    ],
    ids=["tangle", "tower", "cut off"],
)  # fmt: skip
def test_the_command_line_says_one_line_and_needs_less_than_a_gigabyte(
    tmp_path: Path, content: str, why: str
):
    path = tmp_path / "harm.dxf"
    path.write_text(content)
    assert why in refused(path, "--unit", "mm")
