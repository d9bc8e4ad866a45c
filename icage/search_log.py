"""What a search in contact space has met, step by step."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class SearchStep:
    """One node that a search in contact space has met. [Bunis2018, Sec. VI]

    ``kind`` is "minimum" (least node of a convex region), "side" (a finger passes a vertex),
    "diagonal" (the third finger passes to the next piece of the plane), "wall" (a gluing seam),
    "tunnel" or "pinch". ``pair`` are the fingers (1..3) on ``edges``: edge q starts at vertex q of
    the ring without straight vertices.
    """

    sigma: float
    pair: tuple[int, int]
    edges: tuple[int, int]
    kind: str


@dataclass(frozen=True, slots=True)
class SearchLog:
    """How a search in contact space went."""

    iterations: tuple[SearchStep, ...]
    rectangles_explored: int
    rectangles_total: int
    nodes: int
    tunnel_edges_tried: int
    tunnel_edges_used: int
