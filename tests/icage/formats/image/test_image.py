"""Rendered shapes come back from images; images of every kind; what is not told apart."""

from __future__ import annotations

import io
import struct
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from PIL import Image, ImageDraw

from icage.errors import FormatError
from icage.formats.drawings.curves import flatten
from icage.formats.drawings.read import read_drawing
from icage.formats.drawings.reading import Reading
from tests.icage.formats.traced_files import off_by, traced_bytes

SIZE = 240


def disc() -> shapely.Polygon:
    u = np.linspace(0.0, 2.0 * np.pi, 4_000, endpoint=False)
    return shapely.Polygon(np.column_stack([120.3 + 90 * np.cos(u), 119.6 + 90 * np.sin(u)]))


def turned_square(angle: float = 0.05) -> shapely.Polygon:
    return shapely.affinity.rotate(shapely.box(50.3, 60.6, 190.2, 180.9), angle, use_radians=True)


def spiky() -> shapely.Polygon:
    u = np.arange(12) * np.pi / 6
    r = np.where(np.arange(12) % 2, 60.0, 105.0)
    return shapely.Polygon(np.column_stack([119.7 + r * np.cos(u), 120.4 + r * np.sin(u)]))


SHAPES = {"disc": disc(), "square": turned_square(), "spiky": spiky()}


def covered(area: shapely.Polygon, hard: bool = False) -> np.ndarray:
    """(SIZE, SIZE) shares of pixels that an area covers, exactly; or if it has their middle."""
    column, row = np.meshgrid(np.arange(SIZE), np.arange(SIZE))
    shapely.prepare(area)
    if hard:
        return shapely.contains_xy(area, column + 0.5, row + 0.5).astype(float)
    pixels = shapely.box(column, row, column + 1, row + 1)
    share = shapely.contains(area, pixels).astype(float)
    edge = shapely.intersects(area.boundary, pixels)
    share[edge] = shapely.area(shapely.intersection(pixels[edge], area))
    return share


def grey(share: np.ndarray, dark: int = 0, light: int = 255) -> Image.Image:
    return Image.fromarray(np.round(light + (dark - light) * share).astype(np.uint8))


def png(image: Image.Image, **options: Any) -> bytes:
    stream = io.BytesIO()
    image.save(stream, "PNG", **options)
    return stream.getvalue()


def jpeg(image: Image.Image, **options: Any) -> bytes:
    stream = io.BytesIO()
    image.save(stream, "JPEG", quality=95, **options)
    return stream.getvalue()


def errors(folder: Path, content: bytes, area: shapely.Polygon, **reading: Any) -> np.ndarray:
    """[pixel] Distances of points of the area's edges from what is read, away from corners."""
    path = folder / "a.png"
    path.write_bytes(content)
    (shape,) = read_drawing(path, Reading(**reading)).shapes
    ring = flatten(shape.rings[0][0], 1e-3)
    read = shapely.LinearRing(np.column_stack([ring[:, 0], SIZE - ring[:, 1]]))
    points = shapely.points(shapely.get_coordinates(shapely.segmentize(area.exterior, 0.2)))
    corners = shapely.get_coordinates(area.exterior)[:-1]
    if len(corners) < 100:
        near = shapely.distance(shapely.MultiPoint(corners), points)
        points = points[near > 4.0]
    shapely.prepare(read)
    return shapely.distance(read, points)


@pytest.mark.parametrize("name", SHAPES)
def test_grey_edges_are_found_to_a_tenth_of_a_pixel(tmp_path: Path, name: str):
    share = covered(SHAPES[name])
    for image in (grey(share), grey(share, 60, 200), grey(share, 100, 250).convert("RGB")):
        assert errors(tmp_path, png(image), SHAPES[name]).max() <= 0.1
    assert errors(tmp_path, jpeg(grey(share)), SHAPES[name]).max() <= 0.2


@pytest.mark.parametrize("name", SHAPES)
def test_hard_edges_have_no_staircase(tmp_path: Path, name: str):
    image = grey(covered(SHAPES[name], hard=True)).convert("1")
    found = errors(tmp_path, png(image), SHAPES[name])
    assert found.max() <= 0.7
    assert found.mean() <= 0.3
    # The staircase of a slight slope has steps of one pixel; its length would be the sum of both
    # sides of each, 5 % longer for a slope of 1 in 20.
    traced = traced_bytes(tmp_path, "a.png", png(image), width=140.0, unit="mm", tolerance=0.02)
    if name == "square":
        box = turned_square().bounds
        longer = traced.outline.polygon.length * max(box[2] - box[0], box[3] - box[1]) / 140.0
        assert longer <= 1.01 * turned_square().length


def test_the_width_is_asked_for_and_counts(tmp_path: Path):
    content = png(grey(covered(disc())), dpi=(300, 300))
    for reading in ({}, {"unit": "mm"}):
        with pytest.raises(FormatError, match="a width is needed"):
            traced_bytes(tmp_path, "a.png", content, **reading)
    found = traced_bytes(tmp_path, "a.png", content, width=60.0, unit="mm")
    assert off_by(found, shapely.affinity.scale(disc(), 60 / 180, 60 / 180)) <= 2e-3


