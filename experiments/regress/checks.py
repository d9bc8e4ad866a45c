"""What must hold for every case, whatever was committed: nothing is forgiven, nothing is tuned."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from experiments.regress.closings import Closed
from experiments.regress.measure import Row
from experiments.replay.run import DEEPEST_MOVING

SECOND_DEEPEST: Final = 1e-2
"""[diameter] The second engine lets wedged fingers sink in; deeper than this says nothing."""


def checks(row: Row) -> tuple[str, ...]:
    """What did not hold, a plain sentence each."""
    return tuple(_checks(row))


def _checks(row: Row) -> Iterator[str]:
    for line in row.planned.differences:
        yield f"the two methods disagree: {line}"
    if row.physical_plan is not None and row.physical_plan is not row.planned:
        for line in row.physical_plan.differences:
            yield f"the two methods disagree on the derived case: {line}"
    for closed in row.closed:
        yield from _closings(closed, "", row.seed)
    for ends in row.rubbed:
        where = f"friction {ends.mu:g}, below sigma_first(mu)"
        if ends.lost:
            kept = int(ends.kept.sum())
            yield f"{where}: {kept - ends.lost} of {kept} ended in the target"
        if ends.penetration > DEEPEST_MOVING:
            yield f"{where}: a finger sank {ends.penetration:.2g} diameters in"
    if row.escape is not None:
        yield from (sentence.split(": ", 1)[-1] for sentence in row.escape.failures)
    if row.shake_error is not None:
        yield f"shake: {row.shake_error}"
    if row.shaken is not None:
        yield from (f"shake: {sentence}" for sentence in row.shaken.failures)
    if row.second is not None:
        for closed in row.second.closed:
            yield from _closings(closed, "second engine: ", row.seed)
        attacks = row.second.attacks
        if attacks is not None and (attacks.escapes or attacks.diverged):
            yield (
                f"second engine: random attacks: {attacks.escapes} of {len(attacks)} escaped below "
                f"sigma_max, {attacks.diverged} diverged"
            )


def _closings(closed: Closed, engine: str, seed: int) -> Iterator[str]:
    which, counts = closed.run.which, closed.run.counts
    name = f"{engine}{which}"
    if which == "guaranteed" and counts["target"] < closed.trials:
        where = ", ".join(f"{k} {w.replace('_', ' ')}" for w, k in counts.items() if k)
        yield f"{name}: {counts['target']} of {closed.trials} ended in the target ({where})"
    wanted = counts["target"] + counts["other_grasp"]
    if which == "rest" and wanted < closed.trials:
        where = ", ".join(f"{k} {w.replace('_', ' ')}" for w, k in counts.items() if k)
        yield f"{name}: {wanted} of {closed.trials} ended in a grasp of the plan ({where})"
    if closed.misnamed:
        yield f"{name}: {closed.misnamed} ended in a grasp that the query had not named"
    if closed.let_go:
        yield f"{name}: {closed.let_go} let go of an object that the query had called caged"
    if counts["diverged"]:
        yield f"{name}: {counts['diverged']} diverged (seed {seed})"
    if closed.penetration > (SECOND_DEEPEST if engine else DEEPEST_MOVING):
        yield f"{name}: a finger sank {closed.penetration:.2g} diameters in"
