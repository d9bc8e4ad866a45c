"""Every epsilon of the planner, with its unit and the reason for it.

*Diameter* is the largest distance between two vertices of the outline. Tolerances marked
[diameter] are multiples of it, so that nothing depends on the unit of the drawing.
"""

from __future__ import annotations

from typing import Final

DEPTH_CUT: Final = 1e-10
"""[diameter] A local minimum of sigma counts if it is deeper. [docs/theory.md, Sec. 2.5]"""

DEPTH_FINE: Final = 1e-11
"""[diameter] If sigma_first is another one with minima this shallow, or ..."""

DEPTH_ROUGH: Final = 1e-6
"""[diameter] ... only with minima this deep, the plan warns that it hangs on the depth cut."""

MERGE_VERTEX: Final = 3e-10
"""[diameter] Vertices this close to the chord of their neighbours are dropped: far below every
published figure, far above the rounding of a rotated input, and above SAME_POINT, so that the
pieces next to a configuration are those that hold it."""

CONTACT_OFF: Final = 1e-6
"""[diameter] A target contact may lie this far off the (offset) outline.
[docs/formats.md, Tolerances]"""

TARGET_SHIFT: Final = 1e-5
"""[diameter] The nearest local minimum is the target if the fingers move less ...
[docs/formats.md, Tolerances]"""

TARGET_TURN: Final = 1e-3
"""[rad] ... and the hand turns less. [docs/formats.md, Tolerances]"""

NOT_A_CAGE: Final = 1e-9
"""[1] sigma_max / sigma_0 - 1 below this is not a cage. [docs/formats.md, Tolerances]"""

COLLISION: Final = 1e-9
"""[diameter] A finger deeper than this inside the object collides. [docs/formats.md, Tolerances]"""

PINCHED: Final = 1e-12
"""[diameter] A hand of at most this sigma is a point: above the rounding of a pinched corner."""

LEVEL: Final = 5e-10
"""[1] Two levels of sigma this close (relative) are one: half of what a query may leave open, so
that a grasp queried at its own sigma lies in its own basin. [docs/formats.md, Tolerances]"""

PASS_ERROR: Final = 1e-12
"""[diameter] A pass value that doubles may miss by more than this is computed in double-double;
a hundred times below DEPTH_CUT, so that rounding cannot make or hide a minimum."""

SAME_POINT: Final = 1e-10
"""[diameter] A finger this close to a piece is taken to be in it: above the rounding of a
configuration, far below every feature that survives MERGE_VERTEX in practice."""

FREE_FINGER: Final = 1e-7
"""[diameter] A finger further than this from the outline touches nothing."""

SIGMA_MAX_GAP: Final = 1e-4
"""[1] Disc fingers: arcs are refined until sigma_max is bracketed this well.
[docs/formats.md, Tolerances]"""

SIGMA_FIRST_SPREAD: Final = 1e-3
"""[1] Disc fingers: sigma_first counts as converged if all resolutions agree to this.
[docs/formats.md, Tolerances]"""

REGION_LEVEL: Final = 1e-9
"""[1] Regions are drawn this far (relative) below their level: at it the puncture opens."""

PLATEAU: Final = 1e-6
"""[diameter] A set of minima longer than this is a plateau; shorter ones are rounding."""

SLIDE_GIVE: Final = 1e-13
"""[diameter] How far into a wall a finger may be on a plateau: above the rounding of w, and so
small that edges which are parallel to 1e-6 only do not look like a plateau (at 1e-11 one of 20,000
random targets did)."""

NEAR_POSITION: Final = 0.005
"""[diameter] A jam counts as the target if the middle of the fingers is at most this far off ...
[docs/formats.md, Tolerances]"""

NEAR_TURN: Final = 0.02
"""[rad] ... and the hand is turned by at most this. [docs/formats.md, Tolerances]"""

JAM_THICK: Final = 1e-11
"""[diameter] A finger this close to an edge or a vertex may push there: jams are too many, never
too few; above the rounding of a corner, far below the accuracy of any level that is promised."""

PLACE_GAP: Final = 1e-3
"""[1] The best placement's tolerance is the largest there is, but for this share.
[docs/formats.md, Tolerances]"""
