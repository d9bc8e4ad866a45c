"""The world of every trial, from its inputs: the simulation's own fields, and the table's slope."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from experiments.study.inputs.variables import VARIABLES, fields_of
from icage.arrays import BoolArray, FloatArray
from sim.closing.varied import Worlds


@dataclass(frozen=True, slots=True)
class Slope:
    """How the table lies under the object, (n,) each.

    Attributes
    ----------
    tilt:
        [rad] Of the table.
    direction:
        [rad] Of downhill, from the object's x axis at the start.
    weight:
        [closing force] Of an object of the usual mass.
    """

    tilt: FloatArray
    direction: FloatArray
    weight: FloatArray

    @property
    def pulls(self) -> BoolArray:
        """(n,) whether it draws the object anywhere."""
        return (self.tilt > 0.0) & (self.weight > 0.0)

    def gravity(self, theta: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Gravity, x and y, in the axes of a palm turned by ``theta`` (n,) from the object's."""
        pull = self.weight * np.sin(self.tilt)
        direction = self.direction - theta
        return pull * np.cos(direction), pull * np.sin(direction)


def slope_of(values: Mapping[str, FloatArray]) -> Slope:
    """The table of trials (n) with these inputs."""
    return Slope(**fields_of("slope", values))


def worlds_of(values: Mapping[str, FloatArray], starts: FloatArray, sizes: FloatArray) -> Worlds:
    """Worlds (n) of true objects with diameters ``sizes`` (n,), the engine's unit of length.

    The table's slope is told in the object's axes at the start, the engine's gravity in the
    palm's. Weight goes with the mass.
    """
    scaled = {
        name: values[name] / sizes if one.measure == "length" else values[name]
        for name, one in VARIABLES.items()
    }
    gravity_x, gravity_y = slope_of(values).gravity(starts[:, 2])
    return Worlds(gravity_x=gravity_x, gravity_y=gravity_y, **fields_of("world", scaled))
