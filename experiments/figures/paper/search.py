"""The explored caging graph, the escape puncture, the caging regions. [Bunis2018, Fig. 8]"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, PathPatch

from experiments.figures.drawing.palette import FINGERS, INK, ORANGE, PURPLE, QUIET_INK, SKY, tint
from experiments.figures.drawing.shapes import as_path, is_blank, tidied
from experiments.figures.paper.obstacles import draw_obstacles
from experiments.figures.paper.page import (
    bounds_of,
    draw_hand,
    heading,
    level,
    new_sheet,
    object_panel,
    space_name,
    space_panel,
)
from experiments.figures.paper.study import Study
from icage.arrays import FloatArray
from icage.contact_space.basins import escape_edge
from icage.contact_space.kernels.explore import PINCH, SEAM, TUNNEL

EXPLORED = QUIET_INK
_GREY = tint(INK, 0.16)

_LEAST, _PART = 0.12, 0.6
"""[perimeter] Only a square round the explored part is shown if that is smaller than the second;
the square is never smaller than the first."""


def draw(study: Study) -> tuple[Figure, str | None]:
    """(a)-(c) the search in the three contact spaces; (d) the object with the plan's regions."""
    figure = new_sheet(7.2)
    panels = figure.subplots(2, 2)
    spaces = (panels[0, 0], panels[0, 1], panels[1, 0])
    graph = _Graph(study)
    for pair, (axes, letter) in enumerate(zip(spaces, "abc", strict=True)):
        space_panel(axes, study, pair)
        graph.zoom(axes, pair)
        draw_obstacles(axes, study, pair, _GREY)
        graph.draw(axes, pair)
        words = f"part of {space_name(pair)}" if graph.is_part(pair) else space_name(pair)
        heading(axes, letter, f"{words}, explored from the target")
    _on_object(panels[1, 1], study)
    figure.legend(handles=_keys(study), loc="outside lower center", ncols=4)
    log = study.found.log()
    note = (
        f"{log.rectangles_explored} of {log.rectangles_total} rectangles, "
        f"{len(study.found.regions)} convex regions, {log.nodes} nodes, "
        f"{log.tunnel_edges_used} tunnel edges"
    )
    return figure, note


class _Graph:
    """The explored graph in the coordinates of each contact space."""

    def __init__(self, study: Study) -> None:
        self._study, self._found, self._boundary = study, study.found, study.boundary
        self._boxes = [self._box(pair) for pair in range(3)]
        self._sides = [
            max(1.15 * float(np.ptp(box, axis=0).max()), _LEAST * study.boundary.perimeter)
            for box in self._boxes
        ]

    def is_part(self, pair: int) -> bool:
        """Whether only a part of the contact space is shown."""
        return self._sides[pair] < _PART * self._boundary.perimeter

    def at(self, region: int, s: FloatArray) -> FloatArray:
        """Place (2,) of local s, u of a region."""
        _, j, k = (int(v) for v in self._found.regions[region, :3])
        return self._boundary.s_0[[j, k]] + s

    def hand_at(self, region: int, hand: FloatArray) -> FloatArray:
        """Place (2,) of a hand (4,) in a region."""
        i, j, k = (int(v) for v in self._found.regions[region, :3])
        fingers = self._study.plane.contacts(hand)[[i, (i + 1) % 3]]
        edges = [j, k]
        off = (fingers - self._boundary.start[edges]) * self._boundary.tangent[edges]
        return self._boundary.s_0[edges] + off.sum(axis=1)

    def pair(self, region: int) -> int:
        return int(self._found.regions[region, 0])

    def _box(self, pair: int) -> FloatArray:
        """Corners (2, 2) of what was explored of a contact space."""
        found = self._found
        rows = [
            self.at(r, found.nodes[r, 1:3])
            for r in range(len(found.regions))
            if self.pair(r) == pair
        ]
        rows += [
            self.at(int(found.entries[p, 0]), found.places[p])
            for p in found.left.tolist()
            if found.entries[p, 1] >= 0 and self.pair(int(found.entries[p, 0])) == pair
        ]
        rows += list(self._study.places(self._study.target, pair))
        places = np.array(rows).reshape(-1, 2)
        return np.array([places.min(axis=0), places.max(axis=0)]) if rows else np.zeros((2, 2))

    def zoom(self, axes: Axes, pair: int) -> None:
        """Show only a square round what was explored, if that is a small part of the space."""
        if not self.is_part(pair):
            return
        side, total = self._sides[pair], self._boundary.perimeter
        low = np.clip(self._boxes[pair].mean(axis=0) - 0.5 * side, 0.0, total - side)
        axes.set_xlim(low[0], low[0] + side)
        axes.set_ylim(low[1], low[1] + side)

    def draw(self, axes: Axes, pair: int) -> None:
        """Everything of one contact space."""
        found = self._found
        stars: list[list[FloatArray]] = []
        tunnels: list[list[FloatArray]] = []
        for e, (origin, to, _, kind) in enumerate(found.edges.tolist()):
            if kind == SEAM:
                for region in (origin, to):
                    if self.pair(region) == pair:
                        centre = self.at(region, found.nodes[region, 1:3])
                        stars.append([centre, self.hand_at(region, found.hands[e, 1:5])])
            elif kind == TUNNEL:
                ends = [(origin, found.hands[e, 1:5]), (to, found.hands[e, 5:9])]
                tunnels.append([self.hand_at(r, h) for r, h in ends if self.pair(r) == pair])
            elif kind == PINCH and self.pair(origin) == pair:
                tunnels.append([self.hand_at(origin, found.hands[e, 1:5])])
        axes.add_collection(LineCollection(stars, colors=[EXPLORED], linewidths=0.5, zorder=5))
        self._open(axes, pair)
        axes.add_collection(
            LineCollection(
                self._way(pair), colors=[PURPLE], linewidths=1.5, zorder=7, capstyle="round"
            )
        )
        for ends in tunnels:
            rows = np.array(ends).reshape(-1, 2)
            axes.plot(*rows.T, "D-", color=ORANGE, ms=4.0, mec="white", mew=0.5, lw=1.2, zorder=8)
        self._marks(axes, pair)

    def _open(self, axes: Axes, pair: int) -> None:
        found = self._found
        rows = [p for p in found.left.tolist() if found.entries[p, 1] >= 0]
        places = [
            self.at(int(found.entries[p, 0]), found.places[p])
            for p in rows
            if self.pair(int(found.entries[p, 0])) == pair
        ]
        axes.plot(*np.array(places).reshape(-1, 2).T, ".", ms=2.6, color=SKY, zorder=6, ls="")

    def _way(self, pair: int) -> list[list[FloatArray]]:
        """The way out region by region: from where it is entered to where it is left."""
        found = self._found
        segments: list[list[FloatArray]] = []
        region, hand = 0, self._study.local_cage.target.hand
        for e in found.way_out():
            origin, to, _, kind = (int(v) for v in found.edges[e])
            if self.pair(origin) == pair:
                segments.append(
                    [self.hand_at(origin, hand), self.hand_at(origin, found.hands[e, 1:5])]
                )
            region, hand = to, found.hands[e, 5:9] if kind == TUNNEL else found.hands[e, 1:5]
        if found.escaped and region >= 0 and self.pair(region) == pair:
            end = self.at(region, found.nodes[region, 1:3])
            segments.append([self.hand_at(region, hand), end])
        return segments

    def _marks(self, axes: Axes, pair: int) -> None:
        study, found = self._study, self._found
        for point in study.places(study.target, pair):
            axes.plot(*point, "o", ms=6.0, mfc=INK, mec="white", mew=0.9, zorder=10, clip_on=False)
        if found.escaped:
            at = study.plane.contacts(found.hands[escape_edge(found), 1:5])
            for point in study.places(at, pair):
                axes.plot(
                    *point, "s", ms=7.0, mfc="none", mec=INK, mew=1.5, zorder=11, clip_on=False
                )
            end = found.edges[-1]
            if end[3] != PINCH and self.pair(len(found.regions) - 1) == pair:
                last = len(found.regions) - 1
                at = self.at(last, found.nodes[last, 1:3])
                axes.plot(
                    *at, "*", ms=8.0, mfc=PURPLE, mec="white", mew=0.6, zorder=11, clip_on=False
                )


