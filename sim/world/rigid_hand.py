"""A hand locked at one size: three discs fixed in the palm, the object free among them.

The fingers lose their slides, so nothing of the hand gives: what moves is the object alone, with
qpos = x, y, turn as in ``sim.world.object_model``.
"""

from __future__ import annotations

import numpy as np

from icage.arrays import FloatArray
from sim.world.engine import MjData, MjModel, mj
from sim.world.hand_in_object import depths
from sim.world.scene import Scene


def rigid_model(scene: Scene, sigma: float) -> MjModel:
    """The scene compiled with finger k fixed at sigma L_k u_k; ``sigma`` in [diameter]."""
    spec = scene.spec(visuals=False)
    spec.modelname = "icage_rigid_hand"
    for parts in (spec.equalities, spec.actuators, spec.tendons):
        for part in list(parts):
            spec.delete(part)
    at = sigma * scene.kinematics.lengths[:, None] * scene.kinematics.directions
    for k, (x, y) in enumerate(at.tolist()):
        spec.delete(spec.joint(f"finger_{k + 1}_slide"))
        spec.body(f"finger_{k + 1}").pos = [x, y, 0.0]
    return spec.compile()


def rigid_data(model: MjModel, pose: FloatArray) -> MjData:
    """An MjData with the object at rest at pose (3,) = x, y, turn."""
    data = mj.MjData(model)
    data.qpos[:] = pose
    return data


def disc_depths(scene: Scene, sigma: float, pose: FloatArray) -> FloatArray:
    """[diameter] (3,) how deep each disc reaches into the object at pose (3,); negative: apart."""
    x, y, turn = (float(value) for value in pose)
    at = sigma * scene.kinematics.lengths[:, None] * scene.kinematics.directions - [x, y]
    cos, sin = np.cos(turn), np.sin(turn)
    fingers = at @ np.array([[cos, -sin], [sin, cos]])
    out = np.empty(3)
    depths(scene.object.vertices, fingers, scene.finger_radius / scene.object.diameter, out)
    return out
