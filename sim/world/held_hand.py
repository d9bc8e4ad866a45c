"""A hand that is held: it may close, but a stop keeps it from opening beyond a given c.

The stop is the limit of the drive tendon, sigma <= c, as stiff as the linkage. It is a number of
the model, and a batch gives every trial its own. The motor may push against it, which holds the
hand at c, or pull away from it. [issue 4: sigma_max is about openings up to c]
"""

from __future__ import annotations

from typing import Any

import numpy as np

from icage.arrays import FloatArray
from icage.errors import InputError
from sim.world.engine import Batch, MjModel
from sim.world.scene import Scene

_FREE = -1e3
"""[diameter] Lower end of the tendon's range: never met."""


def held_model(scene: Scene) -> MjModel:
    """The scene compiled with a stop on the opening; the stop's place is ``tendon_range[0, 1]``."""
    spec = scene.spec(visuals=False)
    config = scene.config
    drive = spec.tendon("drive")
    drive.limited = 1
    drive.range = [_FREE, -_FREE]
    drive.solref_limit = [config.linkage_solref * config.time_step, 1.0]
    drive.solimp_limit = list(config.solimp)
    drive.margin = 0.0
    return spec.compile()


def held_batch(model: MjModel, qpos: FloatArray, openings: FloatArray, threads: int) -> Any:
    """A batch at rest at qpos (N, 6), trial i stopped at openings[i] [diameter].

    Raises
    ------
    InputError:
        An opening is not a positive number.
    """
    if not (np.isfinite(openings).all() and (openings > 0.0).all()):
        raise InputError("an opening to hold the hand at must be a finite number above 0")
    batch = Batch(model, nsim=len(qpos), nthread=threads)
    batch.expand("tendon_range")[:, 0, 1] = openings
    batch.qpos = qpos
    return batch
