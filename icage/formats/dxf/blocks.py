"""What the model space shows: entities on the layers that count, blocks put where INSERTs say."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np

from icage.arrays import FloatArray
from icage.errors import FormatError
from icage.formats.drawings.curves import Bezier, Curve, EllipseArc
from icage.formats.drawings.drawing import Line, Ring
from icage.formats.drawings.rational import RationalBezier
from icage.formats.dxf.entities import NO_OUTLINE, Chains, chains_of, moved, vectors_of
from icage.formats.dxf.layers import Layers, layer_of, property_of
from icage.outline import LARGEST_COORDINATE

MAX_CURVES: Final = 50_000
"""Edges, arcs and Bezier pieces, counted where they are shown: once for each INSERT."""

MAX_VISITS: Final = 200_000
"""Entities looked at, counted as curves are: blocks of nothing may be many, too."""

MAX_DEPTH: Final = 50
"""Blocks in blocks."""

_FLAT: Final = 1e-6
"""[size of the entity] Heights z may differ by so much in an entity that is parallel to xy."""


@dataclass(slots=True, eq=False)
class Shown:
    """What has been found so far.

    Attributes
    ----------
    lines:
        In the world's coordinates, without z.
    left_out:
        How many entities of each kind that draws no outline.
    notes:
        Warnings, a sentence each.
    heights:
        Lowest and highest z.
    """

    layers: Layers
    lines: list[Line] = field(default_factory=list)
    left_out: Counter[str] = field(default_factory=Counter)
    notes: dict[str, None] = field(default_factory=dict)
    heights: tuple[float, float] = (np.inf, -np.inf)
    curves: int = 0
    visits: int = 0
    chains: dict[int, tuple[Chains, str]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, eq=False)
class Place:
    """Where the entities of a block are shown: p -> p @ turn + shift."""

    turn: FloatArray
    shift: FloatArray
    layer: str | None = None
    blocks: tuple[str, ...] = ()


WORLD: Final = Place(np.eye(3), np.zeros(3))


def show(entities: Iterable[Any], place: Place, shown: Shown) -> None:
    """Add what entities draw to ``shown``, and what the blocks draw that they insert.

    Raises
    ------
    FormatError:
        Not understood, too much, or a block that inserts itself.
    """
    for entity in entities:
        shown.visits += 1
        if shown.visits > MAX_VISITS:
            raise _too_many("entities", MAX_VISITS)
        layer = layer_of(entity)
        # What is on layer 0 of a block is on the layer of its INSERT.
        if layer == "0" and place.layer is not None:
            layer = place.layer
        if property_of(entity, "invisible", 60, 0):
            continue
        if entity.dxftype() == "INSERT":
            if not shown.layers.frozen(layer):
                _insert(entity, layer, place, shown)
        elif shown.layers.counts(layer):
            _draw(entity, layer, place, shown)


def _draw(entity: Any, layer: str, place: Place, shown: Shown) -> None:
    kind = entity.dxftype()
    if kind in NO_OUTLINE:
        shown.left_out[kind] += 1
        return
    name = f"{kind} {entity.dxf.handle or ''}".strip() + f" on layer {layer!r}"
    try:
        if id(entity) not in shown.chains:
            shown.chains[id(entity)] = chains_of(entity)
        chains, note = shown.chains[id(entity)]
        if note:
            shown.notes[note] = None
        for chain in chains:
            shown.curves += len(chain)
            if shown.curves > MAX_CURVES:
                raise _too_many("curves", MAX_CURVES)
            placed = [moved(curve, place.turn, place.shift) for curve in chain]
            flat = _flattened(placed, shown)
            shown.lines.append(Line(flat, tuple(dict.fromkeys((layer, *place.blocks)))))
    except _TooMany:
        raise
    except FormatError as error:
        said = str(error)
        verb = "" if said.startswith(("is ", "has ")) else "has "
        raise FormatError(f"{name} {verb}{said}") from error
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        # Whatever ezdxf or numpy meets in an entity that is not what the format says.
        raise FormatError(f"{name} is not as DXF wants it ({error})") from error


def _insert(entity: Any, layer: str, place: Place, shown: Shown) -> None:
    name = str(entity.dxf.get("name", ""))
    block = entity.block()
    if block is None:
        raise FormatError(f"INSERT of the block {name!r}, which the file does not have")
    if entity.is_xref():
        raise FormatError(f"block {name!r} is in another file (an xref): bind it")
    if name.lower() in (one.lower() for one in place.blocks):
        raise FormatError(f"block {name!r} inserts itself")
    if len(place.blocks) >= MAX_DEPTH:
        raise FormatError(f"blocks are nested more than {MAX_DEPTH} deep")
    shown.left_out["ATTRIB"] += len(entity.attribs)
    matrix = np.array(list(entity.matrix44())).reshape(4, 4)
    if not np.isfinite(matrix).all():
        raise FormatError(f"INSERT of the block {name!r} has numbers that are not finite")
    turn = matrix[:3, :3]
    for offset in _grid(entity, shown):
        shift = (matrix[3, :3] + offset) @ place.turn + place.shift
        inner = Place(turn @ place.turn, shift, layer, (*place.blocks, name))
        show(block, inner, shown)


def _grid(entity: Any, shown: Shown) -> Iterable[FloatArray]:
    """Offsets of an array of blocks: turned with the INSERT, not scaled. Those of no spacing once.

    Columns run along the x of the INSERT's own system, rows along y.
    """
    dxf = entity.dxf
    columns, rows = max(int(dxf.column_count), 1), max(int(dxf.row_count), 1)
    columns = columns if dxf.column_spacing else 1
    rows = rows if dxf.row_spacing else 1
    if columns * rows > MAX_VISITS:
        raise _too_many("entities", MAX_VISITS)
    ocs = entity.ocs()
    axes = np.array([tuple(ocs.ux), tuple(ocs.uy)]) if ocs.transform else np.eye(3)[:2]
    angle = np.radians(float(dxf.rotation))
    along = np.array([np.cos(angle), np.sin(angle)]) @ axes * float(dxf.column_spacing)
    up = np.array([-np.sin(angle), np.cos(angle)]) @ axes * float(dxf.row_spacing)
    for row in range(rows):
        for column in range(columns):
            shown.visits += 1
            if shown.visits > MAX_VISITS:
                raise _too_many("entities", MAX_VISITS)
            yield (column * along if column else 0.0 * axes[0]) + (row * up if row else 0.0)


def _flattened(chain: list[Curve], shown: Shown) -> Ring:
    """The chain in the xy plane, its height left out."""
    bounds = np.vstack([vectors_of(curve) for curve in chain])
    if not np.isfinite(bounds).all() or np.abs(bounds).max() > LARGEST_COORDINATE:
        raise FormatError(f"coordinates that are not finite or beyond {LARGEST_COORDINATE:g}")
    arcs = [curve for curve in chain if isinstance(curve, EllipseArc)]
    if not all(math.isfinite(arc.start + arc.sweep) for arc in arcs):
        raise FormatError("angles that are not finite")
    low, high = bounds.min(axis=0), bounds.max(axis=0)
    if high[2] - low[2] > _FLAT * float((high - low).max()):
        raise FormatError(
            "is not parallel to the xy plane: export a flat drawing, or the part as STL"
        )
    shown.heights = min(shown.heights[0], low[2]), max(shown.heights[1], high[2])
    return tuple(_without_z(curve) for curve in chain)


def _without_z(curve: Curve) -> Curve:
    if isinstance(curve, EllipseArc):
        return EllipseArc(curve.centre[:2], curve.a[:2], curve.b[:2], curve.start, curve.sweep)
    if isinstance(curve, RationalBezier):
        return RationalBezier(curve.control[:, :2], curve.weights)
    assert isinstance(curve, Bezier)
    return Bezier(curve.control[:, :2])


class _TooMany(FormatError):
    """A limit of the whole drawing, not of one entity."""


def _too_many(what: str, limit: int) -> FormatError:
    return _TooMany(
        f"the drawing shows more than {limit} {what}, blocks counted where they are inserted"
    )
