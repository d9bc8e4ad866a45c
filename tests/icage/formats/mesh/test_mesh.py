"""Sections and silhouettes of meshes that trimesh writes, and of files by hand."""

from __future__ import annotations

import struct
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from icage.errors import FormatError
from icage.formats.drawings.trace import Traced
from tests.icage.formats.traced_files import off_by, traced_bytes

WRITERS = {
    "binary.stl": "stl", "text.stl": "stl_ascii", "mesh.obj": "obj", "binary.ply": "ply",
}  # fmt: skip

L_SHAPE = shapely.Polygon([(0, 0), (9, 0), (9, 3), (3, 3), (3, 7), (0, 7)])
PLATE = shapely.box(0, 0, 30, 20).difference(shapely.box(8, 6, 20, 14))


def prism(area: shapely.Polygon, height: float = 5.0) -> trimesh.Trimesh:
    """The prism over an area, z from 0: by our own corners, so that nothing else decides them."""
    pieces = shapely.get_parts(shapely.constrained_delaunay_triangles(area))
    triangles = []
    for piece in pieces:
        a, b, c = shapely.get_coordinates(shapely.orient_polygons(piece))[:3]
        triangles.append([(*a, height), (*b, height), (*c, height)])
        triangles.append([(*a, 0.0), (*c, 0.0), (*b, 0.0)])
    turned = shapely.orient_polygons(area)
    for ring in (turned.exterior, *turned.interiors):
        oriented = shapely.get_coordinates(ring)
        for p, q in pairwise(oriented):
            triangles.append([(*p, 0.0), (*q, 0.0), (*q, height)])
            triangles.append([(*p, 0.0), (*q, height), (*p, height)])
    mesh = trimesh.Trimesh(**trimesh.triangles.to_kwargs(np.array(triangles)))
    mesh.merge_vertices()
    assert mesh.is_watertight
    return mesh


def read(folder: Path, mesh: trimesh.Trimesh, name: str = "binary.stl", **reading: Any) -> Traced:
    content = mesh.export(file_type=WRITERS[name])
    return traced_bytes(folder, name, content, **{"unit": "mm", **reading})


@pytest.mark.parametrize("name", WRITERS)
@pytest.mark.parametrize("section", [None, 2.5])
def test_a_prism_comes_back_from_every_file(tmp_path: Path, name: str, section: float | None):
    for area in (L_SHAPE, PLATE):
        found = read(tmp_path, prism(area), name, section=section)
        assert off_by(found, area) <= 1.1e-6
        holes = [note for note in found.notes if "a hole inside" in note]
        assert len(holes) == len(area.interiors)


@pytest.mark.parametrize(
    ("axis", "sides"), [("z", (10.0, 6.0)), ("x", (6.0, 4.0)), ("y", (4.0, 10.0))]
)
@pytest.mark.parametrize("cut", [False, True])
def test_an_axis_is_looked_against(
    tmp_path: Path, axis: str, sides: tuple[float, float], cut: bool
):
    box = trimesh.creation.box((10, 6, 4))
    found = read(tmp_path, box, axis=axis, section=0.1 if cut else None)
    assert found.outline.vertices.max(axis=0).tolist() == pytest.approx(sides)


def test_what_is_seen_is_not_mirrored(tmp_path: Path):
    for axis, back in (("z", (0, 1, 2)), ("x", (2, 0, 1)), ("y", (1, 2, 0))):
        mesh = prism(L_SHAPE)
        # Coordinate k of the turned mesh is coordinate back[k] of the prism.
        mesh = trimesh.Trimesh(mesh.vertices[:, back], mesh.faces)
        for section in (None, 2.5):
            assert off_by(read(tmp_path, mesh, axis=axis, section=section), L_SHAPE) <= 1.1e-6


