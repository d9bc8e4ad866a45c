"""What disc fingers touch, drawn at random for the tests of friction's kernels."""

from __future__ import annotations

import numpy as np

from icage.friction.disc_contacts import DiscContacts
from icage.friction.kernels.disc_features import ARC, CORNER, EDGE

RADIUS = 0.3


def contacts(rng: np.random.Generator) -> DiscContacts:
    """An edge, a corner and two arcs, and apexes of three vertices."""
    none = np.empty(0, np.int64)
    place = rng.normal(size=(4, 4))
    place[1:, 2:] = 0.0
    angle = rng.uniform(-np.pi, np.pi, (4, 2))
    angle[2:, 1] = 0.12, 0.05
    return DiscContacts(
        ptr=none, which=none, kind=np.array([EDGE, CORNER, ARC, ARC]), place=place, angle=angle,
        apex=rng.normal(size=(3, 2)), radius=RADIUS,
    )  # fmt: skip
