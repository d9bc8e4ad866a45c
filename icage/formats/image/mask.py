"""Which pixels are the object: a level between object and ground, the largest blob of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from scipy import ndimage

from icage.arrays import AnyArray, BoolArray, GreyArray
from icage.errors import FormatError
from icage.formats.image.pixels import Pixels

_LEVELS: Final = 256

_CONTRAST: Final = 0.05
"""Least difference between object and ground, of 0 to 1."""

_DUST: Final = 1e-4
"""[blob] Smaller holes are filled, smaller blobs are not told."""

_AT_EDGE: Final = 3
"""Pixels of the object along an edge of the image from which it counts as cut off."""


@dataclass(frozen=True, slots=True, eq=False)
class Blob:
    """The object in its part of the image, with one pixel of ground around it.

    Attributes
    ----------
    values:
        (rows, columns), larger inside; the contour is at ``level``.
    level:
        Between object and ground.
    corner:
        Row and column of the first pixel in the image; -1 for what was added around it.
    hard:
        Whether no pixel along the edge is in between: a drawing without greys.
    notes:
        Warnings, a sentence each.
    """

    values: GreyArray
    level: float
    corner: tuple[int, int]
    hard: bool
    notes: tuple[str, ...]


def largest_blob(image: Pixels, threshold: float | None) -> Blob:
    """The largest connected set of pixels of the object.

    Raises
    ------
    FormatError:
        Object and ground are not to be told from each other.
    """
    values, notes = image.values, list(image.notes)
    level, ground, body = _levels(image, threshold)
    dark = not image.by_alpha
    border = np.concatenate([values[0], values[-1], values[:, 0], values[:, -1]])
    if dark and float((border < level).mean()) > 0.5:
        notes.append("the image's border is dark: its light pixels were taken for the object")
        dark = False
    if dark:
        values, level, ground, body = -values, -level, -ground, -body
    elif not image.by_alpha:
        ground, body = min(ground, body), max(ground, body)
    inside = values > level
    if not inside.any() or inside.all():
        raise FormatError("all pixels are on one side of the threshold: nothing stands out")
    labels = _labelled(inside)
    sizes = np.bincount(labels.ravel())
    sizes[0] = 0
    mine = labels == int(sizes.argmax())
    area = int(sizes.max())
    others = int((sizes > max(_DUST * area, 4.0)).sum()) - 1
    if others > 0:
        share = 100.0 * (sizes.sum() - area) / sizes.sum()
        blobs = "another blob was" if others == 1 else f"{others} other blobs were"
        notes.append(
            f"{blobs} left out, with {share:.2g} % of the object's pixels: the largest counts"
        )
    del labels
    notes += _cut_off(mine)
    return _cropped(values, inside, mine, level, (ground, body), tuple(notes))


def _levels(image: Pixels, threshold: float | None) -> tuple[float, float, float]:
    """Level, and what ground and object are: the dark and the light pixels' medians.

    Without a threshold they are told apart as [Otsu1979] does, and the level is in the middle of
    the two medians: there half of a pixel is covered.
    """
    values = image.values
    if image.by_alpha:
        return 0.5 if threshold is None else threshold, 0.0, 1.0
    apart = _otsu(values) if threshold is None else threshold
    light, dark = values[values > apart], values[values <= apart]
    if not len(light) or not len(dark):
        raise FormatError("all pixels are on one side of the threshold: nothing stands out")
    ground, body = float(np.median(light)), float(np.median(dark))
    if ground - body < _CONTRAST:
        raise FormatError(
            f"the image has too little contrast: {ground - body:.2g} of 1, {_CONTRAST:g} is needed"
        )
    return (ground + body) / 2.0 if threshold is None else threshold, ground, body


def _otsu(values: GreyArray) -> float:
    """The level that splits the histogram into the two classes furthest from each other."""
    low, high = float(values.min()), float(values.max())
    if not high > low:
        raise FormatError("all pixels of the image are the same: nothing stands out")
    counts, edges = np.histogram(values, _LEVELS, (low, high))
    middles = (edges[:-1] + edges[1:]) / 2.0
    below = np.cumsum(counts)[:-1]
    sums = np.cumsum(counts * middles)
    above = counts.sum() - below
    means = sums[:-1] / np.maximum(below, 1), (sums[-1] - sums[:-1]) / np.maximum(above, 1)
    between = below * above * (means[1] - means[0]) ** 2
    best = np.flatnonzero(between >= between.max() * (1.0 - 1e-12))
    return float(edges[1:-1][best].mean())


def _cut_off(mine: np.ndarray) -> list[str]:
    edges = {"top": mine[0], "bottom": mine[-1], "left": mine[:, 0], "right": mine[:, -1]}
    touched = [name for name, edge in edges.items() if int(edge.sum()) >= _AT_EDGE]
    if not touched:
        return []
    edge = "edge" if len(touched) == 1 else "edges"
    return [
        f"the object reaches the {' and '.join(touched)} {edge} of the image: what is beyond is "
        "cut off"
    ]


def _cropped(
    values: GreyArray, inside: np.ndarray, mine: np.ndarray, level: float,
    plain: tuple[float, float], notes: tuple[str, ...],
) -> Blob:  # fmt: skip
    rows, columns = np.flatnonzero(mine.any(axis=1)), np.flatnonzero(mine.any(axis=0))
    window = (
        slice(max(rows[0] - 2, 0), rows[-1] + 3),
        slice(max(columns[0] - 2, 0), columns[-1] + 3),
    )
    ground, body = plain
    part = values[window].astype(np.float32)
    own = mine[window]
    # Blobs that are not the object are ground. Where they touch its corners they meet no edge of
    # it, so the contour between the object and its own neighbours stays as it is.
    part[inside[window] & ~own] = ground
    padded: GreyArray = np.pad(part, 1, constant_values=np.float32(ground))
    body_mask = np.pad(own, 1)
    holes = _labelled(~body_mask, np.ones((3, 3)))
    if holes.max() > 1:
        sizes = np.bincount(holes.ravel())
        small = sizes <= max(_DUST * float(own.sum()), 4.0)
        small[[0, holes[0, 0]]] = False
        padded[small[holes]] = body
    corner = int(window[0].start) - 1, int(window[1].start) - 1
    return Blob(padded, level, corner, _is_hard(padded, body_mask, plain), notes)


def _labelled(mask: BoolArray, structure: AnyArray | None = None) -> AnyArray:
    """The number of the connected set that each pixel belongs to; 0 outside of the mask."""
    label: Any = ndimage.label
    return label(mask, structure)[0]


def _is_hard(values: GreyArray, mask: np.ndarray, plain: tuple[float, float]) -> bool:
    """Whether hardly a pixel beside the edge is between object and ground."""
    grown: BoolArray = np.asarray(ndimage.binary_dilation(mask), dtype=bool)
    shrunk: BoolArray = np.asarray(ndimage.binary_erosion(mask), dtype=bool)
    edge = grown & ~shrunk
    ground, body = plain
    share = (values[edge] - ground) / (body - ground)
    return float(((share > 0.1) & (share < 0.9)).mean()) < 0.05
