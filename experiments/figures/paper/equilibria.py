"""The kinds of equilibrium grasps that the object has. [Bunis2018, Fig. 5]"""

from __future__ import annotations

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from experiments.figures.drawing.palette import BAD, QUIET_INK
from experiments.figures.drawing.shapes import as_pair
from experiments.figures.paper.page import (
    bounds_of,
    draw_hand,
    heading,
    new_sheet,
    object_panel,
)
from experiments.figures.paper.study import Study
from icage.arrays import FloatArray
from icage.contact_space.boundary import Boundary
from icage.contact_space.equilibria import pair_grasps, three_finger_kind
from icage.contact_space.sectors import concurrency_point, sector_at
from icage.contact_space.third_finger import turn
from icage.geometry.statics import free_fingers
from icage.grasps.features import EDGE, balanced_triples, features_of
from icage.grasps.kernels.hands import HandLimits

Shown = tuple[str, FloatArray, tuple[int, ...]]
"""Words, contacts (3, 2) on the polygon of the search, free fingers (0..2)."""


def draw(study: Study) -> tuple[Figure, str | None]:
    """A panel for every kind that exists, with the lines of force."""
    grasps = [*_of_two_fingers(study), *_of_three_fingers(study)]
    shown = [*grasps, *_punctures(study)]
    figure = new_sheet(2.45 * (1 + (len(shown) - 1) // 3))
    rows = 1 + (len(shown) - 1) // 3
    panels = figure.subplots(rows, 3, squeeze=False).ravel()
    for axes in panels[len(shown) :]:
        axes.set_axis_off()
    window = bounds_of(study.polygon.polygon, *(contacts for _, contacts, _ in shown))
    finest = Boundary.of(study.finest)
    for number, (axes, letter, (words, contacts, free)) in enumerate(
        zip(panels, "abcdefghi", shown, strict=False)
    ):
        planned = number >= len(grasps)  # on the plan's polygon, not on that of the search
        polygon, boundary = (study.finest, finest) if planned else (study.polygon, study.boundary)
        object_panel(axes, study, window, margin=0.15, polygon=polygon)
        heading(axes, letter, words)
        ways = _forces(axes, study, boundary, contacts, free)
        draw_hand(axes, contacts, free=free, size=4.5, beside=ways)
    kinds = ", ".join(words for words, _, _ in shown)
    return figure, f"found: {kinds}".replace(r"$\sigma_{\mathrm{max}}$", "sigma_max")


def _forces(
    axes: Axes, study: Study, boundary: Boundary, contacts: FloatArray, free: tuple[int, ...]
) -> dict[int, FloatArray]:
    """Arrows of the contact forces, with three also dashed lines to where they meet.

    Returns the direction of the force of each finger that has one.
    """
    touching = [k for k in range(3) if k not in free]
    ways: dict[int, FloatArray] = {}
    if len(touching) == 2:
        a, b = touching
        ways = {a: contacts[b] - contacts[a], b: contacts[a] - contacts[b]}
    else:
        size = 4.0 * study.polygon.diameter
        held = [s for s in (sector_at(boundary, p, size) for p in contacts) if s is not None]
        point = concurrency_point(held) if len(held) == 3 else None
        if point is None:
            return ways
        for k, (sector, contact) in enumerate(zip(held, contacts, strict=True)):
            line = np.array([contact, point])
            style = (0, (3, 2))
            axes.plot(
                *line.T, color=QUIET_INK, lw=0.7, ls=style, zorder=5, scalex=False, scaley=False
            )
            way = point - contact
            ways[k] = way if way @ sector.normals.sum(axis=0) > 0.0 else -way
    for k, way in ways.items():
        _arrow(axes, study, contacts[k], way)
    return ways


def _arrow(axes: Axes, study: Study, contact: FloatArray, way: FloatArray) -> None:
    """A force at a contact: an arrow that ends there."""
    tail = contact - 0.13 * study.polygon.diameter * way / max(float(np.hypot(*way)), 1e-300)
    axes.annotate(
        "", as_pair(contact), as_pair(tail), zorder=6, annotation_clip=False,
        arrowprops={"arrowstyle": "-|>", "color": BAD, "lw": 1.0, "shrinkB": 3.0, "shrinkA": 0.0},
    )  # fmt: skip


def _of_two_fingers(study: Study) -> list[Shown]:
    """One grasp of each kind, best with room for the third finger. [Bunis2018, Lemma 4.3]"""
    best: dict[str, tuple[float, FloatArray]] = {}
    for grasp in pair_grasps(study.boundary):
        for pair in range(3):
            for order in (grasp.contacts, grasp.contacts[::-1]):
                contacts = np.empty((3, 2))
                contacts[pair], contacts[(pair + 1) % 3] = order
                contacts[(pair + 2) % 3] = order[0] + turn(study.hand, pair) @ (order[1] - order[0])
                score = _room(study, contacts, contacts[(pair + 2) % 3])
                for kind, (_, other) in best.items():
                    if kind != grasp.kind and _alike(study, contacts, other):
                        score *= 0.2
                if grasp.kind not in best or score > best[grasp.kind][0]:
                    best[grasp.kind] = score, contacts
    return [
        (kind, contacts, tuple(k - 1 for k in free_fingers(study.polygon, contacts)))
        for kind, (score, contacts) in best.items()
        if score > 0.0
    ]


def _room(study: Study, contacts: FloatArray, third: FloatArray) -> float:
    """How well a two-finger grasp shows: a large hand near the object; below 0: infeasible."""
    if shapely.contains_xy(study.polygon.polygon, *third):
        return -1.0
    size = study.polygon.diameter
    far = float(shapely.distance(shapely.Point(third), study.polygon.polygon)) / size
    sides = np.hypot(*(contacts - np.roll(contacts, 1, axis=0)).T) / size
    low_x, low_y, high_x, high_y = study.polygon.polygon.bounds
    x_0, y_0, x_1, y_1 = bounds_of(study.polygon.polygon, contacts)
    grown = np.hypot(x_1 - x_0, y_1 - y_0) / np.hypot(high_x - low_x, high_y - low_y) - 1.0
    return min(1.0, float(sides.min()) / 0.25) * min(1.0, far / 0.05) / (1.0 + 6.0 * float(grown))


def _alike(study: Study, one: FloatArray, other: FloatArray) -> bool:
    """Whether two hands can hardly be told apart, whatever the fingers' numbers."""
    gaps = np.hypot(*(one[:, None] - other[None]).transpose(2, 0, 1))
    return bool((gaps.min(axis=1) < 0.15 * study.polygon.diameter).all())


def _of_three_fingers(study: Study) -> list[Shown]:
    """Immobilizing grasps at three edges, and at one concave vertex and two edges."""
    shown: list[Shown] = []
    for kind, words in (("three edges", "three edges"), ("one vertex", "vertex, two edges")):
        mine = [
            g
            for g in [study.target, *study.grasps]
            if three_finger_kind(study.boundary, g, study.near) == kind
        ]
        if mine:
            # the target if it is of this kind, else the largest hand
            best = mine[0] if mine[0] is study.target else max(mine, key=_shortest_side)
            shown.append((words, best, ()))
            continue
        other = _of_another_hand(study, 3 if kind == "three edges" else 2)
        if other is not None:
            shown.append((f"{words} (other hand)", other, ()))
    own = three_finger_kind(study.boundary, study.target, study.near)
    if own in ("two vertices", "three vertices"):
        words = {"two vertices": "two vertices, an edge"}.get(own, own)
        shown.append((f"{words} (target)", study.target, ()))
    return shown


def _shortest_side(contacts: FloatArray) -> float:
    return float(np.hypot(*(contacts - np.roll(contacts, 1, axis=0)).T).min())


def _of_another_hand(study: Study, edges: int) -> FloatArray | None:
    """The grasp with so many edges whose contacts are best away from vertices and each other."""
    longest = 0.02 * study.polygon.diameter
    features = features_of(study.polygon, longer_than=longest)
    triples, points = balanced_triples(features, study.polygon, HandLimits.apart(longest))
    best, found = 0.0, None
    for triple, p in zip(triples, points, strict=True):
        if int((features.kind[triple] == EDGE).sum()) != edges:
            continue
        contacts = features.contacts(triple, p)
        sides = np.hypot(*(contacts - np.roll(contacts, 1, axis=0)).T)
        a, b = contacts[1] - contacts[0], contacts[2] - contacts[0]
        height = abs(a[0] * b[1] - a[1] * b[0]) / sides.max()
        if min(float(height), float(sides.min())) > best:
            best = min(float(height), float(sides.min()))
            found = contacts if a[0] * b[1] > a[1] * b[0] else contacts[::-1]
    return found


def _punctures(study: Study) -> list[Shown]:
    """The last intermediate puncture and the escape, both of the plan."""
    shown: list[Shown] = []
    cage = study.answer
    for kind in ("intermediate", "escape"):
        of_kind = [p for p in cage.punctures if p.kind == kind]
        if of_kind:
            p = of_kind[-1]
            count = 3 - len(p.free_fingers)
            words = {"escape": "escape puncture", "intermediate": "intermediate puncture"}[kind]
            free = tuple(k - 1 for k in p.free_fingers)
            shown.append((f"{words}, {count} fingers", p.contacts, free))
    return shown
