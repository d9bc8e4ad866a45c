"""Drawings of every format, with much of what a format knows in a few hundred bytes."""

from __future__ import annotations

import io
import json
from functools import cache
from typing import Any

import numpy as np
import shapely
from PIL import Image

from tests.icage.formats.dxf.documents import box, by_hand, line, new, text_of
from tests.icage.formats.mesh.test_mesh import L_SHAPE, prism
from tests.icage.formats.svg.features.table import FEATURES

ODD = shapely.Polygon([(0, 0), (40, 0), (40, 10), (12, 11), (11, 30), (0, 30)])
HOLED = shapely.box(0, 0, 40, 20).difference(shapely.Point(15, 10).buffer(4, 3))


@cache
def svg() -> tuple[bytes, ...]:
    """A drawing of many features, and one drawing a feature."""
    many = (
        '<svg xmlns="http://www.w3.org/2000/svg" width="40mm" height="30mm" viewBox="0 0 80 60">\n'
        "<defs><clipPath id='a'><circle cx='30' cy='30' r='28'/></clipPath>\n"
        '<linearGradient id="b"><stop offset="0" stop-color="red"/></linearGradient></defs>\n'
        "<style>.k { fill: url(#b); stroke: none } #p > path { fill-rule: evenodd }</style>\n"
        '<g id="p" class="k" transform="translate(4 3) rotate(5) scale(1.1,0.9)" opacity="0.5">\n'
        '<path d="M10 10h40v5c0 9 9 9 9 0V40a12 8 20 1 1-20 0Q5 60 10 30T9 12zM20 20h5v5z"/>\n'
        '<rect x="1e1" y="45%" width="3em" height="5" rx="1"/>\n'
        '<ellipse cx="40" cy="20" rx="12" ry="6" style="fill: #00f; fill-opacity: 1"/>\n'
        '<polygon points="5,5 30,6 28,40"/><use href="#q" x="3" transform="skewX(9)"/></g>\n'
        '<circle id="q" cx="50" cy="40" r="9" clip-path="url(#a)"/>\n'
        '<polyline points="5 50 20 55 70 40" fill="none" stroke="black" stroke-width="3"'
        ' stroke-linecap="round" stroke-dasharray="none"/>\n'
        '<svg x="60" y="5" width="10" height="10" viewBox="0 0 5 5"><path d="M0 0L5 0 5 5z"/></svg>'
        "</svg>\n"
    )
    return (many.encode(),) * 40 + tuple(one.text.encode() for one in FEATURES)


@cache
def dxf() -> tuple[bytes, ...]:
    """Entities of every kind with blocks and layers, and loose lines by hand."""
    document, space = new()
    document.layers.add("CUT", color=3)
    block = document.blocks.new("B")
    block.add_circle((1, 2), 2.5)
    block.add_lwpolyline([(0, 0, 0.3), (4, 0, 0), (3, 5, -0.2)], format="xyb", close=True)
    space.add_blockref("B", (9, 8), {"xscale": 1.5, "yscale": 1.5, "rotation": 30})
    space.add_lwpolyline([(0, 0), (40, 0), (40, 10), (12, 11), (11, 30), (0, 30)], close=True)
    space.add_arc((60, 10), 5, 0, 180, dxfattribs={"layer": "CUT"})
    space.add_line((55, 10), (65, 10), dxfattribs={"layer": "CUT"})
    space.add_ellipse((20, 50), (9, 1), 0.4)
    space.add_spline(fit_points=[(0, 40), (9, 45), (3, 48), (0, 40)])
    space.add_open_spline([(0, 60), (9, 65), (3, 68), (9, 70)])
    space.add_polyline2d([(70, 0), (80, 0), (80, 9)], close=True)
    hatch = space.add_hatch()
    hatch.paths.add_polyline_path([(90, 0), (95, 0), (93, 4)], is_closed=True)
    space.add_solid([(90, 10), (95, 10), (90, 15), (95, 15)])
    space.add_text("x")
    alone, only = new("R2000")
    only.add_spline([(0, 0), (40, 0), (40, 30), (0, 30), (0, 0)])
    header = "9\n$INSUNITS\n70\n4\n"
    loose = by_hand(box() + box(3, 2, "IN") + line(-5, 1, 0, 1), header)
    circle = by_hand("0\nCIRCLE\n8\n0\n10\n5\n20\n5\n40\n9\n0\nPOINT\n8\n0\n10\n1\n20\n1\n")
    small = (loose.encode(), circle.encode())
    return (*small, *small, text_of(alone).encode(), text_of(document).encode())


