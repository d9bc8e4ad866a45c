"""What a film is of: a case with discs, its cage, what the regions are, and how long it takes."""

from __future__ import annotations

from dataclasses import dataclass, field

from experiments.cases.with_discs import PhysicalCase, physical_case
from experiments.figures.plan import figure_regions
from icage.cage import Cage
from icage.case import Case
from icage.cells.regions import FingerRegion
from sim.world.scene import Scene


@dataclass(frozen=True, slots=True, eq=False)
class Subject:
    """A cage to be filmed.

    Attributes
    ----------
    regions:
        Caging regions from inside, those at sigma_first last, where there are such.
    scene:
        Hand and object in the engine, closed nowhere yet.
    seed, frames:
        Of everything drawn at random; of the whole film.
    camera:
        Whether MuJoCo's camera draws what the engine does; else it is drawn in two dimensions.
    """

    physical: PhysicalCase
    regions: tuple[FingerRegion, ...]
    seed: int
    frames: int
    camera: bool
    scene: Scene = field(repr=False)

    @classmethod
    def of(cls, case: Case, seed: int, frames: int, camera: bool) -> Subject:
        """A case with a grasp; point fingers become discs.

        Raises
        ------
        InputError:
            The case is not a cage, or no disc fits.
        """
        physical = physical_case(case)
        inner = tuple(r for r in figure_regions(physical.cage) if r.bound == "inner")
        return cls(physical, inner, seed, frames, camera, physical.simulated.scene())

    @property
    def cage(self) -> Cage:
        """Planned for the discs."""
        return self.physical.cage

    @property
    def name(self) -> str:
        """Of the case."""
        return self.physical.case.name

    @property
    def unit(self) -> str:
        """Of the case."""
        return self.physical.case.unit

    @property
    def about_fingers(self) -> str:
        """Whether the discs are the case's own, and how large they are."""
        radius = self.physical.case.finger_radius
        words = f"fingers of radius {radius:.3g} {self.unit}"
        return f"{words} for points" if self.physical.derived else words
