"""Grasps and punctures of the target's component, read off the merge tree."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from icage.arrays import ComplexArray, FloatArray, IntArray
from icage.cage import GraspMinimum, Puncture
from icage.cells.free_space import Configuration, FreeSpace, Search, Tree, below_escape
from icage.cells.kernels.columns import (
    BIRTH_SIGMA,
    BIRTH_WX,
    BORN_FINGER,
    BORN_SLOT,
    LOW_DEPTH,
    LOW_LEVEL,
    MERGE_SIDE,
    PASS_SIGMA,
    StartSide,
)
from icage.cells.kernels.facet import middles_on_facets
from icage.cells.kernels.tree import births, way_to
from icage.cells.target import Target, plateau_through
from icage.geometry.statics import free_fingers, free_fingers_of
from icage.geometry.way_out import corners_before_pinch
from icage.tolerance import DEPTH_CUT, LEVEL


class Joining(NamedTuple):
    """The target's component meets another one, which holds these minima (nodes)."""

    sigma: float
    edge: int
    minima: tuple[int, ...]


def joinings(tree: Tree, depth_cut: float) -> list[Joining]:
    """Merges of the target's component with components deeper than ``depth_cut`` [unit].

    A minimum swallowed less deep than that does not count; its component is only a part of the
    slope of the one that swallows it.
    """
    members: dict[int, list[int]] = {}
    met: list[Joining] = []
    # a shallow minimum holds no other: had it swallowed one, it would be deeper still
    deep = tree.lows[:, LOW_DEPTH] > depth_cut
    for (keep, lose, edge, side), level in zip(
        tree.merges[deep].tolist(), tree.lows[deep, LOW_LEVEL].tolist(), strict=True
    ):
        kept = members.pop(keep, [keep])
        lost = members.pop(lose, [lose])
        if side != StartSide.NEITHER:
            other = kept if side == StartSide.SWALLOWED else lost
            met.append(Joining(level, edge, tuple(other)))
        members[keep] = kept + lost
    return met


def has_joinings_between(tree: Tree, low: float, high: float) -> bool:
    """Whether the target's component meets one deeper than ``low`` but not than ``high``, [unit].

    If not, ``first_joining`` is the same for every depth cut between them.
    """
    depth = tree.lows[:, LOW_DEPTH]
    doubtful = (depth > low) & (depth <= high)
    return bool((tree.merges[doubtful, MERGE_SIDE] != StartSide.NEITHER).any())


def first_joining(tree: Tree, depth_cut: float, escape: float) -> float:
    """sigma_first for a given depth cut, [unit]."""
    met = (tree.lows[:, LOW_DEPTH] > depth_cut) & (tree.merges[:, MERGE_SIDE] != StartSide.NEITHER)
    return float(tree.lows[np.argmax(met), LOW_LEVEL]) if met.any() else escape


def grasps_and_punctures(
    found: Search, tree: Tree, target: Target
) -> tuple[tuple[GraspMinimum, ...], tuple[Puncture, ...], tuple[int, ...]]:
    """All grasps (the target first), the punctures in ascending order, and each grasp's node."""
    free_space = found.free_space
    met = joinings(tree, DEPTH_CUT * free_space.pieces.diameter)
    joined = [(node, joining.sigma) for joining in met for node in joining.minima]
    grasps_of = _grasps(free_space, found, joined)
    others = [(grasp, node) for grasp, (node, _) in zip(grasps_of, joined, strict=True)]
    others.sort(key=lambda pair: (round(pair[0].sigma, 12), pair[0].contacts.ravel().tolist()))
    first = _target_grasp(free_space, target)
    ids = {node: k + 1 for k, (_, node) in enumerate(others)}
    grasps = [first] + [_with_id(g, k + 1) for k, (g, _) in enumerate(others)]
    punctures = _intermediate(found, met, ids)
    if found.escaped:
        punctures.append(_escape(found))
    nodes = (0, *(node for _, node in others))
    return tuple(grasps), tuple(punctures), nodes


def _with_id(grasp: GraspMinimum, number: int) -> GraspMinimum:
    return GraspMinimum(
        number,
        False,
        grasp.sigma,
        grasp.contacts,
        grasp.plateau,
        grasp.free_fingers,
        grasp.joined_at,
    )


def _target_grasp(free_space: FreeSpace, target: Target) -> GraspMinimum:
    contacts = free_space.contacts(target.at)
    return GraspMinimum(
        0,
        True,
        target.sigma_0,
        contacts,
        _plateau_contacts(free_space, target.plateau),
        free_fingers(free_space.outline, contacts),
        target.sigma_0,
    )


