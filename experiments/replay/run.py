"""The main job: plan a cage, draw placements from it, close the hand from each, see where it ends.

A *run* is one set of placements of one grasp: the guaranteed set, from which every closing must
end in the target, or the rest of the cage, from which none may escape and every one must end in a
grasp that the planner knows.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any, Final, Literal

import numpy as np

from icage.agreement import disagreements
from icage.cage import Cage, CageStatus, Puncture
from icage.case import Case
from icage.contact_space.method import CONTACT_SPACE
from icage.errors import InputError
from icage.kernels.compiled import machine_code_at_once
from icage.planner import plan
from icage.sampling import SamplingError, Starts, StartSet, has_rest, safe_level
from sim.closing.judge import OUTCOMES, Verdicts
from sim.closing.outcome import ClosingOutcomes
from sim.closing.push import compile_steps
from sim.closing.replay import check_closable, replay_set
from sim.world.config import SimConfig
from sim.world.scene import Scene

DEEPEST_MOVING: Final = 1e-3
"""[diameter] A finger deeper than this inside the object while closing is no contact any more."""

DEEPEST_AT_REST: Final = 1e-5
"""[diameter] ... and at rest."""

SHAPE_ERROR: Final = 1e-5
"""[diameter] The fingers stay on similar triangles to this."""

SIGMA_RISE: Final = 1e-9
"""[1] The hand only closes: sigma never above its start, but for rounding."""

Report = Callable[[str, int, int], None]
"""Progress: (stage, done, total)."""


@dataclass(frozen=True, slots=True)
class Run:
    """One set of placements of one grasp, closed and judged."""

    case: Case
    cage: Cage
    second: Cage
    """The cage by the paper's method, for comparison and for the course of its search."""
    scene: Scene
    which: StartSet | Literal["outside"]
    starts: Starts
    closings: ClosingOutcomes
    verdicts: Verdicts

    @property
    def counts(self) -> dict[str, int]:
        """Trials per outcome, every outcome named."""
        return self.verdicts.counts()

    @property
    def title(self) -> str:
        """Grasp and set, to name the run in a sentence."""
        return f"{self.case.name}, {self.which} set"


@dataclass(frozen=True, slots=True)
class Replay:
    """All runs of one object; ``skipped`` says in words which set could not be drawn from."""

    runs: tuple[Run, ...]
    seed: int
    skipped: tuple[str, ...] = field(default=())

    @property
    def failures(self) -> tuple[str, ...]:
        """What did not hold, a plain sentence each; empty if everything did."""
        return tuple(sentence for run in self.runs for sentence in run_failures(run))


def check_discs(cases: Sequence[Case]) -> None:
    """Refuse point fingers.

    Raises
    ------
    InputError:
        A case has them.
    """
    for case in cases:
        if not case.finger_radius > 0.0:
            how = (
                "give --finger-radius R"
                if case.target is None
                else "give its outline alone, or its drawing, with --finger-radius R"
            )
            raise InputError(
                f"{case.name}: finger_radius is 0; a simulated hand needs fingers of some radius "
                f"({how})"
            )


def replay(cases: Sequence[Case], trials: int, seed: int, threads: int, report: Report) -> Replay:
    """Plan, draw, close and judge every grasp: the guaranteed set, and the rest where there is any.

    The same for any number of threads; a run depends on the seed, on its place among the grasps
    and on nothing else.

    Raises
    ------
    InputError:
        A case has point fingers, or is not a cage.
    SamplingError:
        A guaranteed set is too small to be drawn from.
    """
    check_discs(cases)
    runs: list[Run] = []
    skipped: list[str] = []
    # the paper's method and the closing's steps first: on a bare machine they are compiled here,
    # while another process compiles what comes next
    machine_code_at_once()
    seconds: list[Cage] = []
    for number, case in enumerate(cases):
        report("contact space", number, len(cases))
        seconds.append(plan(case, method=CONTACT_SPACE))
    report("contact space", len(cases), len(cases))
    if seconds[0].status != CageStatus.NOT_A_CAGE:
        first = cases[0]
        compile_steps(Scene(first.outline, seconds[0].hand, first.finger_radius, SimConfig()))
    for number, (case, second) in enumerate(zip(cases, seconds, strict=True)):
        report("planning", number, len(cases))
        cage = plan(case)
        check_closable(cage, case.name)
        scene = Scene(case.outline, cage.hand, case.finger_radius, SimConfig())
        for which in _sets(cage):
            rng = np.random.default_rng([seed, number, 0 if which == "guaranteed" else 1])
            bars = [_Bar(report, f"{what} {case.name} {which}", trials) for what in _STAGES]
            try:
                done = replay_set(cage, scene, which, trials, rng, threads, *bars)
            except SamplingError as error:
                if which == "guaranteed":
                    raise
                skipped.append(f"{case.name}: {error}")
                continue
            found = done.starts, done.closings, done.verdicts
            runs.append(Run(case, cage, second, scene, which, *found))
    report("planning", len(cases), len(cases))
    return Replay(tuple(runs), seed, tuple(skipped))


