"""What a best-first search through the contact space of a hand has found. [Bunis2018, Sec. VI]"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final, NamedTuple

import numpy as np

from icage.arrays import ComplexArray, FloatArray, IntArray
from icage.contact_space.kernels.columns import (
    ABOVE,
    BELOW,
    EDGE_FROM,
    EDGE_KIND,
    EDGE_LABEL,
    END_LOWER,
    ENTRY_LABEL,
    HAND_LEVEL,
    NODE_SIGMA,
    REGION_EDGE,
    REGION_PIECE,
    TUNNEL_BELOW,
    EdgeKind,
    Ending,
)
from icage.contact_space.kernels.explore import explore
from icage.contact_space.kernels.rectangle import (
    FIRST_SLOT,
    MOST_CORNERS,
    least_of_region,
    region_corners,
)
from icage.contact_space.kernels.tunnels import all_tunnels
from icage.contact_space.surroundings import Surroundings, surroundings
from icage.errors import GeometryError
from icage.hand import HandShape
from icage.outline import Outline
from icage.search_log import SearchLog, SearchStep

REGION_LIMIT: Final = 5_000_000
"""Convex regions visited before the search gives up: about 2 GB."""

_SIDES: Final = "side"


class TunnelEdges(NamedTuple):
    """All tunnel edges of a hand, and where a search may enter them.

    ``rows`` (t, 9) and ``hands`` (t, 9) are as of ``all_tunnels``. ``ends`` (e, 2) = row, 1 for its
    lower end, in the order of ``keys`` (e,), one integer for each region.
    """

    keys: IntArray
    ends: IntArray
    rows: IntArray
    hands: FloatArray

    def downwards(self) -> TunnelEdges:
        """The same edges, to be entered from above only."""
        above = self.ends[:, END_LOWER] == 0
        return self._replace(keys=self.keys[above], ends=self.ends[above])


@dataclass(frozen=True, slots=True)
class Plane:
    """One polygon, one hand, and the plane between them cut into convex pieces."""

    outline: Outline
    hand: HandShape
    space: Surroundings
    origin: FloatArray
    remembered: dict[str, TunnelEdges] = field(
        default_factory=dict[str, TunnelEdges], repr=False, compare=False
    )

    @classmethod
    def around(cls, outline: Outline, hand: HandShape, *, merge: bool = True) -> Plane:
        """``merge=False`` keeps the triangles of the paper instead of larger convex pieces."""
        space, origin = surroundings(outline, hand, merge=merge)
        return cls(outline, hand, space, origin)

    def tunnel_edges(self) -> TunnelEdges:
        """All of them, found when first asked for. O(n^2) and O(n) for each candidate."""
        if "tunnels" not in self.remembered:
            rows, hands = all_tunnels(self.space)
            landing = np.flatnonzero(rows[:, TUNNEL_BELOW] >= 0)
            ends = np.concatenate(
                [
                    np.column_stack([np.arange(len(rows)), np.zeros(len(rows), np.int64)]),
                    np.column_stack([landing, np.ones(len(landing), np.int64)]),
                ]
            )
            keys = np.concatenate([self.keys(rows[:, ABOVE]), self.keys(rows[landing, BELOW])])
            order = np.argsort(keys, kind="stable")
            self.remembered["tunnels"] = TunnelEdges(keys[order], ends[order], rows, hands)
        return self.remembered["tunnels"]

    def keys(self, regions: IntArray) -> IntArray:
        """One integer for each region (k, 4)."""
        n, m = self.space.edges, len(self.space.ptr) - 1
        i, j, k, c = regions.T
        return ((i * n + j) * n + k) * m + c

    def corners(self, region: IntArray) -> FloatArray:
        """Corners (m, 2) in (s, u) of region i, j, k, c; empty if there is no such region."""
        corners, spare = np.empty((MOST_CORNERS, 2)), np.empty((MOST_CORNERS, 2))
        i, j, k, c = (int(v) for v in region[:4])
        count = region_corners(self.space, i, j, k, c, corners, spare)
        return corners[:count]

    def least(self, region: IntArray) -> tuple[float, FloatArray]:
        """Least sigma of a region and the hands (2, 4) = d, w at both ends of where it is met."""
        corners = self.corners(region)
        i, j, k = (int(v) for v in region[:3])
        least = least_of_region(self.space, i, j, k, corners, len(corners))
        ends = [
            self.hand_at(region, least.s, least.u),
            self.hand_at(region, least.s_too, least.u_too),
        ]
        return float(least.sigma), np.array(ends)

    def hand_at(self, region: IntArray, s: float, u: float) -> FloatArray:
        """(4,) = d, w (relative to the origin) of fingers i, i + 1 at s, u. [Bunis2018, Eq. (2)]"""
        space, i = self.space, int(region[0])
        j, k = int(region[1]), int(region[2])
        a = complex(space.edge_x[j] + s * space.edge_tx[j], space.edge_y[j] + s * space.edge_ty[j])
        b = complex(space.edge_x[k] + u * space.edge_tx[k], space.edge_y[k] + u * space.edge_ty[k])
        w = (b - a) * complex(space.unit_re[i], space.unit_im[i])
        d = a - w * complex(self.hand.z[i])
        return np.array([d.real, d.imag, w.real, w.imag])

    def fingers(self, hand: FloatArray) -> ComplexArray:
        """Fingers (3,) of a hand (4,) = d, w, relative to the origin."""
        return complex(hand[0], hand[1]) + complex(hand[2], hand[3]) * self.hand.z

    def contacts(self, hand: FloatArray) -> FloatArray:
        """Fingers (3, 2) in the object's frame."""
        f = self.fingers(hand)
        return np.column_stack([f.real, f.imag]) + self.origin

    def placement(self, hand: FloatArray) -> FloatArray:
        """(4,) = x, y, theta, sigma in the object's frame."""
        x, y = hand[:2] + self.origin
        return np.array([x, y, np.arctan2(hand[3], hand[2]), np.hypot(hand[2], hand[3])])


