"""Contact forces at a state: who presses, and how hard."""

from __future__ import annotations

import numpy as np

from icage.arrays import FloatArray
from sim.engine import MjData, MjModel, mj


def finger_forces(model: MjModel, data: MjData) -> tuple[FloatArray, int]:
    """Force vectors on the fingers in W, (3, 2), and the number of contacts, of a forwarded state.

    A finger in a concave corner has two contacts or more; their forces are added as vectors.
    """
    total = np.zeros((3, 2))
    tips = {mj.mj_name2id(model, mj.mjtObj.mjOBJ_GEOM, f"finger_{k + 1}_tip"): k for k in range(3)}
    wrench = np.zeros(6)
    for number in range(data.ncon):
        contact = data.contact[number]
        mj.mj_contactForce(model, data, number, wrench)
        along = contact.frame.reshape(3, 3).T @ wrench[:3]
        first, second = contact.geom.tolist()  # the force acts on the second geom
        if second in tips:
            total[tips[second]] += along[:2]
        else:
            total[tips[first]] -= along[:2]
    return total, int(data.ncon)
