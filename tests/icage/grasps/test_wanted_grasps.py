"""Grasps of the kind that was asked for, or a clear word that there are none."""

from __future__ import annotations

import numpy as np
import pytest

from icage.errors import GraspError
from icage.grasps.search import best_grasps
from icage.grasps.wanted import ANY_HAND, Wanted
from icage.hand import HandShape
from icage.outline import Outline
from tests.icage.grasps.small_outlines import SMALL, found
from tests.oracles.geometry import Ring


@pytest.mark.parametrize("name", ["notched", "hour glass"])
def test_wanted_corners(name: str) -> None:
    outline, ring = Outline(SMALL[name]), Ring.of(SMALL[name])
    wanted = Wanted("first", corners=1, limits=ANY_HAND)
    corners = ring.vertices[ring.concave]
    grasps = best_grasps(outline, top=4, wanted=wanted, rng=np.random.default_rng(0))
    for grasp in grasps:
        gaps = np.linalg.norm(grasp.contacts[:, None] - corners[None], axis=2)
        assert (gaps.min(axis=1) <= 1e-12 * ring.diameter).sum() >= 1


@pytest.mark.parametrize("name", ["triangle", "notched"])
def test_wanted_shape(name: str) -> None:
    """Read from any finger, within the angle that was asked."""
    first = found(name, "first")[0]
    phi = HandShape.from_contacts(first.contacts).phi
    near = (phi[0] + 0.01, phi[1] - 0.01, 0.03)
    for grasp in best_grasps(
        Outline(SMALL[name]), wanted=Wanted("first", near=near), rng=np.random.default_rng(0)
    ):
        hand = HandShape.from_contacts(grasp.contacts)
        errors = [
            max(abs(a - b) for a, b in zip(hand.relabelled(k).phi, near[:2], strict=True))
            for k in range(len(hand.z))
        ]
        assert min(errors) <= near[2] + 1e-12


def test_an_outline_without_such_a_grasp() -> None:
    with pytest.raises(GraspError, match="no immobilizing three-finger grasp was found"):
        best_grasps(
            Outline(SMALL["triangle"]), wanted=Wanted(corners=1), rng=np.random.default_rng(0)
        )
