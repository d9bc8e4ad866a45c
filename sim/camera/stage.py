"""The scene dressed for a camera: object as one solid, target outline, caging regions, lights.

Only looks are added; nothing here can change the motion.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np
import shapely
import trimesh

from icage.arrays import FloatArray
from icage.hand import Placement
from sim.world.engine import MjBody, MjSpec, mj
from sim.world.hand_model import FINGER_COLOURS, looks_only
from sim.world.object_model import OBJECT_COLOUR
from sim.world.scene import Scene

CAMERA: Final = "top"
_TARGET_COLOUR: Final = (0.98, 0.55, 0.05, 0.99)
"""Almost opaque: transparent things throw no shadow."""
_REGION_ALPHA: Final = 0.3
_FLOOR: Final = -0.16

_FINEST: Final = 2e-4
"""[diameter] A fifth of a pixel: finer detail of a region is not drawn."""

_HIDDEN_GROUP: Final = 4
"""The collision pieces, whose seams nobody wants to see; groups 0 to 2 are drawn."""


@dataclass(frozen=True, slots=True)
class View:
    """What the camera sees: an orthographic window onto the palm's plane.

    Attributes
    ----------
    centre:
        (x, y) in the palm frame P, [diameter].
    extent:
        [diameter] Height of the window.
    width, height:
        [pixel].
    """

    centre: tuple[float, float]
    extent: float
    width: int
    height: int

    @classmethod
    def around(
        cls, scene: Scene, qpos: FloatArray, width: int, height: int, margin: float = 0.06
    ) -> View:
        """The smallest window that holds the object and the fingers in all frames (F, 6)."""
        radius = scene.finger_radius / scene.object.diameter
        cos, sin = np.cos(qpos[:, 5:6]), np.sin(qpos[:, 5:6])
        x, y = scene.object.vertices.T
        object_x = cos * x - sin * y + qpos[:, 3:4]
        object_y = sin * x + cos * y + qpos[:, 4:5]
        finger_x = qpos[:, :3] * scene.kinematics.directions[:, 0]
        finger_y = qpos[:, :3] * scene.kinematics.directions[:, 1]
        low_x = min(object_x.min(), finger_x.min() - radius) - margin
        high_x = max(object_x.max(), finger_x.max() + radius) + margin
        low_y = min(object_y.min(), finger_y.min() - radius) - margin
        high_y = max(object_y.max(), finger_y.max() + radius) + margin
        extent = max(high_y - low_y, (high_x - low_x) * height / width)
        centre = (float(low_x + high_x) / 2.0, float(low_y + high_y) / 2.0)
        return cls(centre, float(extent), width, height)

    def pixels(self, points: FloatArray) -> FloatArray:
        """Pixel positions (..., 2), origin top left, of points (..., 2) of P in [diameter]."""
        scale = self.height / self.extent
        x = self.width / 2.0 + (points[..., 0] - self.centre[0]) * scale
        y = self.height / 2.0 - (points[..., 1] - self.centre[1]) * scale
        return np.stack([x, y], axis=-1)


@dataclass(frozen=True, slots=True)
class Decor:
    """What is drawn beside hand and object.

    Attributes
    ----------
    regions:
        Pairs (finger 1..3, polygon in the object's frame and unit): translucent, fixed to the
        object.
    target:
        The target placement: its outline is drawn where the object will stand in the hand frame.
    """

    regions: Sequence[tuple[int, shapely.Geometry]] = field(default=())
    target: Placement | None = None


def dressed(scene: Scene, view: View, decor: Decor) -> MjSpec:
    """The scene's spec with camera, lights and everything to be seen."""
    spec = scene.spec(visuals=True)
    spec.modelname = "icage_stage"
    body = spec.body("object")
    for geom in list(body.geoms):
        geom.group = _HIDDEN_GROUP
    _add_flat(spec, body, "object_look", _polygon(scene.object.vertices), -0.045, 0.045)
    spec.geom("object_look").rgba = list(OBJECT_COLOUR)
    for number, (finger, geometry) in enumerate(decor.regions):
        _add_region(spec, body, scene, number, finger, geometry)
    if decor.target is not None:
        _add_target(spec, scene, decor.target)
    _light(spec, view)
    _add_floor(spec)
    camera = spec.worldbody.add_camera(name=CAMERA, pos=[*view.centre, 2.0])
    camera.proj = mj.mjtProjection.mjPROJ_ORTHOGRAPHIC
    camera.fovy = view.extent
    return spec


def _polygon(vertices: FloatArray) -> shapely.Polygon:
    return shapely.Polygon(vertices)


def _add_region(
    spec: MjSpec,
    body: MjBody,
    scene: Scene,
    number: int,
    finger: int,
    geometry: shapely.Geometry,
) -> None:
    """One flat translucent mesh per part, painted on the floor: higher up it would cast shadows."""
    normal = shapely.transform(
        geometry, lambda points: (points - scene.object.centre) / scene.object.diameter
    )
    for part_number, part in enumerate(_parts(shapely.simplify(normal, _FINEST))):
        name = f"region_{number}_{part_number}_look"
        level = _FLOOR + 0.002 * finger
        _add_flat(spec, body, name, part, level, level + 0.001)
        spec.geom(name).rgba = [*FINGER_COLOURS[finger - 1], _REGION_ALPHA]


def _add_target(spec: MjSpec, scene: Scene, target: Placement) -> None:
    """A line round the place of the object in the hand once it is grasped; fixed in the world."""
    x, y, turn = scene.start_positions(target.as_array())[0, 3:].tolist()
    corner = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    vertices = scene.object.vertices @ corner.T + [x, y]
    line = shapely.LinearRing(vertices).buffer(0.004, join_style="mitre")
    for number, part in enumerate(_parts(line)):
        name = f"target_{number}_look"
        _add_flat(spec, spec.worldbody, name, part, 0.045, 0.047)
        spec.geom(name).rgba = list(_TARGET_COLOUR)


def _parts(geometry: shapely.Geometry) -> list[shapely.Polygon]:
    """The polygons of an area, without dust: specks and pinholes too small to be seen."""
    parts = shapely.get_parts(shapely.make_valid(geometry))
    flat = [p for part in parts for p in shapely.get_parts(part)]
    return [
        shapely.Polygon(p.exterior, [h for h in p.interiors if _seen(shapely.Polygon(h))])
        for p in flat
        if isinstance(p, shapely.Polygon) and _seen(p)
    ]


def _seen(polygon: shapely.Polygon) -> bool:
    return polygon.area > _FINEST * polygon.length


def _add_flat(
    spec: MjSpec, body: MjBody, name: str, polygon: shapely.Polygon, low: float, high: float
) -> None:
    """A plate of any shape, holes included, as one mesh."""
    parts = shapely.get_parts(shapely.constrained_delaunay_triangles(polygon))
    corners = shapely.get_coordinates(parts).reshape(-1, 4, 2)[:, :3].reshape(-1, 2)
    vertices, triangles = np.unique(corners, axis=0, return_inverse=True)
    plate = trimesh.creation.extrude_triangulation(vertices, triangles.reshape(-1, 3), high - low)
    plate.apply_translation([0.0, 0.0, low])
    corners = plate.vertices[plate.faces].reshape(-1, 3)  # own corners: no smoothed normals
    mesh = spec.add_mesh(name=name)
    mesh.uservert = corners.ravel()
    mesh.userface = np.arange(len(corners), dtype=np.int32)
    mesh.inertia = mj.mjtMeshInertia.mjMESH_INERTIA_SHELL
    geom = body.add_geom(name=name, type=mj.mjtGeom.mjGEOM_MESH, meshname=name)
    looks_only(geom)


def _light(spec: MjSpec, view: View) -> None:
    """A slanted directional light with a shadow; the default headlight over-exposes."""
    spec.worldbody.add_light(
        name="sun",
        type=mj.mjtLightType.mjLIGHT_DIRECTIONAL,
        pos=[-0.26, 0.37, 2.2],
        dir=[0.12, -0.17, -1.0],
        diffuse=[0.38, 0.38, 0.38],
        specular=[0.05, 0.05, 0.05],
        castshadow=True,
    )
    visual = spec.visual
    visual.headlight.ambient = [0.52, 0.52, 0.52]
    visual.headlight.diffuse = [0.12, 0.12, 0.12]
    visual.headlight.specular = [0.0, 0.0, 0.0]
    visual.quality.shadowsize = 2048
    visual.quality.offsamples = 4
    visual.map.znear = 0.01
    visual.map.zfar = 10.0
    wide = view.extent * view.width / view.height
    reach = math.hypot(*view.centre) + 0.5 * math.hypot(view.extent, wide)
    visual.map.shadowclip = max(1.2, 1.15 * reach + 0.3)  # beyond it the floor is speckled
    spec.stat.extent = 1.0
    spec.stat.center = [0.0, 0.0, 0.0]


def _add_floor(spec: MjSpec) -> None:
    floor = spec.worldbody.add_geom(
        name="floor_look",
        type=mj.mjtGeom.mjGEOM_PLANE,
        pos=[0.0, 0.0, _FLOOR],
        size=[6.0, 6.0, 0.1],
        rgba=[0.96, 0.96, 0.95, 1.0],
    )
    looks_only(floor)
