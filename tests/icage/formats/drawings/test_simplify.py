from __future__ import annotations

import numpy as np
import shapely
from hypothesis import given
from hypothesis import strategies as st

from icage.formats.drawings.simplify import simplified


def blob(seed: int, n: int) -> np.ndarray:
    """A star-shaped ring with bumps."""
    rng = np.random.default_rng(seed)
    u = np.sort(rng.uniform(0, 2 * np.pi, n))
    r = 1 + 0.3 * np.sin(5 * u) + 0.05 * rng.uniform(-1, 1, n)
    return np.column_stack([r * np.cos(u), r * np.sin(u)])


@given(st.integers(0, 10_000), st.integers(8, 200), st.sampled_from([0.3, 0.1, 0.03, 0.001]))
def test_the_distance_holds_both_ways_and_the_box_is_kept(seed: int, n: int, within: float):
    ring = blob(seed, n)
    if not shapely.Polygon(ring).is_valid:
        return
    fewer = simplified(ring, within)
    before, after = shapely.LinearRing(ring), shapely.LinearRing(fewer)
    assert shapely.Polygon(fewer).is_valid
    assert shapely.hausdorff_distance(before, after, densify=0.01) <= within * (1 + 1e-9)
    assert before.bounds == after.bounds
    assert len(fewer) <= len(ring)


def test_collinear_points_go():
    ring = np.array([[0.0, 0], [1, 0], [2, 0], [2, 2], [1, 2], [0, 2], [0, 1]])
    assert len(simplified(ring, 1e-9)) == 4


def test_a_ring_that_would_cross_itself_is_simplified_less():
    # A hairpin: the spike from below ends just under the notch from above.
    below = [[0.0, 0], [4.9, 0], [5, 0.99], [5.1, 0], [10, 0]]
    above = [[10.0, 2], [5.1, 2], [5, 1], [4.9, 2], [0, 2]]
    fewer = simplified(np.array(below + above), 1.5)
    assert shapely.Polygon(fewer).is_valid
