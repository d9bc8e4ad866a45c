"""icage: how far may a three-finger hand open before the object inside it can escape?

>>> import icage
>>> case = icage.load("pliers")
>>> cage = icage.plan(case)
>>> cage
<Cage pliers/1_best: sigma 50.4419 < 96.858 <= 96.8658 mm, 2 grasps>

Everything a user needs is here; it is loaded when it is first named, so that a command that only
prints its help loads neither shapely nor numba. Inside the project, import from the modules.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from icage.brink import Brink
    from icage.cage import Cage, CageStatus, GraspMinimum, Puncture
    from icage.case import Case
    from icage.errors import IcageError, InputError
    from icage.formats.cage_json import read_cage
    from icage.formats.load import load
    from icage.friction.curve import FrictionCurve, friction_curve
    from icage.friction.ends import JamEnds
    from icage.friction.jam import Jam, JamTolerance
    from icage.friction.levels import FrictionLevel, friction_levels
    from icage.friction.nearest import nearest_jam
    from icage.grasp import Grasp
    from icage.grasps.regrasp import regrasp
    from icage.grasps.wanted import HandLimits
    from icage.hand import HandShape, Placement
    from icage.hand_sublevels import sublevels
    from icage.minima import Sublevels
    from icage.outline import Outline
    from icage.placement_class import PlacementClass
    from icage.placing.best import BestPlacement, place
    from icage.planner import plan
    from icage.shelf import Shelf
    from icage.wedge import Wedge, WedgeKind

__version__ = "0.1.0"

_WHERE = {
    "BestPlacement": "icage.placing.best",
    "Brink": "icage.brink",
    "Cage": "icage.cage",
    "CageStatus": "icage.cage",
    "Case": "icage.case",
    "FrictionCurve": "icage.friction.curve",
    "FrictionLevel": "icage.friction.levels",
    "Grasp": "icage.grasp",
    "GraspMinimum": "icage.cage",
    "HandLimits": "icage.grasps.wanted",
    "HandShape": "icage.hand",
    "IcageError": "icage.errors",
    "InputError": "icage.errors",
    "Jam": "icage.friction.jam",
    "JamEnds": "icage.friction.ends",
    "JamTolerance": "icage.friction.jam",
    "Outline": "icage.outline",
    "Placement": "icage.hand",
    "PlacementClass": "icage.placement_class",
    "Puncture": "icage.cage",
    "Shelf": "icage.shelf",
    "Sublevels": "icage.minima",
    "Wedge": "icage.wedge",
    "WedgeKind": "icage.wedge",
    "friction_curve": "icage.friction.curve",
    "friction_levels": "icage.friction.levels",
    "load": "icage.formats.load",
    "nearest_jam": "icage.friction.nearest",
    "place": "icage.placing.best",
    "plan": "icage.planner",
    "read_cage": "icage.formats.cage_json",
    "regrasp": "icage.grasps.regrasp",
    "sublevels": "icage.hand_sublevels",
}

__all__ = [
    "BestPlacement",
    "Brink",
    "Cage",
    "CageStatus",
    "Case",
    "FrictionCurve",
    "FrictionLevel",
    "Grasp",
    "GraspMinimum",
    "HandLimits",
    "HandShape",
    "IcageError",
    "InputError",
    "Jam",
    "JamEnds",
    "JamTolerance",
    "Outline",
    "Placement",
    "PlacementClass",
    "Puncture",
    "Shelf",
    "Sublevels",
    "Wedge",
    "WedgeKind",
    "friction_curve",
    "friction_levels",
    "load",
    "nearest_jam",
    "place",
    "plan",
    "read_cage",
    "regrasp",
    "sublevels",
]


def __getattr__(name: str) -> Any:
    if name not in _WHERE:
        raise AttributeError(f"icage has no {name!r}; it has {', '.join(__all__)}")
    return getattr(import_module(_WHERE[name]), name)


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
