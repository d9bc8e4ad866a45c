"""The properties that decide what is drawn where: initial values, inheritance, attributes."""

from __future__ import annotations

from typing import Final

INHERITED: Final = {
    "fill": "black", "fill-rule": "nonzero", "fill-opacity": "1", "clip-rule": "nonzero",
    "stroke": "none", "stroke-width": "1", "stroke-opacity": "1", "stroke-linecap": "butt",
    "stroke-linejoin": "miter", "stroke-miterlimit": "4", "stroke-dasharray": "none",
    "visibility": "visible", "color": "black", "font-size": "16px", "marker-start": "none",
    "marker-mid": "none", "marker-end": "none",
}  # fmt: skip
"""With their initial values."""

OWN: Final = {
    "opacity": "1", "display": "inline", "clip-path": "none", "transform": "none",
    "transform-origin": "", "transform-box": "view-box", "overflow": "", "vector-effect": "none",
    "stop-color": "black", "stop-opacity": "1",
}  # fmt: skip
"""Not inherited, with their initial values; an empty one depends on the element."""

REFUSED: Final = {
    "mask": "none", "mask-image": "none", "mask-border": "none", "filter": "none",
    "backdrop-filter": "none", "animation": "none", "animation-name": "none", "translate": "none",
    "rotate": "none", "scale": "none", "offset": "none", "offset-path": "none", "clip": "auto",
    "zoom": "normal", "perspective": "none", "all": "", "-webkit-mask": "none",
    "-webkit-mask-image": "none", "-webkit-clip-path": "none", "-webkit-transform": "none",
    "-webkit-filter": "none", "content-visibility": "visible",
}  # fmt: skip
"""What would change a drawing and is not supported, with the values that change nothing."""

GEOMETRY: Final = {
    "x": ("svg", "rect", "use", "image", "foreignObject"),
    "y": ("svg", "rect", "use", "image", "foreignObject"),
    "width": ("svg", "rect", "use", "symbol", "image", "foreignObject"),
    "height": ("svg", "rect", "use", "symbol", "image", "foreignObject"),
    "cx": ("circle", "ellipse"),
    "cy": ("circle", "ellipse"),
    "r": ("circle",),
    "rx": ("rect", "ellipse"),
    "ry": ("rect", "ellipse"),
    "d": ("path",),
}
"""Attributes that are properties, of the elements named. [SVG2018, Sec. 6]"""

KNOWN: Final = {*INHERITED, *OWN, *REFUSED, *GEOMETRY, "marker", "font"}

ATTRIBUTES: Final = {*INHERITED, *OWN, "mask", "filter", "clip"}
"""Properties that may stand as an attribute of any element."""
