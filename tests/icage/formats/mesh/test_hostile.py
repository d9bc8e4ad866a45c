"""Meshes that mean harm, lie about themselves, or are damaged."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest

from icage.errors import FormatError
from tests.icage.formats.mesh.test_mesh import stl_of
from tests.icage.formats.traced_files import refused, traced_bytes

FACET = (
    "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 {} 0\nendloop\nendfacet\n"
)


def soup(count: int, edge: float = 1.0) -> bytes:
    """Random triangles, as binary STL."""
    rng = np.random.default_rng(0)
    rows = np.zeros(count, dtype=[("n", "<f4", 3), ("c", "<f4", (3, 3)), ("a", "<u2")])
    rows["c"] = rng.random((count, 1, 3)) + edge * rng.random((count, 3, 3))
    return bytes(80) + struct.pack("<I", count) + rows.tobytes()


def ply(vertices: int | str, faces: int, body: str = "") -> str:
    return (
        f"ply\nformat ascii 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\n"
        f"property float z\nelement face {faces}\nproperty list uchar int vertex_indices\n"
        f"end_header\n{body}"
    )


THREE = "0 0 0\n1 0 0\n0 1 0\n"


SIGNALLING = np.array([0x7FA00000], dtype="<u4").tobytes()
"""A NaN that sets the processor's flag when it is made a double."""


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    ("name", "content", "why"),
    [
        ("a.stl", stl_of(np.full((4, 3, 3), np.nan)), "not finite"),
        ("a.stl", bytes(80) + struct.pack("<I", 1) + bytes(12) + 9 * SIGNALLING + bytes(2),
         "not finite"),
        ("a.ply", b"ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\n"
         b"property float y\nproperty float z\nelement face 1\nproperty list uchar float "
         b"vertex_index\nend_header\n" + 3 * SIGNALLING + b"\x03" + 3 * SIGNALLING,
         "not there|not finite"),
        ("a.stl", stl_of(np.random.default_rng(0).random((4, 3, 3)) * 3e38), "beyond 1e"),
        ("a.stl", stl_of(np.zeros((4, 3, 3))), "no area along this axis"),
        ("a.stl", stl_of(np.zeros((0, 3, 3))), "no triangles"),
        ("a.stl", bytes(80) + struct.pack("<I", 2**32 - 1) + bytes(500), "that of 10"),
        ("a.stl", soup(50)[:-20], "damaged or cut off"),
        ("a.stl", b"", "empty"),
        ("a.stl", soup(100_000), "contour of the mesh has 300000 edges"),
        ("a.stl", soup(15_000, 0.05), "a tangle"),
        ("a.stl", "solid a\n" + FACET.format("x") + "endsolid", "not three numbers"),
        ("a.stl", "solid a\n" + FACET.format(1), "no endsolid"),
        ("a.stl", "solid a\n" + FACET.format(1)[:-40] + "\nendsolid", "every facet needs three"),
        ("a.stl", "solid a\n" + FACET.format(1).replace("vertex 1 0 0", "vertex 1 0") + "endsolid",
         "every facet needs three|not three numbers"),
        ("a.ply", ply(3, 1, THREE + "3 0 1 2\n").replace("list uchar int v", "int v"), "no list"),
        ("a.ply", ply(3, 1, THREE + "3 0 1 2\n").replace("element face 1\n", ""), "and no lists"),
        ("a.ply", ply(3, 1, THREE + "3 0 1 2\n").replace("element face 1\n", "").replace(
            "ascii", "binary_little_endian"), "and no lists"),
        ("a.obj", "v 0 0 0\nf 1 2 9\n", "a vertex that is not there"),
        ("a.obj", "v 0 0 0\nf 0 1 1\n", "'0' is no vertex"),
        ("a.obj", "v 0 0 0\nf -2 1 1\n", "'-2' is no vertex"),
        ("a.obj", "v 0 0\n", "needs three numbers"),
        ("a.obj", "v 0 0 x\nf 1 1 1\n", "not three numbers"),
        ("a.obj", "v 1e308 0 0\nv 0 0 0\nv 0 1 0\nf 1 2 3\n", "beyond 1e"),
        ("a.obj", "v nan 0 0\nv 0 0 0\nv 0 1 0\nf 1 2 3\n", "not finite"),
        ("a.obj", "v 0 0 0\n", "no triangles"),
        ("a.obj", "v 0 0 0\ncstype bezier\n", "'cstype' is not read"),
        ("a.obj", "v 0 0 0\nf " + "1 " * 1_100_000, "at most 1000000"),
        ("a.obj", b"\xff\xfe\x00v", "UTF-8"),
        ("a.ply", ply(2**40, 1), "1099511627776 rows"),
        ("a.ply", ply(-1, 1), "-1 rows"),
        ("a.ply", ply("many", 1), "the header of the PLY file has"),
        ("a.ply", ply(1_000_000, 1, "0 0 0\n"), "cut off"),
        ("a.ply", ply(3, 1, THREE), "cut off"),
        ("a.ply", ply(3, 1, THREE + "3 0 1 7\n"), "a vertex that is not there"),
        ("a.ply", ply(3, 1, THREE + "3 0 1 1e18\n"), "a vertex that is not there"),
        ("a.ply", ply(3, 1, THREE + "1e300 1 2\n"), "cut off"),
        ("a.ply", ply(3, 1, THREE + "-1 1 2\n"), "list of length -1"),
        ("a.ply", ply(3, 1, THREE + "3 0 1 x\n"), "text where numbers are due"),
        ("a.ply", ply(3, 0, THREE), "no triangles"),
        ("a.ply", "ply\nformat ascii 1.0\n", "no PLY file"),
        ("a.ply", ply(3, 1).replace("ascii", "rot13"), "the header of the PLY file has"),
        ("a.ply", ply(3, 1, THREE).replace("float x", "float w"), "need the properties x, y and z"),
    ],
)  # fmt: skip
def test_it_is_refused_in_one_line(tmp_path: Path, name: str, content: str | bytes, why: str):
    with pytest.raises(FormatError, match=why) as caught:
        traced_bytes(tmp_path, name, content, unit="mm")
    assert "\n" not in str(caught.value)


@pytest.mark.slow
def test_a_million_triangles_are_refused_within_a_gigabyte(tmp_path: Path):
    path = tmp_path / "soup.stl"
    path.write_bytes(soup(1_000_000))
    assert "3000000 edges" in refused(path, "--unit", "mm")
    path.write_bytes(soup(1_000_001))
    assert "1000001 triangles" in refused(path, "--unit", "mm")