def _keys(study: Study) -> list[Line2D | Patch]:
    def mark(marker: str, label: str, **style: Any) -> Line2D:
        return Line2D([], [], ls="", marker=marker, label=label, **style)

    keys: list[Line2D | Patch] = [
        mark("o", "target grasp", ms=5.0, color=INK),
        Line2D([], [], color=EXPLORED, lw=0.8, label="explored graph"),
        mark(".", "open list", ms=6.0, color=SKY),
        Line2D([], [], color=PURPLE, lw=1.5, label="way out (closed list)"),
        mark("D", "tunnel edge", ms=4.0, color=ORANGE),
        mark("s", "escape puncture", ms=6.0, mfc="none", color=INK, mew=1.4),
        mark("*", "pinched", ms=8.0, color=PURPLE),
        Patch(fc=_GREY, label="obstacle"),
    ]
    has_tunnel = bool((study.found.edges[:, 3] != SEAM).any())
    return [k for k in keys if has_tunnel or k.get_label() != "tunnel edge"]


def _on_object(axes: Axes, study: Study) -> None:
    """The plan's caging regions from inside, target and escape puncture."""
    cage, polygon = study.answer, study.finest
    escape = next((p for p in cage.punctures if p.kind == "escape"), None)
    hands = [cage.contacts] + ([] if escape is None else [escape.contacts])
    shapes = [r.geometry for r in study.regions if not r.geometry.is_empty]
    window = bounds_of(polygon.polygon, *hands, *shapes)
    object_panel(axes, study, window, polygon=polygon)
    for region in study.regions:
        colour = FINGERS[region.finger - 1]
        path = as_path(tidied(region.geometry, 1e-3 * study.polygon.diameter))
        if not is_blank(path):
            axes.add_patch(PathPatch(path, fc=tint(colour, 0.35), ec=colour, lw=0.5, zorder=1))
    draw_hand(axes, cage.contacts)
    if escape is not None:
        free = [k - 1 for k in escape.free_fingers]
        draw_hand(axes, escape.contacts, solid=False, numbers=False, free=free, width=1.0)
        value = rf"$\sigma_{{\mathrm{{max}}}}$ = {level(study, escape.sigma)}"
        heading(axes, "d", f"caging regions; dashed: puncture\n{value}")
    else:
        heading(axes, "d", "no escape; where the fingers can go")