def test_the_alpha_channel_is_the_object(tmp_path: Path):
    share = np.round(255 * covered(spiky())).astype(np.uint8)
    noise = np.random.default_rng(0).integers(0, 255, (SIZE, SIZE, 3), dtype=np.uint8)
    image = Image.fromarray(np.dstack([noise, share]))
    assert errors(tmp_path, png(image), spiky()).max() <= 0.1
    half = Image.fromarray(np.dstack([share // 2, share]))  # LA
    assert errors(tmp_path, png(half), spiky()).max() <= 0.1
    opaque = Image.fromarray(np.dstack([np.array(grey(share / 255))] * 3 + [0 * share + 255]))
    assert errors(tmp_path, png(opaque), spiky()).max() <= 0.1


def test_a_light_object_on_dark_ground_is_told(tmp_path: Path):
    content = png(grey(covered(spiky()), 250, 30))
    assert errors(tmp_path, content, spiky()).max() <= 0.1
    found = traced_bytes(tmp_path, "a.png", content, width=1.0)
    assert any("border is dark" in note for note in found.notes)


def every_kind() -> dict[str, bytes]:
    base = grey(covered(spiky()))
    deep = (65535 - 257 * (255 - np.array(base, dtype=np.uint16))).astype(np.uint16)
    palette = base.convert("P", palette=Image.Palette.ADAPTIVE)
    clear = base.convert("RGB").quantize(64)
    return {
        "grey": png(base),
        "colours": png(base.convert("RGB")),
        "16 bits": png(Image.fromarray(deep)),
        "palette": png(palette),
        "palette with a clear colour": png(clear, transparency=200),
        "interlaced": png(base, optimize=True),
        "CMYK": jpeg(base.convert("CMYK")),
        "progressive": jpeg(base, progressive=True),
        "animated": png(base, save_all=True, append_images=[Image.new("L", base.size, 128)]),
    }


@pytest.mark.parametrize("kind", every_kind())
def test_every_kind_of_image_is_read(tmp_path: Path, kind: str):
    content = every_kind()[kind]
    assert errors(tmp_path, content, spiky()).max() <= 0.35
    found = traced_bytes(tmp_path, "a.png", content, width=1.0)
    assert ("frames" in " ".join(found.notes)) == (kind == "animated")


@pytest.mark.parametrize("orientation", range(1, 9))
def test_the_camera_s_orientation_counts(tmp_path: Path, orientation: int):
    area = shapely.Polygon([(40, 30), (200, 30), (200, 80), (90, 80), (90, 180), (40, 180)])
    image = grey(covered(area))
    back = {
        2: "FLIP_LEFT_RIGHT", 3: "ROTATE_180", 4: "FLIP_TOP_BOTTOM", 5: "TRANSPOSE",
        6: "ROTATE_90", 7: "TRANSVERSE", 8: "ROTATE_270",
    }  # fmt: skip
    if orientation in back:
        image = image.transpose(getattr(Image.Transpose, back[orientation]))
    exif = Image.Exif()
    exif[0x0112] = orientation
    assert errors(tmp_path, jpeg(image, exif=exif), area).max() <= 0.2


def test_other_blobs_holes_and_edges_are_told(tmp_path: Path):
    image = Image.new("L", (SIZE, SIZE), 255)
    draw = ImageDraw.Draw(image)
    draw.rectangle((60, 60, 239, 150), fill=0)
    draw.ellipse((100, 90, 130, 120), fill=255)
    draw.ellipse((10, 10, 40, 40), fill=0)
    draw.point([(20, 200), (25, 220)], fill=0)
    found = traced_bytes(tmp_path, "a.png", png(image), width=180.0, unit="mm")
    notes = " ".join(found.notes)
    assert "another blob was left out" in notes
    assert "reaches the right edge of the image" in notes
    assert "a hole inside" in notes
    assert off_by(found, shapely.box(0, 0, 180, 91)) <= 5e-3


def test_the_threshold_is_where_the_user_puts_it(tmp_path: Path):
    image = Image.new("L", (SIZE, SIZE), 250)
    draw = ImageDraw.Draw(image)
    draw.rectangle((40, 40, 199, 139), fill=150)
    draw.rectangle((60, 60, 99, 119), fill=20)
    content = png(image)
    wide = traced_bytes(tmp_path, "a.png", content, width=160.0, threshold=0.8)
    tall = traced_bytes(tmp_path, "a.png", content, width=60.0, threshold=0.3)
    assert off_by(wide, shapely.box(0, 0, 160, 100)) <= 5e-3
    assert off_by(tall, shapely.box(0, 0, 40, 60)) <= 2e-2


def chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def bomb(width: int, height: int) -> bytes:
    """A PNG that says it is as large, with hardly any data."""
    header = chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0))
    rows = zlib.compress(bytes(1_000_000), 9)
    return b"\x89PNG\r\n\x1a\n" + header + chunk(b"IDAT", rows) + chunk(b"IEND", b"")


@pytest.mark.parametrize(
    ("content", "why"),
    [
        (bomb(6_000, 6_000), "at most 25000000 are allowed"),
        (bomb(100_000, 100_000), "more than 25000000 pixels"),
        (bomb(2**31 - 1, 2**31 - 1), "more than 25000000 pixels|header is damaged"),
        (bomb(2, 2), "3 x 3 are needed"),
        (png(grey(covered(disc())))[:-400], "cannot be decoded"),
        (jpeg(grey(covered(disc())))[:-4000], "cannot be decoded"),
        (b"\x89PNG\r\n\x1a\n", "no PNG or JPEG image"),
        (b"GIF89a" + bytes(100), "no PNG or JPEG image"),
        (png(Image.new("L", (50, 50), 77)), "all pixels of the image are the same"),
        (png(Image.effect_noise((60, 60), 1)), "too little contrast"),
        (png(Image.new("RGBA", (50, 50), (0, 0, 0, 0))), "all pixels"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_what_shows_no_object_is_refused(tmp_path: Path, content: bytes, why: str):
    with pytest.raises(FormatError, match=why) as caught:
        traced_bytes(tmp_path, "a.png", content, width=10.0)
    assert "\n" not in str(caught.value)