_STAGES: Final = ("placements", "closing")


def _sets(cage: Cage) -> Iterator[StartSet]:
    yield "guaranteed"
    if has_rest(cage):
        yield "rest"


class _Bar:
    """Turns "so many more" into "so many of all" for a progress bar."""

    def __init__(self, report: Report, stage: str, total: int) -> None:
        self._report, self._stage, self._total, self._done = report, stage, total, 0

    def __call__(self, more: int) -> None:
        self._done += more
        self._report(self._stage, self._done, self._total)


def run_failures(run: Run) -> Iterator[str]:
    """What did not hold in a run. Nothing is forgiven here: the limits are those promised."""
    for line in disagreements(run.cage, run.second):
        yield f"{run.title}: cells and contact space disagree, {line}"
    counts, trials = run.counts, len(run.closings)
    wanted = ("target",) if run.which == "guaranteed" else ("target", "other_grasp")
    missed = {name: k for name, k in counts.items() if k and name not in wanted}
    if missed and run.which != "outside":
        what = ", ".join(f"{k} {name.replace('_', ' ')}" for name, k in missed.items())
        goal = "the target grasp" if run.which == "guaranteed" else "a grasp that was planned"
        yield f"{run.title}: {sum(missed.values())} of {trials} did not end in {goal} ({what})"
    limits = (
        ("penetration while closing", run.closings.penetration_max, DEEPEST_MOVING),
        ("penetration at rest", _at_rest(run), DEEPEST_AT_REST),
        ("shape error", run.closings.shape_error_max, SHAPE_ERROR),
        ("rise of sigma above its start", run.closings.sigma_rise_max - 1.0, SIGMA_RISE),
    )
    for name, values, limit in limits:
        over = int((~(values <= limit)).sum())
        if over:
            yield f"{run.title}: {name} up to {np.max(values):.2g} in {over} trials, over {limit:g}"


def _at_rest(run: Run) -> np.ndarray:
    """Penetrations of those that came to rest."""
    ended = np.isin(run.verdicts.outcome, [OUTCOMES.index(name) for name in _RESTING])
    return run.closings.penetration_rest[ended]


_RESTING: Final = ("target", "other_grasp", "jammed", "unmatched")


def run_document(run: Run, plan_document: dict[str, Any]) -> dict[str, Any]:
    """A run as in ``icage-replay/1``. Lengths in ``unit``; errors over trials in the target."""
    size = run.case.outline.diameter
    reached = run.verdicts.outcome == OUTCOMES.index("target")
    sigma = run.starts.placements[:, 3]
    level = run.cage.sigma_guaranteed if run.which == "guaranteed" else run.cage.sigma_max
    limit = safe_level(None if run.which == "outside" else level, run.cage.sigma_0)
    return {
        "grasp": run.case.name,
        "set": run.which,
        "plan": plan_document,
        "contact_space": _second_document(run),
        "unit": run.case.unit,
        "outline": {"vertices": run.case.outline.vertices},
        "config": asdict(run.scene.config),
        "diameter": size,
        "trials": len(run.closings),
        **run.counts,
        "position_error_max": _largest(run.verdicts.position_error[reached] * size),
        "angle_error_max_deg": _largest(np.degrees(run.verdicts.angle_error[reached])),
        "penetration_max": _largest(run.closings.penetration_max * size),
        "penetration_rest_max": _largest(_at_rest(run) * size),
        "shape_error_max": _largest(run.closings.shape_error_max * size),
        "time_step": run.scene.config.time_step,
        "sigma_range": [float(sigma.min()), float(sigma.max())],
        "sigma_limit": None if np.isinf(limit) else limit,
        "acceptance_rate": run.starts.acceptance_rate,
        "steps_mean": float(run.closings.steps.mean()),
        "failures": list(run_failures(run)),
    }


def _second_document(run: Run) -> dict[str, Any]:
    """What the paper reports of its own search: tunnel edges, kind of the escape puncture."""
    log, escape = run.second.search, escape_puncture(run.second)
    return {
        "sigma_first": run.second.sigma_first,
        "sigma_max": run.second.sigma_max,
        "rectangles_explored": None if log is None else log.rectangles_explored,
        "tunnel_edges_tried": None if log is None else log.tunnel_edges_tried,
        "tunnel_edges_used": None if log is None else log.tunnel_edges_used,
        "escape_puncture_fingers": None
        if escape is None
        else [k for k in (1, 2, 3) if k not in escape.free_fingers],
    }


def escape_puncture(cage: Cage) -> Puncture | None:
    """The puncture through which the object escapes, if it can."""
    return next((p for p in cage.punctures if p.kind == "escape"), None)


def _largest(values: np.ndarray) -> float | None:
    """The largest finite number, None if there is none (JSON knows no NaN)."""
    finite = values[np.isfinite(values)]
    return float(finite.max()) if len(finite) else None
