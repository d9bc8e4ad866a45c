"""Can the object leave a hand that is rigid at c? A random tree over its poses, planner-free.

A rapidly exploring random tree over the object's x, y and turn in the palm's frame. A pose is clear
if no disc reaches into the true outline by more than ``CLEAR``. A step is a quarter of the finger's
radius and looked at in ``LOOKS`` places: between two looks, h apart, a finger can cut a corner by
h^2 / 8 r, that is r / 4600 (4e-6 diameters for fingers of 2 %). With one look a step it was 36
times that, and a cross let go 0.06 % below sigma_max. What the tree finds is a way out; what it
does not find proves nothing. The threshold of a rigid hand may lie above sigma_max, which allows
closing, never below.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from icage.arrays import FloatArray
from sim.attack.held import ESCAPED, HELD, Attacks
from sim.world.hand_in_object import depths, hull_of, separated, turn_back
from sim.world.machine_loops import counting
from sim.world.scene import Scene

CLEAR = 1e-5
"""[diameter] A finger this deep still counts as clear: poses of the simulator touch."""

_NO_WAY = 1e-9
"""[diameter] A way shorter than this leads nowhere."""

LOOKS = 6
"""Poses of every step that must be clear."""

TURN_LENGTH = 0.5
"""[diameter / rad] A turn by one radian counts as a way of this length."""


@dataclass(frozen=True, slots=True)
class TreePull:
    """Bounds of a search."""

    samples: int = 20_000
    """Poses drawn; a way of many steps may be added for each."""

    nodes: int = 12_000
    """Poses kept."""

    hops: int = 40
    """Steps towards one sample."""


@dataclass(frozen=True, slots=True)
class TreeSearch:
    """Whether a way out was found, and how many poses the tree had then."""

    escaped: bool
    nodes: int


def clear_poses(scene: Scene, qpos: FloatArray, opening: float) -> FloatArray:
    """Object poses (m, 3) of qpos (N, 6) that are clear of a hand rigid at ``opening``."""
    args = _shape(scene, opening)
    test: Callable[..., float] = _deepest
    poses = [row for row in qpos[:, 3:6] if test(*args, row[0], row[1], row[2]) <= CLEAR]
    return np.array(poses).reshape(-1, 3)


def search_tree(
    scene: Scene,
    starts: FloatArray,
    opening: float,
    rng: np.random.Generator,
    pull: TreePull | None = None,
) -> TreeSearch:
    """Grow a tree from clear poses (m, 3) until one is separated from the hand, or the bound."""
    bound = pull or TreePull()
    shape = _shape(scene, opening)
    vertices, fingers, radius = shape
    reach = float(np.hypot(*fingers.T).max() + np.hypot(*vertices.T).max() + 2.0 * radius)
    samples = rng.uniform(-1.0, 1.0, (bound.samples, 3)) * [reach, reach, math.pi]
    noise = rng.normal(0.0, 0.5, (4096, 3))
    grow: Callable[..., tuple[bool, int]] = _grow
    found = grow(
        shape, hull_of(vertices), starts, samples, noise, 0.25 * radius, bound.nodes, bound.hops,
    )  # fmt: skip
    return TreeSearch(*found)


def search_many(
    scene: Scene, inside: FloatArray, openings: FloatArray, rng: np.random.Generator
) -> Attacks:
    """A search per opening (N,) [diameter] from qpos (m, 6) inside the cage; steps = poses kept."""
    found: list[TreeSearch] = []
    for opening, own in zip(openings.tolist(), rng.spawn(len(openings)), strict=True):
        starts = clear_poses(scene, inside, opening)
        found.append(search_tree(scene, starts, opening, own))
    return Attacks(
        openings=np.array(openings),
        ending=np.array([ESCAPED if one.escaped else HELD for one in found], dtype=np.int64),
        steps=np.array([one.nodes for one in found], dtype=np.int64),
        penetration_max=np.full(len(found), CLEAR),
        rise_max=np.ones(len(found)),
        end=np.zeros((len(found), 6)),
    )


def _shape(scene: Scene, opening: float) -> tuple[FloatArray, FloatArray, float]:
    """Outline, fingers (3, 2) in P and radius, all in diameters."""
    kinematics = scene.kinematics
    fingers = kinematics.directions * (opening * kinematics.lengths)[:, None]
    return scene.object.vertices, fingers, scene.finger_radius / scene.object.diameter


@counting
def _seen(
    fingers: FloatArray, x: float, y: float, turn: float
) -> FloatArray:  # pragma: no cover - compiled
    """Fingers (3, 2) in the object's axes."""
    out = fingers.copy()
    turn_back(out, x, y, turn)
    return out


