"""Minima, grasps and punctures of an explored contact space. [Bunis2018, Prop. 4.2]"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from icage.arrays import FloatArray
from icage.cage import GraspMinimum, Puncture
from icage.contact_space.exploration import Exploration, Plane
from icage.contact_space.kernels.columns import EDGE_TO, HAND, HAND_LEVEL, NODE_SIGMA
from icage.contact_space.kernels.forest import persistence
from icage.contact_space.target import ContactTarget
from icage.geometry.statics import free_fingers
from icage.tolerance import DEPTH_CUT, LEVEL, PLATEAU


class Meeting(NamedTuple):
    """The target's basin meets basins with these minima (regions), by an edge, at a level."""

    sigma: float
    edge: int
    minima: tuple[int, ...]


def below_escape(found: Exploration) -> float:
    """The level just below sigma_max: what merges at it belongs to the escape."""
    return found.level * (1.0 - 2.0 * LEVEL)


def meetings(found: Exploration, depth_cut: float) -> list[Meeting]:
    """Merges of the target's basin with basins deeper than ``depth_cut`` [unit], ascending."""
    births = np.ascontiguousarray(found.nodes[:, NODE_SIGMA])
    values = np.ascontiguousarray(found.hands[:, HAND_LEVEL])
    tree = persistence(births, found.edges, values, below_escape(found))
    counted: dict[int, tuple[int, ...]] = {}
    home = 0  # the elder minimum of the component that holds the start
    met: list[Meeting] = []
    for (elder, younger, edge), level in zip(
        tree.merges.tolist(), tree.levels.tolist(), strict=True
    ):
        kept = counted.pop(elder, (elder,))
        lost = counted.pop(younger, (younger,))
        deep = level - births[younger] > depth_cut
        if deep and home in (elder, younger):
            met.append(Meeting(level, edge, lost if home == elder else kept))
        counted[elder] = kept + lost if deep else kept
        home = elder if home == younger else home
    return met


def first_level(found: Exploration) -> float:
    """sigma_first, [unit]: the first meeting, else the escape."""
    met = meetings(found, DEPTH_CUT * found.plane.outline.diameter)
    return met[0].sigma if met else found.level


def grasps_and_punctures(
    found: Exploration, target: ContactTarget
) -> tuple[tuple[GraspMinimum, ...], tuple[Puncture, ...]]:
    """All grasps of the cage, the target first, and the punctures in ascending order."""
    plane = found.plane
    met = meetings(found, DEPTH_CUT * plane.outline.diameter)
    others = [(_grasp(found, node, m.sigma), node) for m in met for node in m.minima]
    others.sort(key=lambda pair: (round(pair[0].sigma, 12), pair[0].contacts.ravel().tolist()))
    contacts = plane.contacts(target.hand)
    free = free_fingers(plane.outline, contacts)
    grasps = [GraspMinimum(0, True, target.sigma_0, contacts, None, free, target.sigma_0)]
    numbers: dict[int, int] = {}
    for number, (g, node) in enumerate(others, start=1):
        numbers[node] = number
        grasps.append(
            GraspMinimum(number, False, g.sigma, g.contacts, g.plateau, g.free_fingers, g.joined_at)
        )
    punctures: list[Puncture] = []
    for meeting in met:
        joins = tuple(sorted(numbers[node] for node in meeting.minima))
        if punctures and meeting.sigma <= punctures[-1].sigma * (1.0 + 2.0 * LEVEL):
            p = punctures.pop()
            joins = tuple(sorted((*p.joins, *joins)))
            punctures.append(Puncture(p.sigma, p.kind, joins, p.contacts, p.free_fingers))
        else:
            at = plane.contacts(found.hands[meeting.edge, HAND])
            free = free_fingers(plane.outline, at)
            punctures.append(Puncture(meeting.sigma, "intermediate", joins, at, free))
    if found.escaped:
        at = plane.contacts(found.hands[escape_edge(found), HAND])
        free = free_fingers(plane.outline, at)
        punctures.append(Puncture(found.level, "escape", (), at, free))
    return tuple(grasps), tuple(punctures)


def escape_edge(found: Exploration) -> int:
    """The edge of the escape puncture: the first one on the way out at the level of the escape."""
    way = found.way_out()
    high = found.hands[way, HAND_LEVEL] >= below_escape(found)
    return way[int(np.argmax(high))]


def _grasp(found: Exploration, node: int, joined_at: float) -> GraspMinimum:
    plane = found.plane
    sigma = float(found.nodes[node, NODE_SIGMA])
    ends = _valley(found, node, sigma)
    contacts = plane.contacts(0.5 * (ends[0] + ends[1]))
    plateau = None
    if float(np.hypot(*(ends[1] - ends[0])[:2])) > PLATEAU * plane.outline.diameter:
        plateau = plane.contacts(ends[0]), plane.contacts(ends[1])
    return GraspMinimum(
        -1, False, sigma, contacts, plateau, free_fingers(plane.outline, contacts), joined_at
    )


def _valley(found: Exploration, node: int, sigma: float) -> FloatArray:
    """Both ends (2, 4) of a minimum: one hand, or a slide through all regions at its level."""
    plane, tie = found.plane, found.plane.space.tie
    _, ends = plane.least(found.regions[node])
    level = (found.hands[:, HAND_LEVEL] <= sigma + tie) & (found.edges[:, EDGE_TO] >= 0)
    inside, new = {node}, {node}
    neighbours: dict[int, list[int]] = {}
    for a, b in found.edges[level, :2].tolist():
        neighbours.setdefault(a, []).append(b)
        neighbours.setdefault(b, []).append(a)
    while new:
        reached = {b for a in new for b in neighbours.get(a, [])} - inside
        new = {b for b in reached if found.nodes[b, NODE_SIGMA] >= sigma - tie}
        inside |= new
    all_ends = np.concatenate([ends, *(plane.least(found.regions[r])[1] for r in sorted(inside))])
    return _farthest(plane, all_ends)


def _farthest(plane: Plane, ends: FloatArray) -> FloatArray:
    """The two of the hands that are farthest apart (of those with the same w as the first)."""
    same = np.hypot(*(ends[:, 2:] - ends[0, 2:]).T) <= PLATEAU * plane.outline.diameter
    rows = ends[same]
    far = int(np.argmax(np.hypot(*(rows[:, :2] - rows[0, :2]).T)))
    back = int(np.argmax(np.hypot(*(rows[:, :2] - rows[far, :2]).T)))
    return rows[[far, back]]
