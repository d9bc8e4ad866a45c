"""The paper's figures, drawn from any case: one module a figure, ``draw(study)`` in each."""

from __future__ import annotations

from typing import Final

FIGURES: Final[dict[str, str]] = {
    "grasps": "all immobilizing grasps of the hand (Fig. 2)",
    "contact_space": "U_12 with the contours of sigma (Fig. 3)",
    "obstacles": "a third-finger parallelogram and all contact space obstacles (Fig. 4)",
    "equilibria": "the kinds of equilibrium grasps (Fig. 5)",
    "parallelogram": "convex regions of a rectangle and the nodes of the caging graph (Fig. 6)",
    "tunnel": "a tunnel edge in the plane (Fig. 7)",
    "search": "the explored caging graph, the escape puncture, the caging regions (Fig. 8)",
    "sigma": "sigma along the way out and over the iterations (Sec. VI)",
    "sectors": "the sectors of the target's contacts (Sec. VII-A)",
}
"""Name of each figure (and of its module) and what it shows."""
