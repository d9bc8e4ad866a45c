"""All features, one small drawing each."""

from __future__ import annotations

from tests.icage.formats.svg.features.clips_and_strokes import CLIPS, STROKES
from tests.icage.formats.svg.features.paint_and_style import PAINT, STYLE
from tests.icage.formats.svg.features.shapes_and_structure import SHAPES, STRUCTURE, TRANSFORMS

FEATURES = [*STROKES, *SHAPES, *STRUCTURE, *TRANSFORMS, *PAINT, *STYLE, *CLIPS]
