"""Are the peers right? Their answers where closed forms or brute force know better.

Run by ``python -m benchmarks.peers --check``; a benchmark is no part of the tests, but a peer that
is wrong makes a wrong comparison.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy import ndimage

from benchmarks.peers import alpha_shapes, grid_flood
from benchmarks.peers.question import Question
from icage.case import Case
from icage.outline import Outline

SEED = 3
PROVEN = 0.75
"""[level] This much is proven by many samples, and not by few."""


def regular(n: int, radius: float) -> tuple[Case, float]:
    """The regular n-gon of circumradius 1 and an equilateral hand on edges 120 degrees apart.

    sigma_max = width + 2 radius; 3 divides n.
    """
    angle = 2.0 * np.pi * np.arange(n) / n
    vertices = np.column_stack([np.cos(angle), np.sin(angle)])
    middle = np.pi / n + 2.0 * np.pi * np.array([0.0, 1.0, 2.0]) / 3.0
    reach = np.cos(np.pi / n) + radius
    contacts = reach * np.column_stack([np.cos(middle), np.sin(middle)])
    width = 1.0 + np.cos(np.pi / n) if n % 2 else 2.0 * np.cos(np.pi / n)
    return Case(f"{n}-gon", "m", Outline(vertices), radius, contacts), width + 2.0 * radius


def failed_checks() -> list[str]:
    """One line for each that failed."""
    checks = (*_voids(), *_random_voids(), *_polygons())
    for name, fine in checks:
        print(f"{'ok' if fine else 'WRONG':<6} {name}", flush=True)
    return [f"wrong: {name}" for name, fine in checks if not fine]


def _voids() -> Iterator[tuple[str, bool]]:
    """A shell of balls holds its middle; with a hole it does not, nor a point outside."""
    rng = np.random.default_rng(SEED)
    shell = rng.normal(size=(2000, 3))
    shell /= np.linalg.norm(shell, axis=1)[:, None]
    radii = rng.uniform(0.25, 0.35, len(shell))
    yield "a closed shell", alpha_shapes.in_void(shell, radii, np.zeros(3))
    yield "outside a shell", not alpha_shapes.in_void(shell, radii, np.array([3.0, 0.0, 0.0]))
    keep = shell[:, 2] < 0.7  # the hole's rim is 0.71 from its axis: wider than two balls
    yield "a shell with a hole", not alpha_shapes.in_void(shell[keep], radii[keep], np.zeros(3))
    yield "thin balls", not alpha_shapes.in_void(shell, 0.1 * radii, np.zeros(3))


def _random_voids() -> Iterator[tuple[str, bool]]:
    """Balls at random against a flood of a grid; a grid misses passages, so a finer one decides."""
    rng = np.random.default_rng(SEED)
    right, held, count = 0, 0, 40
    for _ in range(count):
        centres = rng.uniform(-1.0, 1.0, (int(rng.integers(200, 700)), 3))
        radii = rng.uniform(0.15, 0.34, len(centres))
        away = np.linalg.norm(centres, axis=1) > radii + 0.02  # the start is free
        centres, radii = centres[away], radii[away]
        answer = alpha_shapes.in_void(centres, radii, np.zeros(3))
        right += any(answer == _flooded(centres, radii, steps) for steps in (50, 140))
        held += answer
    yield f"random balls, {right} of {count}, {held} held", right == count and 5 < held < count - 5


def _flooded(centres: np.ndarray, radii: np.ndarray, steps: int) -> bool:
    axis = np.linspace(-1.4, 1.4, 2 * steps + 1)
    free = np.ones((len(axis),) * 3, dtype=bool)
    for centre, radius in zip(centres, radii, strict=True):
        near = [np.flatnonzero(np.abs(axis - c) <= radius) for c in centre]
        block = tuple(slice(found[0], found[-1] + 1) for found in near)
        x, y, z = ((axis[part] - c) ** 2 for part, c in zip(block, centre, strict=True))
        free[block] &= x[:, None, None] + y[:, None] + z > radius**2
    found, _ = ndimage.label(free)
    return bool(found[steps, steps, steps] != found[0, 0, 0])


def _polygons() -> Iterator[tuple[str, bool]]:
    """Both peers come nearer to the closed form; what the alpha shapes prove is never above it.

    The triangle's rigid cage opens at its sigma_max, too: there the hand's fingers are one width
    of the triangle apart, and for less no vertex gets out between two of them.
    """
    for n, radius in ((3, 0.0), (3, 0.1), (6, 0.05)):
        case, level = regular(n, radius)
        question = Question.of(case)
        errors = []
        for steps in (20, 40):
            found = grid_flood.flood(question, 1.0 / steps)
            error = np.inf if found is None else abs(found.sigma_max / level - 1.0)
            errors.append(error * steps)
        yield f"{case.name} flood, error / step {errors[0]:.2f} {errors[1]:.2f}", max(errors) < 4.0
    case, level = regular(3, 0.0)
    question = Question.of(case)
    few = alpha_shapes.sigma_max(question, 3000, SEED).proven / level
    yield f"triangle, 3000 samples prove {few:.3f} of the level", 0.5 < few < PROVEN
    more = alpha_shapes.caged(question, PROVEN * level, 30_000, SEED)
    yield f"triangle, 30,000 prove {PROVEN} of it", more
    above = alpha_shapes.caged(question, 1.02 * level, 30_000, SEED)
    yield "triangle, nothing is proven above the level", not above