def _grasps(
    free_space: FreeSpace, found: Search, joined: list[tuple[int, float]]
) -> list[GraspMinimum]:
    """The least points of nodes, each with the level at which its basin joins the target's."""
    if not joined:
        return []
    pieces, z = free_space.pieces, free_space.z
    nodes = found.nodes[[node for node, _ in joined]]
    # of each cell by itself, whichever of several equal ones the tree has noted
    born = births(pieces, z, nodes, free_space.cap, free_space.worst)
    sigma = born.value[:, BIRTH_SIGMA]
    hands = middles_on_facets(
        pieces, z, nodes, born.where[:, BORN_FINGER], born.where[:, BORN_SLOT],
        born.value[:, BIRTH_WX:],
    )  # fmt: skip
    at = [Configuration(complex(*m[:2]), complex(*m[2:])) for m in hands.tolist()]
    contacts = [free_space.contacts(here) for here in at]
    touching = free_fingers_of(free_space.outline, np.array(contacts))
    grasps: list[GraspMinimum] = []
    for k, (here, low, (_, level)) in enumerate(zip(at, sigma.tolist(), joined, strict=True)):
        ends = plateau_through(free_space, here, low)
        plateau = _plateau_contacts(free_space, ends)
        grasps.append(GraspMinimum(-1, False, low, contacts[k], plateau, touching[k], level))
    return grasps


def _plateau_contacts(
    free_space: FreeSpace, plateau: tuple[Configuration, Configuration] | None
) -> tuple[FloatArray, FloatArray] | None:
    if plateau is None:
        return None
    return free_space.contacts(plateau[0]), free_space.contacts(plateau[1])


def _intermediate(found: Search, met: list[Joining], ids: dict[int, int]) -> list[Puncture]:
    """Punctures below the escape; simultaneous ones share an entry."""
    punctures: list[Puncture] = []
    for joining in met:
        joins = tuple(sorted(ids[node] for node in joining.minima))
        last = punctures[-1] if punctures else None
        if last is not None and joining.sigma <= last.sigma * (1.0 + 2.0 * LEVEL):
            joins = tuple(sorted((*last.joins, *joins)))
            punctures[-1] = Puncture(
                last.sigma, "intermediate", joins, last.contacts, last.free_fingers
            )
            continue
        contacts = found.free_space.contacts(found.edge_configuration(joining.edge))
        punctures.append(
            Puncture(
                joining.sigma,
                "intermediate",
                joins,
                contacts,
                free_fingers(found.free_space.outline, contacts),
            )
        )
    return punctures


def escape_edge(found: Search) -> int:
    """The pass of the escape puncture: the first one above all those before the pinched hand."""
    path = path_edges(found)
    high = found.edge_value[path, PASS_SIGMA]
    return int(path[np.argmax(high >= below_escape(found))])


def path_edges(found: Search) -> IntArray:
    """Edges from the target's cell to the pinched one, in order."""
    return way_to(found.nodes, found.edges, len(found.nodes) - 1)


def _escape(found: Search) -> Puncture:
    contacts = found.free_space.contacts(found.edge_configuration(escape_edge(found)))
    return Puncture(
        found.level, "escape", (), contacts, free_fingers(found.free_space.outline, contacts)
    )


def escape_path(found: Search, target: Target) -> tuple[FloatArray, float]:
    """Placements (k, 4) from the target to a pinched hand, and the least finger gap before it.

    Between neighbours d and w move in a straight line, so every finger does; both ends lie in one
    cell (convex), so no finger enters the object, and |w| is convex, so it stays below the pass.
    """
    free_space = found.free_space
    points = [target.at, *found.edge_configurations(path_edges(found))]
    # the last piece, or the finger that stands still, takes all three
    still = free_space.contacts(points[-1])[max(found.standing, 0)]
    # a last pass that is a pinched hand already is the end itself
    points = points[: corners_before_pinch([p.w for p in points], free_space.pieces.diameter)]
    d: ComplexArray = np.array([p.d for p in points])
    w: ComplexArray = np.array([p.w for p in points])
    x, y = free_space.origin
    rows = np.column_stack([d.real + x, d.imag + y, np.angle(w), np.abs(w)])
    rows = np.vstack([rows, [*still, rows[-1, 2], 0.0]])
    return rows, free_space.hand.least_gap(w.tolist())
