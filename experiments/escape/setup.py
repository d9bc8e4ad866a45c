"""Where a cage is attacked: scene, held hand, starts and the plan's way out, for any opening."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from experiments.cases.with_discs import PhysicalCase
from icage.arrays import FloatArray
from sim.attack.guided import GuidedDriver, object_path
from sim.attack.held import HELD, Attacks, attack
from sim.attack.measured_sigma_max import AttackAt
from sim.attack.random import RandomDriver
from sim.attack.rigid_search import clear_poses, search_many
from sim.world.engine import MjModel
from sim.world.held_hand import held_model
from sim.world.scene import Scene


@dataclass(frozen=True, slots=True)
class AttackSetup:
    """Everything that the attacks on one cage share.

    Attributes
    ----------
    target, door:
        (6,) positions: the target, and where the plan's way out is as wide as the level below.
    path:
        (p, 5) way points of ``object_path``; None for a cage without escape.
    threads:
        0 for one per core; results are the same for any number.
    """

    scene: Scene
    model: MjModel
    target: FloatArray
    at_pass: FloatArray
    path: FloatArray | None
    threads: int

    @classmethod
    def of(cls, physical: PhysicalCase, below: float, threads: int) -> AttackSetup:
        """The arena of a cage; ``below`` [unit] is the level below sigma_max."""
        cage, scene = physical.cage, physical.simulated.scene()
        target = scene.start_positions(cage.target_placement.as_array())[0]
        if cage.escape_path is None:
            return cls(scene, held_model(scene), target, target, None, threads)
        path = object_path(scene, cage.escape_path)
        wide = path[:, 3] >= min(below / scene.object.diameter, float(path[:, 3].max()))
        way = path[max(int(wide.argmax()) - 1, 0)]
        at_pass = np.concatenate([way[3] * scene.kinematics.lengths, way[:3]])
        return cls(scene, held_model(scene), target, at_pass, path, threads)

    def random(self, openings: FloatArray, rng: np.random.Generator) -> Attacks:
        """Random attacks at openings (N,) [diameter]: from the target and from the door in turn."""
        starts = np.where(np.arange(len(openings))[:, None] % 2 == 0, self.target, self.at_pass)
        starts[self.scene.sigma(starts) > openings] = self.target
        driver = RandomDriver(self.scene, openings, rng)
        return attack(self.scene, self.model, starts, openings, driver, self.threads)

    def guided(self, openings: FloatArray, rng: np.random.Generator) -> Attacks:
        """Attacks along the plan's way out at openings (N,) [diameter], from the target."""
        path = np.zeros((0, 5)) if self.path is None else self.path
        driver = GuidedDriver(self.scene, openings, path, rng)
        starts = np.repeat(self.target[None, :], len(openings), axis=0)
        return attack(self.scene, self.model, starts, openings, driver, self.threads)

    def rigid(self, held: Attacks) -> AttackAt | None:
        """Tree searches with a rigid hand, from where random attacks left the object.

        Only from ends of attacks that began at the target and below sigma_max: nothing of the
        plan's way out is used. None if no end is clear of a hand that is held there.
        """
        inside = held.end[::2][held.ending[::2] == HELD]
        if not len(clear_poses(self.scene, inside, float(held.openings[0]))):
            return None
        return lambda openings, rng: search_many(self.scene, inside, openings, rng)