@cache
def stl() -> tuple[bytes, ...]:
    mesh = prism(L_SHAPE)
    text: Any = mesh.export(file_type="stl_ascii")
    return mesh.export(file_type="stl"), text.encode()


@cache
def obj() -> tuple[bytes, ...]:
    text: Any = prism(L_SHAPE).export(file_type="obj")
    more = "o a\ng b\nv 0 0 0\nv 9 0 0 1.0\nv 9 9 0\nv 0 9 1\nvt 0 0\nvn 0 0 1\n" \
        "f 1/1/1 2/1/1 3//1 -1\nl 1 2\ns off\nusemtl x\n"  # fmt: skip
    return text.encode(), more.encode()


@cache
def ply() -> tuple[bytes, ...]:
    mesh = prism(L_SHAPE)
    rows = "\n".join(" ".join(map(repr, row)) for row in mesh.vertices.tolist())
    faces = "\n".join(f"3 {a} {b} {c}" for a, b, c in mesh.faces.tolist())
    text = (
        f"ply\nformat ascii 1.0\ncomment a\nelement vertex {len(mesh.vertices)}\n"
        f"property float x\nproperty double y\nproperty float z\nelement face {len(mesh.faces)}\n"
        f"property list uchar int vertex_indices\nend_header\n{rows}\n{faces}\n"
    )
    return mesh.export(file_type="ply"), text.encode()


def _picture() -> np.ndarray:
    column, row = np.meshgrid(np.arange(40) + 0.5, np.arange(30) + 0.5)
    inside = shapely.contains_xy(ODD.buffer(-2), column, row)
    return np.where(inside, 20, 240).astype(np.uint8)


def _saved(image: Image.Image, form: str, **options: Any) -> bytes:
    stream = io.BytesIO()
    image.save(stream, form, **options)
    return stream.getvalue()


@cache
def png() -> tuple[bytes, ...]:
    grey = Image.fromarray(_picture())
    alpha = Image.merge("LA", (grey, Image.fromarray(255 - _picture())))
    return (
        _saved(grey, "PNG"), _saved(grey.convert("RGB"), "PNG", dpi=(96, 96)),
        _saved(grey.convert("P"), "PNG", bits=8), _saved(grey.convert("1"), "PNG"),
        _saved(alpha, "PNG"), _saved(grey.convert("I;16"), "PNG"),
    )  # fmt: skip


@cache
def jpeg() -> tuple[bytes, ...]:
    grey = Image.fromarray(_picture())
    return (
        _saved(grey, "JPEG"), _saved(grey.convert("RGB"), "JPEG", progressive=True),
        _saved(grey.convert("CMYK"), "JPEG", quality=40),
    )  # fmt: skip


@cache
def geojson() -> tuple[bytes, ...]:
    def feature(shape: shapely.Geometry, **properties: Any) -> dict[str, Any]:
        geometry = json.loads(shapely.to_geojson(shape))
        return {"type": "Feature", "id": 7, "properties": properties, "geometry": geometry}

    two = shapely.MultiPolygon([ODD, shapely.box(60, 0, 70, 9)])
    lines = shapely.MultiLineString([ODD.exterior.coords[:4], ODD.exterior.coords[3:]])
    return (
        shapely.to_geojson(HOLED).encode(),
        json.dumps({"type": "FeatureCollection",
                    "features": [feature(ODD, name="a"), feature(two)]}).encode(),
        json.dumps({"type": "GeometryCollection",
                    "geometries": [json.loads(shapely.to_geojson(lines))]}).encode(),
    )  # fmt: skip


@cache
def wkt() -> tuple[bytes, ...]:
    two = shapely.MultiPolygon([ODD, shapely.box(60, 0, 70, 9)])
    return (
        shapely.to_wkt(HOLED).encode(), two.wkt.encode(), ODD.exterior.wkt.encode(),
        b"SRID=25832;POLYGON Z ((0 0 1, 40 0 1, 40 30 2, 0 0 1))",
        f"GEOMETRYCOLLECTION ({ODD.wkt}, POINT (1 2), LINESTRING EMPTY)".encode(),
    )  # fmt: skip
