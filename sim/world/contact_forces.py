"""Contact forces at a state: who presses, and how hard."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from icage.arrays import FloatArray
from sim.world.engine import MjData, MjModel, mj


@dataclass(frozen=True, slots=True)
class Contact:
    """One contact, in W.

    Attributes
    ----------
    finger:
        0..2.
    point, normal, force:
        (2,) where it is, the unit normal towards the finger, the force on the finger.
    """

    finger: int
    point: FloatArray
    normal: FloatArray
    force: FloatArray


def contacts(model: MjModel, data: MjData) -> list[Contact]:
    """All contacts of a forwarded state."""
    tips = {mj.mj_name2id(model, mj.mjtObj.mjOBJ_GEOM, f"finger_{k + 1}_tip"): k for k in range(3)}
    found: list[Contact] = []
    wrench = np.zeros(6)
    for number in range(data.ncon):
        contact = data.contact[number]
        mj.mj_contactForce(model, data, number, wrench)
        frame = contact.frame.reshape(3, 3)
        along = frame.T @ wrench[:3]
        first, second = contact.geom.tolist()  # the force acts on the second geom
        side = 1.0 if second in tips else -1.0
        finger = tips[second if second in tips else first]
        found.append(
            Contact(finger, np.array(contact.pos[:2]), side * frame[0, :2], side * along[:2])
        )
    return found


def finger_forces(model: MjModel, data: MjData) -> tuple[FloatArray, int]:
    """Force vectors on the fingers in W, (3, 2), and the number of contacts, of a forwarded state.

    A finger in a concave corner has two contacts or more; their forces are added as vectors.
    """
    total = np.zeros((3, 2))
    found = contacts(model, data)
    for one in found:
        total[one.finger] += one.force
    return total, len(found)
