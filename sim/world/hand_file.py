"""Write the hand as MJCF: ``python -m sim.world.hand_file`` renews ``models/hand/hand.xml``.

The simulation never reads the file; it builds the hand of each case anew
(``sim.world.hand_model``).
"""

from __future__ import annotations

from pathlib import Path
from typing import Final

import models
from icage.hand import HandShape
from sim.world.config import SimConfig
from sim.world.hand_model import HandKinematics, build_hand

SHOWN_PHI_DEG: Final = (33.0, 130.0)
"""The hand of the paper's pliers. [Bunis2018, Sec. VII-B]"""

SHOWN_RADIUS: Final = 0.03
"""[diameter] Finger radius of the file: 6 mm on a tool of 200 mm."""

SHOWN_SIGMA: Final = 0.3
"""[diameter] Size of the hand in the keyframe ``open``; at rest all fingers are at the centre."""


def hand_mjcf() -> str:
    """The compiled hand as MJCF text."""
    shape = HandShape.from_angles_deg(*SHOWN_PHI_DEG)
    spec = build_hand(shape, SHOWN_RADIUS, SimConfig())
    spec.add_key(name="open", qpos=(SHOWN_SIGMA * HandKinematics(shape).lengths).tolist())
    spec.compile()
    return str(spec.to_xml())


def hand_file() -> Path:
    """Where the MJCF ships."""
    return models.HAND / "hand.xml"


if __name__ == "__main__":
    hand_file().write_text(hand_mjcf(), encoding="utf-8")
