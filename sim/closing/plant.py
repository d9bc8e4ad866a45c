"""What a computed step needs of a scene, read off the compiled model as plain numbers."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from icage.arrays import FloatArray
from sim.closing.computed_step import STIFFEST, STIFFNESS, Plant
from sim.world.engine import MjModel, mj
from sim.world.scene import Scene

_BODIES: Final = ("finger_1", "finger_2", "finger_3", "object")

_SLOW: Final = 0.02
"""[free speed] An object that is touched and slower than this is the engine's: whether it is at
rest, or passes a balance, is not for us to say."""

_FLAT: Final = 1e-6
"""[diameter] Vertices of a piece nearer than this to the plane are its rim."""


def plant_of(scene: Scene) -> Plant:
    """Everything read off the compiled model, nothing computed a second time."""
    model, config, hand = scene.model, scene.config, scene.kinematics
    step = config.time_step
    body = np.array([model.body(name).id for name in _BODIES])
    thing = body[-1]
    mass = np.append(model.body_mass[body], [model.body_mass[thing], model.body_inertia[thing, 2]])
    damping = np.array(model.dof_damping, dtype=np.float64)
    metric = mass + step * damping
    pull = np.zeros(6)
    pull[:3] = scene.closing_force * hand.tendon_coefficients
    links, link_weight = _linkage(model, mass, metric)
    loose = np.array(model.body_invweight0)[body, 0]
    rims = _rims(model, int(thing))
    middle = np.array([rim.mean(axis=0) for rim in rims])
    reach = [np.hypot(*(rim - m).T).max() for rim, m in zip(rims, middle, strict=True)]
    return Plant(
        step=step,
        lighter=1.0 / mass,
        metric=metric,
        softer=1.0 / metric,
        damping=damping,
        pull=pull,
        directions=hand.directions,
        radius=float(model.geom("finger_1_tip").size[0]),
        links=links,
        link_weight=link_weight,
        link_law=_law(np.array(model.eq_solref[0]), step),
        contact_weight=loose[:-1] + loose[-1],
        contact_law=_law(np.array(config.solref), step),
        slow=_SLOW * config.free_speed,
        points=np.vstack(rims),
        first=np.cumsum([0, *(len(rim) for rim in rims)], dtype=np.int64),
        middle=middle,
        reach=np.array(reach),
    )


def _linkage(model: MjModel, mass: FloatArray, metric: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Rows (2, 6) of the equalities between slides, and the weight s_i of each."""
    links, weight = np.zeros((2, 6)), np.zeros(2)
    for k in range(2):
        one, other = int(model.eq_obj1id[k]), int(model.eq_obj2id[k])
        links[k, one], links[k, other] = 1.0, -float(model.eq_data[k, 1])
        softer = (links[k] ** 2 / metric).sum() / (links[k] ** 2 / mass).sum()
        loose = float(model.dof_invweight0[one] + model.dof_invweight0[other])
        weight[k] = STIFFNESS / (loose * softer)
    return links, weight


def _law(solref: FloatArray, step: float) -> FloatArray:
    """What a reference (time constant, damping ratio) makes of an error and of its rate.

    ``discrete`` takes the spring K d and the damper B at the end of the step.
    """
    constant, ratio = solref.tolist()
    scaled = STIFFEST * constant
    spring, damper = STIFFEST / (scaled * ratio) ** 2, 2.0 / scaled
    return np.array([spring, damper + step * spring]) / (1.0 + step * damper + step**2 * spring)


def _rims(model: MjModel, body: int) -> list[FloatArray]:
    """Vertices of each compiled piece in the plane, counterclockwise."""
    rims: list[FloatArray] = []
    for geom in np.flatnonzero(model.geom_bodyid == body).tolist():
        mesh: Any = model.geom_dataid[geom]
        begin, count = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
        turn = np.zeros(9)
        mj.mju_quat2Mat(turn, model.geom_quat[geom])
        solid = np.array(model.mesh_vert[begin : begin + count], dtype=np.float64)
        placed = solid @ turn.reshape(3, 3).T + model.geom_pos[geom]
        rims.append(placed[np.abs(placed[:, 2]) < _FLAT][:, :2])
    return rims
