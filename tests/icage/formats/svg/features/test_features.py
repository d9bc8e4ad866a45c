"""Each feature has the area that a browser paints, as librsvg renders it, or is refused by name."""

from __future__ import annotations

import io
import shutil
import subprocess

import numpy as np
import pytest
import shapely
from PIL import Image

from icage.errors import FormatError
from icage.formats.drawings.area import area_of, drawn_area
from icage.formats.drawings.reading import Reading
from icage.formats.svg.reader import read
from tests.icage.formats.svg.features.feature import Feature
from tests.icage.formats.svg.features.table import FEATURES

RSVG = shutil.which("rsvg-convert")
SCALE = 5
"""Pixels a unit of the page."""

DRAWN = [feature for feature in FEATURES if not feature.refused]
REFUSED = [feature for feature in FEATURES if feature.refused]


def painted(feature: Feature) -> shapely.Geometry:
    """What is painted, y downwards as on the page."""
    drawing = read(feature.text.encode(), Reading(strokes=feature.strokes))
    areas = [area_of(shape, 1e-4) for shape in drawing.shapes]
    if feature.strokes == "drawn":
        areas += [drawn_area(line, 1e-4) for line in drawing.lines]
    area = shapely.union_all(areas)
    return shapely.transform(area, lambda points: points * [1.0, -1.0])


def named(features: list[Feature]) -> list[object]:
    return [pytest.param(feature, id=feature.name) for feature in features]


def test_the_table_is_large_and_its_names_are_unique():
    names = [feature.name for feature in FEATURES]
    assert len(set(names)) == len(names) >= 60
    assert sum(feature.rsvg for feature in DRAWN) >= 60


@pytest.mark.parametrize("feature", named(DRAWN))
def test_the_area_is_what_the_table_says(feature: Feature):
    area = painted(feature)
    assert area.area == pytest.approx(feature.area, rel=1e-4)
    if feature.box is not None:
        assert area.bounds == pytest.approx(feature.box, abs=1e-6)


@pytest.mark.skipif(RSVG is None, reason="rsvg-convert (librsvg) is not installed")
@pytest.mark.parametrize("feature", named([one for one in DRAWN if one.rsvg]))
def test_the_area_is_what_librsvg_renders(feature: Feature):
    drawing = read(feature.text.encode(), Reading())
    assert drawing.frame is not None
    x_low, y_low, x_high, y_high = drawing.frame
    wide, high = round(SCALE * (x_high - x_low)), round(SCALE * (y_high - y_low))
    command = [str(RSVG), "--width", str(wide), "--height", str(high), "--accept-language", "en"]
    done = subprocess.run(command, input=feature.text.encode(), capture_output=True, check=True)
    pixels = np.asarray(Image.open(io.BytesIO(done.stdout)).convert("RGBA"))[:, :, 3]
    theirs = pixels >= 0.5 * pixels.max()
    area = painted(feature)
    shapely.prepare(area)
    x = (np.arange(wide) + 0.5) / SCALE + x_low
    y = (np.arange(high) + 0.5) / SCALE - y_high
    ours = shapely.contains_xy(area, *np.meshgrid(x, y))
    assert theirs.shape == ours.shape
    assert ours.any()
    overlap = float((theirs & ours).sum() / (theirs | ours).sum())
    assert overlap >= 0.995


@pytest.mark.parametrize("feature", named(REFUSED))
def test_what_is_not_understood_is_refused_with_its_name(feature: Feature):
    with pytest.raises(FormatError, match=feature.refused) as caught:
        read(feature.text.encode(), Reading(strokes=feature.strokes))
    assert "\n" not in str(caught.value)