@dataclass(frozen=True, slots=True)
class Exploration:
    """The explored part of the caging graph: a star per convex region, seams between them.

    Attributes
    ----------
    regions:
        (r, 5) = pair i, edges j and k, piece c, edge it was first reached by (-1: the start).
    nodes:
        (r, 4) = least sigma of the region, its s and u, level at which it was reached.
    edges:
        (e, 4) = from, to (-1: a pinch), label or row of the tunnel edge, kind (SEAM, TUNNEL,
        PINCH).
    hands:
        (e, 9) = level, a hand of least sigma on the edge, the hand at a tunnel's other end.
    entries, places, left:
        Open list: (p, 2) = region, label; (p, 2) = s, u; rows that were never closed.
    tunnels_used:
        Tunnel edges that first reached a region, or a pinched hand.
    """

    plane: Plane
    outcome: Ending
    level: float
    regions: IntArray
    nodes: FloatArray
    edges: IntArray
    hands: FloatArray
    entries: IntArray
    places: FloatArray
    left: IntArray
    tunnels_used: int

    @property
    def escaped(self) -> bool:
        """Whether a pinched hand was reached; its level is sigma_max."""
        return self.outcome == Ending.ESCAPED

    @property
    def closed_in(self) -> bool:
        """Whether the open list ran empty: the hand never escapes."""
        return self.outcome == Ending.CLOSED_IN

    def way_out(self) -> list[int]:
        """Edges from the start to the pinched hand, in order; empty if there is none."""
        if not self.escaped or not len(self.edges):
            return []
        way: list[int] = []
        if self.edges[-1, EDGE_KIND] == EdgeKind.PINCH:
            way.append(len(self.edges) - 1)
            region = int(self.edges[-1, EDGE_FROM])
        else:
            region = len(self.regions) - 1
        while self.regions[region, REGION_EDGE] >= 0:
            way.append(int(self.regions[region, REGION_EDGE]))
            region = int(self.edges[way[-1], EDGE_FROM])
        return way[::-1]

    def log(self) -> SearchLog:
        """The nodes in the order in which they were met, and the counters."""
        steps = [self._step(0, float(self.nodes[0, NODE_SIGMA]), "minimum")]
        for e, (origin, to, _, _) in enumerate(self.edges.tolist()):
            steps.append(self._step(origin, float(self.hands[e, HAND_LEVEL]), self.kind(e)))
            if to >= 0 and self.regions[to, REGION_EDGE] == e:
                steps.append(self._step(to, float(self.nodes[to, NODE_SIGMA]), "minimum"))
        rectangles = np.unique(self.regions[:, :3], axis=0)
        crossed = self.edges[:, EDGE_KIND] != EdgeKind.SEAM
        return SearchLog(
            iterations=tuple(steps),
            rectangles_explored=len(rectangles),
            rectangles_total=3 * self.plane.space.edges**2,
            nodes=len(self.regions) + int((self.entries[:, ENTRY_LABEL] >= 0).sum()),
            tunnel_edges_tried=len(np.unique(self.edges[crossed, EDGE_LABEL])),
            tunnel_edges_used=self.tunnels_used,
        )

    def kind(self, edge: int) -> str:
        """What an edge crosses: side, diagonal, wall; or tunnel, pinch. See ``SearchStep``."""
        origin, _, label, kind = (int(v) for v in self.edges[edge])
        if kind != EdgeKind.SEAM:
            return EdgeKind(kind).name.lower()
        if label < FIRST_SLOT:
            return _SIDES
        slot = int(self.plane.space.ptr[self.regions[origin, REGION_PIECE]]) + label - FIRST_SLOT
        return "wall" if self.plane.space.slot_edge[slot] >= 0 else "diagonal"

    def _step(self, region: int, sigma: float, kind: str) -> SearchStep:
        i, j, k = (int(v) for v in self.regions[region, :3])
        return SearchStep(sigma, (i + 1, (i + 1) % 3 + 1), (j, k), kind)


NO_TUNNEL_EDGES: Final = TunnelEdges(
    np.zeros(0, np.int64), np.zeros((0, 2), np.int64), np.zeros((0, 9), np.int64), np.zeros((0, 9))
)


def explore_from(
    plane: Plane, region: IntArray, *, tunnels: bool = True, both_ways: bool = True,
    stop_above: float = np.inf, limit: int = REGION_LIMIT,
) -> Exploration:  # fmt: skip
    """I-CAGE from a region that holds the target.

    ``tunnels=False`` drops Sec. V-B, for teaching. ``both_ways=False`` takes tunnel edges only
    downwards, as the paper does, whose search knows an edge once it has closed its upper end; then
    it may miss basins whose only connection is a tunnel edge that comes down to it.

    Raises
    ------
    GeometryError:
        More than ``limit`` regions.
    """
    start = np.asarray(region[:4], dtype=np.int64)
    edges = plane.tunnel_edges() if tunnels else NO_TUNNEL_EDGES
    found = explore(
        plane.space, start, *(edges if both_ways else edges.downwards()), stop_above, limit
    )
    if found.outcome == Ending.GAVE_UP:
        raise GeometryError(f"the search gave up after {limit} convex regions")
    return Exploration(
        plane=plane,
        outcome=Ending(found.outcome),
        level=float(found.level),
        regions=found.regions,
        nodes=found.nodes,
        edges=found.edges,
        hands=found.hands,
        entries=found.entries,
        places=found.places,
        left=found.left,
        tunnels_used=int(found.tunnels_used),
    )
