"""The hand: a palm, three fingers on rails, one tendon, one motor.

The palm is fixed in the world W, and the palm's frame P is W: the object moves, the hand does not.
P has its origin at the centroid of the three fingers (for every size of the hand) and its x axis
from finger 1 towards finger 2. Finger k stands at

    p_k(sigma) = sigma (z_k - z_c) = q_k u_k,    q_k = L_k sigma,  L_k = |z_k - z_c|

so three slides along the unit vectors u_k and the *linkage* q_k / L_k = q_j / L_j keep the triangle
similar to itself. The drive is a fixed tendon over the slides with the coefficients
L_k / sum L_j^2: on the linkage its length is sigma. The only motor pulls on it. The tendon alone
would be a differential and lose the shape; the linkage alone would not know of a cable.

A compliant linkage is springs of one stiffness K on how far each finger is off its place,

    e_k = q_k - L_k sigma = sum_j P_kj q_j,    P = 1 - L L^T / sum L_j^2

P projects, so the forces on the slides are -K P q = -K e: they never act on sigma, no finger is
special, and a push F on the slides moves the fingers by P F / K from their places.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from icage.arrays import FloatArray, read_only
from icage.errors import InputError
from icage.hand import HandShape
from sim.world.config import SimConfig
from sim.world.engine import MjBody, MjGeom, MjSpec, mj

OBJECT_BIT, FINGER_BIT = 1, 2
"""contype of the two sides: fingers touch only the object, never one another. (The planner's
fingers may pass each other too; the centres meet only when the hand is pinched.)"""

FINGER_COLOURS = ((0.0, 0.447, 0.698), (0.835, 0.369, 0.0), (0.0, 0.620, 0.451))
"""One colour per finger, in every picture: distinct to colour-blind readers."""

LEAST_RADIUS = 2e-5
"""[diameter] Of a finger. MuJoCo 4.0.0 takes a ball of a volume below 1e-14 for nothing."""

LEAST_INERTIA = 2e-15
"""[mass diameter^2] Of a finger. MuJoCo refuses bodies of less than 1e-15."""

_REST_LENGTH = 1e-12
"""[diameter] Of the linkage's springs. Not 0: the engine takes a spring that has exactly its rest
length for one without stiffness, and the first push would throw the fingers far off."""

_COLLISION_TOLERANCE = 1e-10
"""[diameter] To which the engine finds the nearest points of two convex pieces: a ten-thousandth of
``TOUCHING`` in ``sim.closing.look``; its default of 1e-6 would be as coarse as that."""

_CABLE_DEPTH, _PALM_DEPTH = -0.09, -0.13
"""[diameter] Where the drawn parts lie: below the object, which is seen from above."""


@dataclass(frozen=True, slots=True)
class HandKinematics:
    """The numbers of the linkage of one hand shape, for sigma in any unit of length.

    Attributes
    ----------
    centroid:
        z_c, mean of the unit fingers, as a complex number.
    directions:
        u_k, (3, 2), unit vectors of the slides in P.
    lengths:
        L_k, (3,), travel of each slide per unit of sigma.
    longest_side:
        Longest side of the unit triangle, at least 1.
    spread:
        Root of sum L_k^2: turns sigma into a size that no relabelling of fingers changes.
    tendon_coefficients:
        L_k / sum L_j^2, (3,): the tendon's length over the slides is then sigma.
    """

    shape: HandShape
    centroid: complex = field(init=False)
    directions: FloatArray = field(init=False, repr=False)
    lengths: FloatArray = field(init=False)
    longest_side: float = field(init=False)
    spread: float = field(init=False, repr=False, compare=False)  # read at every step
    tendon_coefficients: FloatArray = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        centroid = complex(self.shape.z.mean())
        arms = self.shape.z - centroid
        lengths = np.abs(arms)
        z_1, z_2, z_3 = self.shape.z.tolist()
        directions = np.column_stack([arms.real, arms.imag]) / lengths[:, None]
        object.__setattr__(self, "centroid", centroid)
        object.__setattr__(self, "lengths", read_only(lengths))
        object.__setattr__(self, "directions", read_only(directions))
        object.__setattr__(
            self, "longest_side", max(abs(z_2 - z_1), abs(z_3 - z_2), abs(z_1 - z_3))
        )
        spread = math.hypot(*lengths.tolist())
        object.__setattr__(self, "spread", spread)
        object.__setattr__(self, "tendon_coefficients", read_only(lengths / spread**2))

    @property
    def shape_projector(self) -> FloatArray:
        """P, (3, 3): slides to how far each finger is off its place in the similar triangle."""
        return np.eye(3) - np.outer(self.lengths, self.tendon_coefficients)


def build_hand(
    shape: HandShape, finger_radius: float, config: SimConfig, visuals: bool = True
) -> MjSpec:
    """A spec with the hand alone; ``finger_radius`` in object diameters.

    ``visuals`` adds what is only to be seen (rails, drawn fingers, cable); without it a step is a
    third cheaper and the motion is the same, bit for bit.

    Raises
    ------
    InputError:
        The radius is zero: point fingers have no body to simulate. Or the fingers are too small, or
        too light, for the engine.
    """
    if not finger_radius > 0.0:
        raise InputError(
            f"finger_radius is {finger_radius:g}; the simulated fingers are discs and need "
            "a radius above 0"
        )
    if finger_radius < LEAST_RADIUS:
        raise InputError(
            f"finger_radius is {finger_radius:.3g} diameters of the object; simulated fingers need "
            f"{LEAST_RADIUS:g} or more"
        )
    inertia = 0.4 * config.finger_mass * finger_radius**2
    if inertia < LEAST_INERTIA:
        raise InputError(
            f"SimConfig.finger_mass is {config.finger_mass:g}: fingers of a radius of "
            f"{finger_radius:.3g} diameters then have a moment of inertia of {inertia:.3g}; the "
            f"engine needs {LEAST_INERTIA:g} or more"
        )
    kinematics = HandKinematics(shape)
    spec = mj.MjSpec()
    spec.modelname = "icage_hand"
    _set_options(spec, config)
    palm = spec.worldbody.add_body(name="palm", pos=[0.0, 0.0, 0.0])
    for k in range(3):
        _add_finger(palm, k, kinematics, finger_radius, config)
    if config.linkage_compliance > 0.0:
        _add_springs(spec, kinematics, config)
    else:
        _add_linkage(spec, kinematics, config)
    _add_drive(spec, kinematics, config)
    if visuals:
        _draw_palm(palm, kinematics, finger_radius)
        _draw_fingers(spec, finger_radius)
        _draw_cable(spec, finger_radius)
    return spec


def add_instruments(spec: MjSpec, finger_radius: float) -> None:
    """A touch sensor per finger (sum of its contacts' normal forces), fingers without weight.

    They change no motion on a level table.
    """
    for k in range(3):
        finger = spec.body(f"finger_{k + 1}")
        finger.gravcomp = 1.0
        finger.add_site(
            name=f"finger_{k + 1}_skin", size=[1.1 * finger_radius, 0.0, 0.0], rgba=[0, 0, 0, 0]
        )
        spec.add_sensor(
            name=f"finger_{k + 1}_force",
            type=mj.mjtSensor.mjSENS_TOUCH,
            objtype=mj.mjtObj.mjOBJ_SITE,
            objname=f"finger_{k + 1}_skin",
        )


def contact_parameters(geom: MjGeom, config: SimConfig) -> None:
    """The same contact on both sides, so that no mixing rule is needed; margins stay 0, they add.

    Frictionless contacts are condim 1 on both geoms: a pair takes the larger of the two.
    """
    geom.solref = list(config.solref)
    geom.solimp = list(config.solimp)
    geom.condim = 3 if config.friction > 0.0 else 1
    geom.friction = [config.friction, 0.0, 0.0]
    geom.margin = 0.0
    geom.gap = 0.0


def looks_only(geom: MjGeom) -> None:
    """Make a geom a picture: it touches nothing and weighs nothing."""
    geom.contype = 0
    geom.conaffinity = 0
    geom.mass = 0.0


def _set_options(spec: MjSpec, config: SimConfig) -> None:
    """Integrator ``discrete`` solves contacts in the metric M + h D, so strong damping does not
    chatter; ``refsafe`` must be off for time constants below two steps. Dense Jacobians: MuJoCo
    4.0.0 has a wrong sparse Cholesky factor. No auto reset: a broken run must not look at home.
    No islands: with six degrees of freedom finding them costs more than it saves.
    """
    option = spec.option
    option.timestep = config.time_step
    option.gravity = [0.0, 0.0, 0.0]
    option.integrator = mj.mjtIntegrator.mjINT_DISCRETE
    option.solver = mj.mjtSolver.mjSOL_NEWTON
    option.jacobian = mj.mjtJacobian.mjJAC_DENSE
    option.cone = mj.mjtCone.mjCONE_ELLIPTIC
    option.impratio = config.impratio
    option.iterations = config.solver_iterations
    option.tolerance = config.solver_tolerance
    option.ccd_tolerance = _COLLISION_TOLERANCE
    off = mj.mjtDisableBit
    option.disableflags = (
        int(off.mjDSBL_REFSAFE) | int(off.mjDSBL_AUTORESET) | int(off.mjDSBL_ISLAND)
    )
    spec.compiler.autolimits = True


def _add_finger(
    palm: MjBody, k: int, kinematics: HandKinematics, finger_radius: float, config: SimConfig
) -> None:
    """A sphere in the object's plane of symmetry is an exact disc; a cylinder is drawn."""
    name = f"finger_{k + 1}"
    x, y = kinematics.directions[k].tolist()
    finger = palm.add_body(name=name)
    finger.add_joint(
        name=f"{name}_slide",
        type=mj.mjtJoint.mjJNT_SLIDE,
        axis=[x, y, 0.0],
        damping=[config.finger_damping, 0.0, 0.0],
    )
    tip = finger.add_geom(
        name=f"{name}_tip",
        type=mj.mjtGeom.mjGEOM_SPHERE,
        size=[finger_radius, 0.0, 0.0],
        mass=config.finger_mass,
        contype=FINGER_BIT,
        conaffinity=OBJECT_BIT,
        rgba=[*FINGER_COLOURS[k], 0.0],
    )
    contact_parameters(tip, config)


def _add_linkage(spec: MjSpec, kinematics: HandKinematics, config: SimConfig) -> None:
    """Two joint equalities, slaved to the finger that travels most: ratios of at most one."""
    lengths = kinematics.lengths
    leader = int(np.argmax(lengths))
    for k in range(3):
        if k == leader:
            continue
        link = spec.add_equality(
            name=f"linkage_{leader + 1}_{k + 1}",
            type=mj.mjtEq.mjEQ_JOINT,
            name1=f"finger_{k + 1}_slide",
            name2=f"finger_{leader + 1}_slide",
            objtype=mj.mjtObj.mjOBJ_JOINT,
        )
        data = np.zeros(link.data.shape)
        data[1] = lengths[k] / lengths[leader]
        link.data = data
        link.solref = [config.linkage_solref * config.time_step, 1.0]
        link.solimp = list(config.solimp)


def _add_springs(spec: MjSpec, kinematics: HandKinematics, config: SimConfig) -> None:
    """The compliant linkage: a sprung tendon of length e_k per finger.

    ``discrete`` takes springs implicitly, in M + h D + h^2 K, so any stiffness is stable.
    """
    for k, row in enumerate(kinematics.shape_projector.tolist()):
        spring = spec.add_tendon(name=f"linkage_{k + 1}")
        for j, coefficient in enumerate(row):
            spring.wrap_joint(f"finger_{j + 1}_slide", coefficient)
        spring.stiffness = [1.0 / config.linkage_compliance, 0.0, 0.0]
        spring.springlength = [_REST_LENGTH, _REST_LENGTH]


def _add_drive(spec: MjSpec, kinematics: HandKinematics, config: SimConfig) -> None:
    """The fixed tendon of length sigma and the one motor on it.

    A pull T on the tendon is the force T L_k / sum L_j^2 on slide k; the limit T <= drive_force *
    spread makes the root sum square of the three forces ``drive_force``.
    """
    drive = spec.add_tendon(name="drive")
    for k, coefficient in enumerate(kinematics.tendon_coefficients.tolist()):
        drive.wrap_joint(f"finger_{k + 1}_slide", coefficient)
    limit = config.drive_force * kinematics.spread
    motor = spec.add_actuator(name="motor", target="drive", trntype=mj.mjtTrn.mjTRN_TENDON)
    motor.set_to_motor()
    motor.ctrlrange = [-limit, limit]
    motor.forcerange = [-limit, limit]


def _draw_palm(palm: MjBody, kinematics: HandKinematics, finger_radius: float) -> None:
    steel = [0.55, 0.57, 0.60, 1.0]
    hub = palm.add_geom(
        name="palm_look",
        type=mj.mjtGeom.mjGEOM_CYLINDER,
        pos=[0.0, 0.0, _PALM_DEPTH],
        size=[0.06, 0.015, 0.0],
        rgba=steel,
    )
    looks_only(hub)
    for k, (x, y) in enumerate(kinematics.directions.tolist()):
        rail = palm.add_geom(
            name=f"rail_{k + 1}_look",
            type=mj.mjtGeom.mjGEOM_CAPSULE,
            fromto=[0.0, 0.0, _PALM_DEPTH, 1.5 * x, 1.5 * y, _PALM_DEPTH],
            size=[0.25 * finger_radius, 0.0, 0.0],
            rgba=steel,
        )
        looks_only(rail)
    palm.add_site(name="palm_drum", pos=[0.0, 0.0, _CABLE_DEPTH], rgba=[0, 0, 0, 0])


def _draw_fingers(spec: MjSpec, finger_radius: float) -> None:
    for k in range(3):
        finger = spec.body(f"finger_{k + 1}")
        cylinder = finger.add_geom(
            name=f"finger_{k + 1}_look",
            type=mj.mjtGeom.mjGEOM_CYLINDER,
            fromto=[0.0, 0.0, _PALM_DEPTH, 0.0, 0.0, 0.07],
            size=[finger_radius, 0.0, 0.0],
            rgba=[*FINGER_COLOURS[k], 1.0],
        )
        looks_only(cylinder)
        finger.add_site(
            name=f"finger_{k + 1}_cable_end", pos=[0.0, 0.0, _CABLE_DEPTH], rgba=[0, 0, 0, 0]
        )


def _draw_cable(spec: MjSpec, finger_radius: float) -> None:
    """A spatial tendon from the drum to each finger: a look, it carries no force."""
    cable = spec.add_tendon(
        name="cable_look", width=0.15 * finger_radius, rgba=[0.15, 0.15, 0.15, 1.0]
    )
    for k in range(3):
        if k > 0:
            cable.wrap_pulley(1.0)
        cable.wrap_site("palm_drum")
        cable.wrap_site(f"finger_{k + 1}_cable_end")