@settings(max_examples=10, deadline=None)
@given(height=st.floats(-4.9, 4.9), seed=st.integers(0, 1000))
def test_the_section_of_a_ball_is_its_circle(tmp_path_factory: Any, height: float, seed: int):
    turn = trimesh.transformations.random_rotation_matrix(np.random.default_rng(seed).random(3))
    ball = trimesh.creation.icosphere(subdivisions=4, radius=5.0)
    ball.apply_transform(turn)
    found = read(tmp_path_factory.mktemp("ball"), ball, section=height, tolerance=None)
    radius = np.sqrt(25.0 - height**2)
    sagitta = 0.01  # of the facets
    width = float(found.outline.vertices.max())
    assert 2 * radius - 0.03 - 0.02 / radius <= width <= 2 * radius + 1e-6
    assert found.outline.area <= np.pi * radius**2
    assert found.outline.area >= np.pi * (radius - sagitta * 5.0 / radius) ** 2 * 0.995


def test_a_section_through_corners_and_faces_is_closed(tmp_path: Path):
    box = trimesh.creation.box((10, 6, 4))
    octahedron = trimesh.creation.icosphere(subdivisions=0)
    square = read(tmp_path, box, section=2.0)  # its top: just below it
    assert square.outline.area == pytest.approx(60.0)
    assert read(tmp_path, octahedron, section=0.0).notes == ()
    with pytest.raises(FormatError, match="reaches from -2 to 2 along z"):
        read(tmp_path, box, section=2.0001)


def test_the_silhouette_is_the_union_of_the_triangles(tmp_path: Path):
    rng = np.random.default_rng(3)
    for _ in range(4):
        mesh = trimesh.creation.icosphere(subdivisions=2)
        mesh.vertices *= 1.0 + 0.4 * rng.random((len(mesh.vertices), 1))
        mesh.vertices = mesh.vertices.astype(np.float32)
        triangles = shapely.polygons(mesh.vertices[mesh.faces][:, :, :2])
        union = shapely.union_all(triangles[shapely.area(triangles) > 1e-9])
        exact = shapely.Polygon(union.exterior)
        assert off_by(read(tmp_path, mesh, tolerance=1e-5), exact) <= 1e-5


def test_several_bodies_are_one_where_they_meet(tmp_path: Path):
    a, b = trimesh.creation.box((10, 4, 4)), trimesh.creation.box((4, 10, 4))
    cross = shapely.union_all([shapely.box(-5, -2, 5, 2), shapely.box(-2, -5, 2, 5)])
    for section in (None, 0.3):
        found = read(tmp_path, trimesh.util.concatenate([a, b]), section=section)
        assert off_by(found, cross) <= 1.1e-6
    apart = trimesh.util.concatenate([a, b.copy().apply_translation((20, 0, 0))])
    with pytest.raises(FormatError, match="2 separate filled parts"):
        read(tmp_path, apart)
    picked = read(tmp_path, apart, pick=1)
    assert picked.outline.area == pytest.approx(40.0)


def test_damaged_triangles_do_no_harm(tmp_path: Path):
    mesh = prism(L_SHAPE)
    triangles = mesh.vertices[mesh.faces]
    line = np.array([[[0, 0, 0], [9, 3, 5], [0, 0, 0]], [[3, 3, 0], [3, 3, 5], [3, 3, 2]]])
    doubled = np.concatenate([triangles, triangles[::3], line])
    flipped = triangles.copy()
    flipped[::2] = flipped[::2, ::-1]
    for harmed in (doubled, flipped):
        content = stl_of(harmed)
        for section in (None, 2.5):
            found = traced_bytes(tmp_path, "a.stl", content, unit="mm", section=section)
            assert off_by(found, L_SHAPE) <= 1.1e-6


def test_an_open_mesh_is_told_and_joined_within_the_gap(tmp_path: Path):
    mesh = prism(L_SHAPE)
    triangles = mesh.vertices[mesh.faces]
    middle = triangles.mean(axis=1)
    wall = np.abs(middle[:, 0] - 9.0) < 1e-9
    content = stl_of(triangles[~wall])
    with pytest.raises(FormatError, match="2 loose ends, the nearest two 3 apart"):
        traced_bytes(tmp_path, "a.stl", content, unit="mm", section=2.5)
    assert off_by(traced_bytes(tmp_path, "a.stl", content, unit="mm"), L_SHAPE) <= 1.1e-6


