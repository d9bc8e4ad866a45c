"""Placements drawn from a cage, the hand closed from each on the free object, every end named."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from icage.cage import Cage
from icage.checks import a_count, an_instance, one_of
from icage.errors import InputError
from icage.sampling import Starts, StartSet, draw_starts
from sim.closing.batch import close_many
from sim.closing.judge import Verdicts, judge
from sim.closing.outcome import ClosingOutcomes
from sim.world.config import SimConfig
from sim.world.scene import Scene

Progress = Callable[[int], None]
"""Called with how many more are done."""


@dataclass(frozen=True, slots=True)
class Replayed:
    """Closings from one set of placements of a cage, judged.

    Attributes
    ----------
    starts:
        (N, 4) placements and how many hands were tried for them.
    closings:
        What each closing left behind, N of each; see ``sim.closing.outcome``.
    verdicts:
        Outcome, grasp and errors of each, N of each; see ``sim.closing.judge``.
    """

    cage: Cage = field(repr=False)
    which: StartSet
    scene: Scene = field(repr=False)
    starts: Starts = field(repr=False)
    closings: ClosingOutcomes = field(repr=False)
    verdicts: Verdicts = field(repr=False)

    def __len__(self) -> int:
        return len(self.closings)

    @property
    def counts(self) -> dict[str, int]:
        """Trials per outcome, every outcome named."""
        return self.verdicts.counts()

    @property
    def in_target(self) -> int:
        """How many ended in the target grasp."""
        return self.counts["target"]

    def __repr__(self) -> str:
        found = ", ".join(f"{count} {name}" for name, count in self.counts.items() if count)
        return f"<Replayed {len(self)} trials, {self.which} set: {found}>"


def replay(
    cage: Cage,
    trials: int = 100,
    seed: int = 0,
    *,
    which: StartSet = "guaranteed",
    threads: int = 0,
    config: SimConfig | None = None,
) -> Replayed:
    """Draw placements from a set of a cage, close from each in MuJoCo, see where it ends. Our own.

    The same for any number of threads, and the same trials as ``icage replay`` makes of the first
    grasp with this seed.

    Parameters
    ----------
    cage:
        Planned by the cells, with disc fingers: a simulated finger needs some radius.
    trials:
        How many; at least 1.
    which:
        "guaranteed" (below sigma_first, where closing can end only in the target), "rest" (what the
        cage holds besides) or "cage" (both).
    threads:
        0 for one per core.
    config:
        Settings of the simulation; the usual ones if None.

    Raises
    ------
    InputError:
        An argument is not of its kind (``trials`` below 1, ``seed`` below 0), point fingers, or not
        a cage.
    SamplingError:
        The set is empty, or too small to be drawn from.

    Examples
    --------
    >>> import icage
    >>> cage = icage.plan(icage.load("pliers"))
    >>> replay(cage, trials=4, seed=0).counts["target"]
    4
    """
    an_instance(cage, Cage, "cage", "; icage.plan makes one")
    a_count(trials, "trials")
    a_count(seed, "seed", 0)
    a_count(threads, "threads", 0)
    one_of(which, ("guaranteed", "rest", "cage"), "which")
    if config is not None:
        an_instance(config, SimConfig, "config")
    check_closable(cage, cage.name or "this cage")
    rng = np.random.default_rng([seed, 0, 1 if which == "rest" else 0])
    scene = Scene(cage.outline, cage.hand, cage.finger_radius, config or SimConfig())
    return replay_set(cage, scene, which, trials, rng, threads)


def check_closable(cage: Cage, name: str) -> None:
    """Refuse what physics cannot close: point fingers, and contacts that hold nothing."""
    if not cage.finger_radius > 0.0:
        raise InputError(
            f"{name}: finger_radius is 0; a simulated hand needs fingers of some radius "
            "(icage.regrasp finds the same grasp for a radius)"
        )
    if cage.status == "not_a_cage":
        raise InputError(f"{name} is not a cage ({cage.why}): there is nothing to replay")


def replay_set(
    cage: Cage,
    scene: Scene,
    which: StartSet,
    trials: int,
    rng: np.random.Generator,
    threads: int = 0,
    drawing: Progress | None = None,
    closing: Progress | None = None,
) -> Replayed:
    """One set of a cage whose scene is compiled. Raises what ``draw_starts`` raises."""
    starts = draw_starts(cage, which, trials, rng, drawing)
    closings = close_many(scene, starts.placements, threads, closing)
    verdicts = judge(closings, cage.grasps, cage.outline)
    return Replayed(cage, which, scene, starts, closings, verdicts)
