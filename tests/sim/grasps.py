"""Target grasps with disc fingers whose exact place can be written down, and starts near them."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np
import shapely

import models
from icage.arrays import FloatArray
from icage.hand import HandShape, Placement
from icage.outline import Outline
from models import CASES
from sim.world.config import SimConfig
from sim.world.scene import Scene


@dataclass(frozen=True)
class KnownGrasp:
    """A target with its disc radius; satisfies ``sim.closing.judge.Grasp``."""

    outline: Outline
    radius: float
    contacts: FloatArray
    id: int = 0
    plateau: tuple[FloatArray, FloatArray] | None = None

    @property
    def hand(self) -> HandShape:
        return HandShape.from_contacts(self.contacts)

    @property
    def target(self) -> Placement:
        return Placement.from_contacts(self.contacts)

    def scene(self, config: SimConfig | None = None) -> Scene:
        return Scene(self.outline, self.hand, self.radius, config or SimConfig())


def case_outline(name: str) -> tuple[Outline, FloatArray, float]:
    """Outline, contacts and radius of a shipped solved case."""
    case = json.loads((CASES / f"{name}.json").read_text())
    contacts = np.array(case["grasp"]["contacts"])
    return Outline(case["outline"]["vertices"]), contacts, case["finger_radius"]


def disc_case(name: str) -> KnownGrasp:
    """The grasp of a shipped solved case with disc fingers."""
    outline, contacts, radius = case_outline(name)
    return KnownGrasp(outline, radius, contacts)


def t_shape() -> KnownGrasp:
    """Two discs in the concave corners of the T, one on its top; 4 mm on a metre, so to say."""
    outline, contacts, _ = case_outline("T_best")
    r = 0.025 * outline.diameter
    return KnownGrasp(outline, r, contacts + r * np.array([[1, -1], [0, 1], [-1, -1]]))


def l_shape() -> KnownGrasp:
    """One disc in the concave corner of the L, two on its outer edges."""
    outline, contacts, _ = case_outline("L_best")
    r = 0.025 * outline.diameter
    return KnownGrasp(outline, r, contacts + r * np.array([[-1, 0], [0, -1], [1, 1]]))


def triangle() -> KnownGrasp:
    """Discs on the middles of three edges: second-order immobility only."""
    outline = Outline([[np.cos(a), np.sin(a)] for a in np.deg2rad([90, 210, 330])])
    r = 0.03 * outline.diameter
    reach = 0.5 + r
    contacts = np.array([[np.cos(a), np.sin(a)] for a in np.deg2rad([150, 270, 30])]) * reach
    return KnownGrasp(outline, r, contacts)


def shipped(name: str) -> KnownGrasp:
    """A concave-corner grasp of a shipped tool, discs of radius 6 mm, found by ``icage grasps``."""
    contacts = {
        "pliers": [
            [62.13588638358817, 19.298875791902578],
            [86.09050132560871, 63.68985118568504],
            [35.8238864045785, 60.8936537113419],
        ],
        "saw": [
            [455.2094093981052, 62.307869049995546],
            [324.574041865802, 111.10441218066876],
            [323.0945966978584, 24.757924438640092],
        ],
        "wrench": [
            [53.44825838482677, 143.22669959053394],
            [78.43899251310799, 78.68587325356026],
            [121.41861433054112, 120.75926202520759],
        ],
    }[name]
    case = json.loads(models.outline_path(name).read_text())
    return KnownGrasp(Outline(case["outline"]["vertices"]), 6.0, np.array(contacts))


GRASPS: Final[dict[str, Callable[[], KnownGrasp]]] = {
    "T": t_shape,
    "L": l_shape,
    "triangle": triangle,
    "pliers": lambda: shipped("pliers"),
    "saw": lambda: shipped("saw"),
    "wrench": lambda: shipped("wrench"),
    "hammer": lambda: disc_case("disc_hammer"),
}
"""Every known grasp by its name, to be made when it is needed."""


def starts_near(
    grasp: KnownGrasp,
    count: int,
    seed: int,
    opening: float = 1.15,
    shift: float = 0.04,
    turn: float = 0.1,
) -> FloatArray:
    """Placements (count, 4), clear of the object, up to ``opening`` times the target's size.

    The centroid of the fingers is moved by up to ``shift`` diameters, so small steps that no finger
    can have crossed the object.
    """
    rng = np.random.default_rng(seed)
    target, z = grasp.target, grasp.hand.z
    here = complex(target.x, target.y) + target.sigma * np.exp(1j * target.theta) * z.mean()
    found: list[FloatArray] = []
    for _ in range(200 * count):
        sigma = target.sigma * rng.uniform(1.0, opening)
        theta = target.theta + rng.uniform(-turn, turn)
        off = complex(*rng.uniform(-shift, shift, 2)) * grasp.outline.diameter
        d = here + off - sigma * np.exp(1j * theta) * z.mean()
        row = np.array([d.real, d.imag, theta, sigma])
        fingers = shapely.points(grasp.hand.fingers(row))
        if (shapely.distance(grasp.outline.polygon, fingers) > grasp.radius).all():
            found.append(row)
        if len(found) == count:
            return np.array(found)
    raise AssertionError("too few starts are clear of the object")