def stl_of(triangles: np.ndarray) -> bytes:
    rows = b"".join(struct.pack("<12fH", 0, 0, 0, *corners.ravel(), 0) for corners in triangles)
    return b"solid by hand".ljust(80) + struct.pack("<I", len(triangles)) + rows


def test_text_with_odd_spaces_and_words_is_read(tmp_path: Path):
    rows = "".join(
        "\tFACET normal 0 0 1\r\n outer  loop\r\n"
        + "".join(f"   Vertex\t{x:g}  {y:+.3E} {z}\r\n" for x, y, z in corners)
        + " endloop\r\n\r\n ENDFACET\r\n"
        for corners in prism(L_SHAPE).triangles
    )
    text = f"solid vertex of a solid, facet endsolid\r\n{rows}endsolid vertex\r\n"
    assert off_by(traced_bytes(tmp_path, "a.stl", text, unit="mm"), L_SHAPE) <= 1.1e-6


def test_an_obj_by_hand_is_read(tmp_path: Path):
    corners = [(x, y, z) for z in (0, 4) for x, y in ((0, 0), (10, 0), (10, 6), (0, 6))]
    text = "mtllib /etc/passwd\no part\nusemtl steel\n" + "".join(
        f"v {x} {y} {z} 1.0\n" for x, y, z in corners
    )
    text += "vt 0 0\nvn 0 0 1\ng sides\ns off\n"
    text += "f 4/1/1 3/1/1 2/1/1 1/1/1\nf -4//1 -3//1 -2//1 -1//1\n"
    text += "f 1 2 6 5\nf 2 3 7 6\nf 3 4 \\\n 8 7\nf 4 1 5 8\n"
    for section in (None, 1.0):
        found = traced_bytes(tmp_path, "a.obj", text, unit="mm", section=section)
        assert off_by(found, shapely.box(0, 0, 10, 6)) <= 1e-9


@pytest.mark.parametrize("order", ["ascii", "<", ">"])
def test_a_ply_of_mixed_polygons_is_read(tmp_path: Path, order: str):
    outline = [(0, 0), (10, 0), (12, 4), (6, 9), (-2, 4)]
    corners = [(float(x), float(y), z) for z in (0.0, 3.0) for x, y in outline]
    faces = [[4, 3, 2, 1, 0], [5, 6, 7, 8, 9]]
    for k in range(5):
        n = (k + 1) % 5
        faces += [[k, n, n + 5, k + 5]] if k % 2 else [[k, n, n + 5], [k, n + 5, k + 5]]
    name = {"ascii": "ascii", "<": "binary_little_endian", ">": "binary_big_endian"}[order]
    head = (
        f"ply\nformat {name} 1.0\ncomment TextureFile /etc/passwd\nelement vertex 10\n"
        "property float x\nproperty uchar red\nproperty float y\nproperty double z\n"
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\nproperty uchar q\n"
        "element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n"
    )
    if order == "ascii":
        rows = [f"{x} 7 {y} {z}" for x, y, z in corners]
        rows += [f"{len(face)} {' '.join(map(str, face))} 9" for face in faces]
        body = ("\n".join([*rows, "0 1"]) + "\n").encode()
    else:
        body = b"".join(struct.pack(f"{order}fBfd", x, 7, y, z) for x, y, z in corners)
        body += b"".join(
            struct.pack(f"{order}B{len(face)}iB", len(face), *face, 9) for face in faces
        )
        body += struct.pack(f"{order}ii", 0, 1)
    for section in (None, 1.0):
        found = traced_bytes(tmp_path, "a.ply", head.encode() + body, unit="mm", section=section)
        assert off_by(found, shapely.Polygon(outline)) <= 1.1e-6
    with pytest.raises(FormatError, match="cut off"):
        traced_bytes(tmp_path, "a.ply", head.encode() + body[: len(body) // 2], unit="mm")


def test_a_mesh_states_no_unit(tmp_path: Path):
    content = stl_of(prism(L_SHAPE).triangles)
    with pytest.raises(FormatError, match="--width W --unit U.*--unit U"):
        traced_bytes(tmp_path, "a.stl", content)
    wide = traced_bytes(tmp_path, "a.stl", content, width=180.0, unit="mm")
    assert wide.outline.vertices.max() == pytest.approx(180.0)
