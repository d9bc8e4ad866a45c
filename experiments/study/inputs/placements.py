"""Where the hand really stands: where it is meant to, and how far off.

The intended placement is the nominal one, or drawn from a set of the cage. Placement errors move
the hand in the object's frame: its middle by (x, y), a turn about that middle, a change of its
opening. A sensor's bias is an error of the object's pose: the hand goes where it would be right for
the object as seen, so it turns about the object's centroid.
"""

from __future__ import annotations

import threading
from collections.abc import Generator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Final

import numpy as np

from experiments.study.inputs.config import ConfigError, StudyConfig
from experiments.study.inputs.variables import fields_of
from icage.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from icage.cage import Cage
from icage.kernels.locate import depth_inside
from icage.outline import Outline
from icage.placing.best import place
from icage.sampling import Box, SamplingError, StartSet, draw_starts, draw_starts_of_each

BLOCK: Final = 250
"""[placement] Drawn together; a start depends on the seed and its number, not on the shard."""

_TOGETHER, _KEPT = 16, 64
"""[block] Drawn at a time, which takes 1.4 MB each; and kept."""

_STREAM, _NOMINAL = 12, 13
"""Of the random numbers of starts."""

_ROOMY: Final = 1000
"""Placements of the guaranteed set among which the nominal one is looked for."""


@dataclass(frozen=True, slots=True)
class HandError:
    """How far off its place the hand stands, (n,) each: lengths in the case's unit, [rad]."""

    x: FloatArray
    y: FloatArray
    theta: FloatArray
    sigma: FloatArray


@dataclass(frozen=True, slots=True)
class SeenError:
    """How far off the sensor sees the object, (n,) each: lengths in the case's unit, [rad]."""

    x: FloatArray
    y: FloatArray
    theta: FloatArray


class Intended:
    """Intended placements of a study, by number; safe to ask from several threads."""

    def __init__(self, config: StudyConfig, cage: Cage) -> None:
        self._config, self._cage = config, cage
        self._lock = threading.Lock()
        self._blocks: dict[tuple[int, int], FloatArray] = {}
        self._box: Box | None = None
        self.nominal: FloatArray | None = None
        if config.starts == "nominal":
            self.nominal = _nominal(config, cage)

    def placements(self, numbers: IntArray, streams: IntArray) -> FloatArray:
        """Placements (n, 4) with these numbers in these streams.

        Raises
        ------
        ConfigError:
            The set is too small to be drawn from.
        """
        if self.nominal is not None:
            return np.tile(self.nominal, (len(numbers), 1))
        rows = np.empty((len(numbers), 4))
        blocks = numbers // BLOCK
        with self._lock:
            keys = sorted(set(zip(streams.tolist(), blocks.tolist(), strict=True)))
            for first in range(0, len(keys), _TOGETHER):
                for (stream, block), drawn in self._drawn(keys[first : first + _TOGETHER]):
                    here = np.flatnonzero((streams == stream) & (blocks == block))
                    rows[here] = drawn[numbers[here] % BLOCK]
        return rows

    def _drawn(self, keys: list[tuple[int, int]]) -> list[tuple[tuple[int, int], FloatArray]]:
        """The blocks of some streams, a key each."""
        which: StartSet = "cage" if self._config.starts == "cage" else "guaranteed"
        if self._box is None:
            with _too_small():
                self._box = Box.around(self._cage, which)
        new = [key for key in keys if key not in self._blocks]
        rngs = [np.random.default_rng([self._config.seed, _STREAM, *key]) for key in new]
        with _too_small():
            drawn = draw_starts_of_each(self._cage, which, BLOCK, rngs, box=self._box)
        self._blocks.update(zip(new, (starts.placements for starts in drawn), strict=True))
        found = [(key, self._blocks[key]) for key in keys]
        while len(self._blocks) > _KEPT:  # shards come in order: the oldest is not asked again
            del self._blocks[next(iter(self._blocks))]
        return found


def _nominal(config: StudyConfig, cage: Cage) -> FloatArray:
    """The placement (4,) that is meant."""
    if config.nominal is not None:
        return np.array(config.nominal)
    if config.place is not None:
        return place(cage, opening_error=True).placement.as_array()
    return roomiest(cage, config.seed)


def roomiest(cage: Cage, seed: int) -> FloatArray:
    """The placement (4,) with the most room among ``_ROOMY`` from the guaranteed set.

    Room is the smaller of the discs' distance from the object and of how much wider the hand may
    open before it leaves the guaranteed set.
    """
    rng = np.random.default_rng([seed, _NOMINAL])
    with _too_small():
        rows = draw_starts(cage, "guaranteed", _ROOMY, rng).placements
    fingers = cage.hand.fingers(rows).reshape(-1, 2)
    depth = depth_inside(cage.outline.vertices, fingers, cage.finger_radius).reshape(-1, 3)
    first = np.inf if cage.sigma_guaranteed is None else cage.sigma_guaranteed
    room = np.minimum(-depth.max(axis=1), first - rows[:, 3])
    return np.array(rows[int(np.argmax(room))])


@contextmanager
def _too_small() -> Generator[None]:
    """That a set is empty or too small is no fault of ours."""
    try:
        yield
    except SamplingError as error:
        raise ConfigError(
            f"starts: {error}; a nominal placement of your own (nominal = [x, y, theta, sigma]) or "
            "another grasp is needed"
        ) from error


def moved(
    intended: FloatArray,
    values: Mapping[str, FloatArray],
    cage: Cage,
    middles: ComplexArray,
) -> FloatArray:
    """True placements (n, 4) of the hand in the object's frame. Sigma may come out negative.

    ``values`` are those of all inputs, ``middles`` those of the true unit hands, (n,)
    each: a hand of another shape stands with its middle where the planned one's should be.
    """
    hand, seen = HandError(**fields_of("hand", values)), SeenError(**fields_of("seen", values))
    x, y, theta, sigma = intended.T
    middle = complex(cage.hand.z.mean())
    at = x + 1j * y + sigma * np.exp(1j * theta) * middle
    at = at + hand.x + 1j * hand.y
    theta = theta + hand.theta
    sigma = sigma + hand.sigma
    d = at - sigma * np.exp(1j * theta) * middles
    turn = np.exp(1j * seen.theta)
    centre = complex(*cage.outline.centroid.tolist())
    d = centre + turn * (d - centre) + seen.x + 1j * seen.y
    return np.column_stack([d.real, d.imag, theta + seen.theta, sigma])


def collide(outline: Outline, fingers: FloatArray, radius: float, tolerance: float) -> BoolArray:
    """(n,) which hands (n, k, 2) reach deeper than ``tolerance`` [diameter] into the outline."""
    depth = depth_inside(outline.vertices, fingers.reshape(-1, 2), radius)
    deepest = depth.reshape(fingers.shape[:2]).max(axis=1)
    return np.asarray(deepest > tolerance * outline.diameter)
