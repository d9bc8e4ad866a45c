"""The object: a free planar body with the exact outline, moments and all, in normalized units."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import trimesh

from icage.arrays import FloatArray, read_only
from icage.outline import Outline
from sim.world.config import SimConfig
from sim.world.convex_pieces import convex_pieces
from sim.world.engine import MjSpec, mj
from sim.world.hand_model import FINGER_BIT, OBJECT_BIT, contact_parameters

OBJECT_COLOUR = (0.86, 0.72, 0.45, 1.0)

HALF_HEIGHT = 0.2
"""[diameter] Of the pieces; contacts do not depend on it."""

THINNEST_PIECE = 1e-8
"""[diameter] Pieces narrower than this are left out: MuJoCo stores mesh vertices in single
precision, so they could not be told from a line."""


@dataclass(frozen=True, slots=True)
class NormalObject:
    """The outline moved and scaled so that its area centroid is 0 and its diameter 1.

    Attributes
    ----------
    centre, diameter:
        Centroid (2,) and diameter in the case's frame B and unit.
    vertices:
        (n, 2), counterclockwise.
    pieces:
        Convex polygons that tile it.
    gyration_squared:
        [diameter^2] Polar second moment of area about the centroid, per area.
    """

    outline: Outline = field(repr=False)
    centre: FloatArray = field(init=False)
    diameter: float = field(init=False)
    vertices: FloatArray = field(init=False, repr=False)
    pieces: tuple[FloatArray, ...] = field(init=False, repr=False)
    gyration_squared: float = field(init=False)

    def __post_init__(self) -> None:
        centre, diameter = self.outline.centroid, self.outline.diameter
        normal = Outline.computed((self.outline.vertices - centre) / diameter)
        object.__setattr__(self, "centre", read_only(centre))
        object.__setattr__(self, "diameter", diameter)
        object.__setattr__(self, "vertices", normal.vertices)
        object.__setattr__(self, "pieces", convex_pieces(normal))
        object.__setattr__(self, "gyration_squared", polar_moment(normal.vertices) / normal.area)


def polar_moment(vertices: FloatArray) -> float:
    """Second moment of area about the origin, integral of x^2 + y^2 over a polygon (n, 2).

    Sum over the edges a b of (a x b) (a.a + a.b + b.b) / 12 (Green's theorem).
    """
    a, b = vertices, np.roll(vertices, -1, axis=0)
    cross = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return float((cross * ((a * a).sum(1) + (a * b).sum(1) + (b * b).sum(1))).sum() / 12.0)


def add_object(spec: MjSpec, normal: NormalObject, config: SimConfig) -> None:
    """Add the body ``object``: two slides, a hinge, one solid per convex piece.

    The inertia is stated, not left to the pieces.
    """
    body = spec.worldbody.add_body(name="object")
    body.explicitinertial = True
    body.mass = 1.0
    spin = normal.gyration_squared
    body.inertia = [spin, spin, spin]
    slide, hinge = mj.mjtJoint.mjJNT_SLIDE, mj.mjtJoint.mjJNT_HINGE
    damping = config.object_damping
    body.add_joint(name="object_x", type=slide, axis=[1, 0, 0], damping=[damping, 0, 0])
    body.add_joint(name="object_y", type=slide, axis=[0, 1, 0], damping=[damping, 0, 0])
    body.add_joint(name="object_turn", type=hinge, axis=[0, 0, 1], damping=[damping * spin, 0, 0])
    for number, piece in enumerate(normal.pieces):
        if _width(piece) < THINNEST_PIECE:
            continue
        solid = bipyramid(piece)
        mesh = spec.add_mesh(name=f"piece_{number}")
        mesh.uservert = solid.vertices.ravel()
        mesh.userface = solid.faces.ravel()
        mesh.inertia = mj.mjtMeshInertia.mjMESH_INERTIA_CONVEX
        geom = body.add_geom(
            name=f"object_piece_{number}",
            type=mj.mjtGeom.mjGEOM_MESH,
            meshname=f"piece_{number}",
            mass=0.0,
            contype=OBJECT_BIT,
            conaffinity=FINGER_BIT,
            rgba=list(OBJECT_COLOUR),
        )
        contact_parameters(geom, config)


def bipyramid(piece: FloatArray) -> trimesh.Trimesh:
    """Solid that cuts the plane z = 0 in a convex polygon (k, 2), counterclockwise: two apexes.

    It is symmetric in that plane, so the point of it nearest to a sphere's centre in the plane lies
    in the plane too: contacts are those of the polygon, as with an upright prism, from half the
    vertices and in fewer steps of the engine's search (a bare step of the saw: 24 us, not 30).
    """
    k, centre = len(piece), piece.mean(0)
    rim = np.column_stack([piece, np.zeros(k)])
    first = np.arange(k)
    second = (first + 1) % k
    above = np.column_stack([first, second, np.full(k, k)])
    below = np.column_stack([second, first, np.full(k, k + 1)])
    apexes = [[*centre, HALF_HEIGHT], [*centre, -HALF_HEIGHT]]
    return trimesh.Trimesh(np.vstack([rim, apexes]), np.vstack([above, below]), process=False)


def _width(piece: FloatArray) -> float:
    """Smallest extent of a convex polygon across one of its edges."""
    edges = np.roll(piece, -1, axis=0) - piece
    lengths = np.linalg.norm(edges, axis=1)
    normals = np.column_stack([-edges[:, 1], edges[:, 0]]) / lengths[:, None]
    heights = (piece[None, :, :] - piece[:, None, :]) * normals[:, None, :]
    return float(heights.sum(2).max(1).min())