@counting
def _deepest(
    vertices: FloatArray, fingers: FloatArray, radius: float, x: float, y: float, turn: float
) -> float:  # pragma: no cover - compiled
    depth = np.empty(3)
    depths(vertices, _seen(fingers, x, y, turn), radius, depth)
    return max(depth[0], depth[1], depth[2])


@counting
def _free(
    vertices: FloatArray,
    fingers: FloatArray,
    radius: float,
    x: float,
    y: float,
    turn: float,
    dx: float,
    dy: float,
    dturn: float,
) -> bool:  # pragma: no cover - compiled
    """Whether a step is clear, its end first."""
    for k in range(LOOKS, 0, -1):
        share = k / LOOKS
        at_x, at_y, at_turn = x + share * dx, y + share * dy, turn + share * dturn
        if _deepest(vertices, fingers, radius, at_x, at_y, at_turn) > CLEAR:
            return False
    return True


@counting
def _cut(
    x: float, y: float, turn: float, step: float
) -> tuple[float, float, float]:  # pragma: no cover - compiled
    """A way no longer than the step."""
    length = math.sqrt(x * x + y * y + TURN_LENGTH * TURN_LENGTH * turn * turn)
    if length < _NO_WAY:
        return 0.0, 0.0, 0.0
    share = min(1.0, step / length)
    return share * x, share * y, share * turn


@counting
def _grow(
    shape: tuple[FloatArray, FloatArray, float],
    hull: FloatArray,
    starts: FloatArray,
    samples: FloatArray,
    noise: FloatArray,
    step: float,
    most: int,
    hops: int,
) -> tuple[bool, int]:  # pragma: no cover - compiled
    vertices, fingers, radius = shape
    tree = np.empty((most, 3))
    count = min(len(starts), most)
    tree[:count] = starts[:count]
    drawn = 0
    for n in range(len(samples)):
        if count == 0 or count >= most:
            break
        goal_x, goal_y, goal_turn = samples[n, 0], samples[n, 1], samples[n, 2] + tree[0, 2]
        best, least = 0, math.inf
        for j in range(count):
            a, b = tree[j, 0] - goal_x, tree[j, 1] - goal_y
            c = TURN_LENGTH * (tree[j, 2] - goal_turn)
            away = a * a + b * b + c * c
            if away < least:
                best, least = j, away
        x, y, turn = tree[best, 0], tree[best, 1], tree[best, 2]
        moved = False
        for hop in range(hops):
            ahead_x, ahead_y, ahead_turn = _cut(goal_x - x, goal_y - y, goal_turn - turn, step)
            if ahead_x == 0.0 and ahead_y == 0.0 and ahead_turn == 0.0:
                break
            done = False
            for trial in range(6):  # straight on, then a little beside: along the walls
                dx, dy, dturn = ahead_x, ahead_y, ahead_turn
                if trial > 0:
                    k = drawn % len(noise)
                    drawn += 1
                    dx, dy, dturn = _cut(
                        dx + step * noise[k, 0],
                        dy + step * noise[k, 1],
                        dturn + step * noise[k, 2] / TURN_LENGTH,
                        step,
                    )
                if _free(vertices, fingers, radius, x, y, turn, dx, dy, dturn):
                    x, y, turn = x + dx, y + dy, turn + dturn
                    done = True
                    break
            if not done:
                break
            moved = True
            if hop % 4 == 3 and count < most:
                tree[count, 0], tree[count, 1], tree[count, 2] = x, y, turn
                count += 1
        if moved:
            if count < most:
                tree[count, 0], tree[count, 1], tree[count, 2] = x, y, turn
                count += 1
            if separated(hull, _seen(fingers, x, y, turn), radius):
                return True, count
    return False, count
