"""Settings of the simulation, in normalized units, each with its reason.

Inside the engine every case looks alike: the object's diameter is 1, its mass is 1, time is in
seconds of that small world. So a force is in [mass diameter / s^2] and a damping in [mass / s].
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import cast

from icage.checks import a_count, a_number
from icage.errors import InputError


@dataclass(frozen=True, slots=True)
class SimConfig:
    """How the hand closes and when a closing counts as finished.

    The motor's force is shared by the fingers in the ratio of their travel; ``drive_force`` is the
    root of the sum of the squares of the three finger forces and ``finger_damping`` acts on every
    finger alike, so that nothing depends on which finger is called finger 1.

    Examples
    --------
    >>> SimConfig().free_speed
    0.5
    """

    time_step: float = 1e-3
    """[s] The deepest penetration on impact is about speed times this."""

    drive_force: float = 900.0
    """[mass diameter / s^2] Constant. Over ``object_damping`` it bounds the speed of the object, to
    3 / s: at 10 / s the impacts of a spinning object were up to 1.4e-3 deep, at 3 / s 0.8e-3; the
    tails of three-edge grasps grow longer in the same ratio."""

    finger_damping: float = 1800.0
    """[mass / s] Per finger slide; with the force the speed of the free fingers, 0.5 / s. At
    0.7 / s impacts are up to 1.0e-3 deep."""

    object_damping: float = 300.0
    """[mass / s] A viscous table: the object forgets its speed within 3 ms, so that inertia does
    not decide where a closing ends (at a tenth of this, objects ring about the target)."""

    finger_mass: float = 0.2
    """[mass] Irrelevant next to the damping (a finger forgets its speed in 0.1 ms); of the order of
    the object for a good condition."""

    contact_solref: float = 0.5
    """[time_step] Time constant of a contact. Stiffer than MuJoCo's advice of 2, which the
    ``discrete`` integrator allows: 5 steps would already give 1.3e-3 of penetration."""

    contact_damping: float = 2.0
    """[1] Damping ratio of a contact. With 1 (and a time constant of 1 step) some contacts rattle:
    lost for a step, then back, up to 7e-4 deep, for ever (with friction, with half the step, with
    heavy objects)."""

    linkage_solref: float = 0.01
    """[time_step] Time constant of the linkage: shape error 1e-8 (6e-5 with MuJoCo's default)."""

    linkage_compliance: float = 0.0
    """[s^2 / mass] How far a finger yields from its place in the similar triangle, per force. 0:
    rigid; above 0 three springs of stiffness 1 / this are the linkage
    (``sim.world.hand_model``)."""

    solimp: tuple[float, float, float, float, float] = (0.9999, 0.99999, 1e-4, 0.5, 2.0)
    """MuJoCo's impedance, for a resting penetration below 1e-6. Its defaults leave an angle
    error of 1e-2 rad: useless here."""

    solver_iterations: int = 50
    """Cap on Newton iterations; 5 are usually enough, 3 are not."""

    solver_tolerance: float = 1e-10
    """MuJoCo's scaled tolerance; between 1e-6 and 1e-14 nothing changes."""

    friction: float = 0.0
    """[1] Coulomb coefficient between fingers and object. With 0 contacts have no tangential
    rows at all (condim 1): the planner's statements are about frictionless closing."""

    impratio: float = 1.0
    """[1] How much stiffer friction is than the normal of a contact. Sticking is regularized: a
    jammed object creeps, on a wedge at 4e-5 diameters / s with 1 and at 1 / ``impratio`` of that
    with more. It moves no coefficient at which a hand begins to stick (``sim.grip.stick``)."""

    still_speed: float = 1e-5
    """[diameter / s, rad / s] Slower than this is still. The tail of a three-edge grasp decays with
    a time constant of about 0.05 s, so what is left is below 1e-6."""

    still_steps: int = 10
    """[step] ... for this many steps in a row, while two fingers press."""

    remains: float = 5e-6
    """[diameter, rad] Without friction a closing is also at rest when its speed falls exponentially
    and what is left of the way, speed times time constant, is below this
    (``sim.closing.look``): a twentieth of what counts as the target. 0: wait for
    ``still_speed``."""

    computed_contacts: int = 3
    """[1] While the object is pushed about and has no more contacts than these, the engine's steps
    are computed by ``sim.closing.push``: the same map to 1e-9, at a quarter of the cost. 0: all
    steps by the engine."""

    max_time: float = 20.0
    """[s] A closing still moving then has timed out: a failure to look at. The slowest grasp known
    (three straight edges, ``models/hard/spiral_tunnel``) takes 11 s."""

    pinched_size: float = 1e-4
    """[diameter] A hand whose longest side is shorter than this has shut on nothing: escaped."""

    def __post_init__(self) -> None:
        positive = ("drive_force", "finger_damping", "object_damping", "impratio", "max_time")
        for name in ("time_step", *positive):
            value = a_number(getattr(self, name), f"SimConfig.{name}")
            if not value > 0.0:
                raise InputError(f"SimConfig.{name} is {value}; a positive number is needed")
        for name in (
            "finger_mass", "contact_solref", "contact_damping", "linkage_solref",
            "solver_tolerance", "still_speed", "pinched_size",
        ):  # fmt: skip
            a_number(getattr(self, name), f"SimConfig.{name}")
        for name in ("solver_iterations", "still_steps"):
            a_count(getattr(self, name), f"SimConfig.{name}", 1)
        _check_solimp(self.solimp)
        contacts = self.computed_contacts
        if contacts not in (0, 1, 2, 3):
            raise InputError(f"SimConfig.computed_contacts is {contacts!r}; 0 to 3 is needed")
        for name in ("friction", "linkage_compliance", "remains"):
            value = a_number(getattr(self, name), f"SimConfig.{name}")
            if not value >= 0.0:
                raise InputError(f"SimConfig.{name} is {value}; >= 0 is needed")

    @property
    def solref(self) -> tuple[float, float]:
        """[s], [1] MuJoCo's reference of a contact: time constant and damping ratio."""
        return self.contact_solref * self.time_step, self.contact_damping

    @property
    def free_speed(self) -> float:
        """[diameter / s] Root sum square of the three finger speeds while nothing is touched."""
        return round(self.drive_force / self.finger_damping, 3)

    @property
    def max_steps(self) -> int:
        """[step] Bound on the length of one closing."""
        return math.ceil(self.max_time / self.time_step)


def _check_solimp(value: object) -> None:
    if not isinstance(value, tuple) or len(cast("tuple[object, ...]", value)) != 5:
        raise InputError(f"SimConfig.solimp is {value!r}; five numbers are needed")
    for number in cast("tuple[object, ...]", value):
        a_number(number, "SimConfig.solimp")
