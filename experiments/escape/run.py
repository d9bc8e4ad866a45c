"""Can the object be taken out of the cage? The plan's sigma_max attacked in physics, and measured.

Below sigma_max no attack may succeed; a little above it the plan's own way out must work. The
levels are at(S, -) = S - min(0.002 S, 0.1 (S - sigma_0)) and at(S, +) likewise above; with discs S
is the safe end of the planner's bracket below, its upper end above.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np

from experiments.cases.with_discs import PhysicalCase, physical_case
from experiments.escape.setup import AttackSetup
from icage.cage import Cage
from icage.case import Case
from icage.errors import InputError
from icage.planner import plan
from sim.attack.held import Attacks
from sim.attack.measured_sigma_max import AttackAt, Measured, measure

THINNEST: Final = 20.0
"""[penetration] A cage with less room above sigma_0 than this is no case for physics."""

NEAR: Final = 0.002
"""[1] at(S, -) and at(S, +) are this share of S away, and what guided attacks measure is within."""

SURE: Final = 0.95
"""[1] Share of guided attacks above sigma_max that must escape."""

ATTACKERS: Final = ("random", "guided", "rigid")
"""random and guided: the hand may close; rigid: it may not, and is searched without the plan."""

MOST_TREES: Final = 8
"""Tree searches a level: they take up to a second each, and a few are as good as many."""

MOST_REPEATS: Final = 12
"""Random attacks at one opening of a measurement."""

Verdict = Literal["ok", "failed", "too_thin_for_physics", "no_derived_case"]
Report = Callable[[str, int, int], None]


@dataclass(frozen=True, slots=True)
class AttackResult:
    """One attacker: its attacks below and above (None: there is no above), and its interval."""

    attacker: str
    below: Attacks
    above: Attacks | None = None
    measured: Measured | None = None


@dataclass(frozen=True, slots=True)
class Escape:
    """A case under attack; levels in its unit.

    Attributes
    ----------
    physical:
        What was attacked: the case, or what was derived from it.
    arena:
        None if nothing was attacked.
    below, above:
        The two levels; None where there is none.
    failures:
        What did not hold, a plain sentence each.
    """

    physical: PhysicalCase
    attacks: int
    seed: int
    verdict: Verdict = "ok"
    why: str | None = None
    setup: AttackSetup | None = None
    below: float | None = None
    above: float | None = None
    attackers: tuple[AttackResult, ...] = ()
    failures: tuple[str, ...] = ()

    @property
    def case(self) -> Case:
        """With discs."""
        return self.physical.case

    @property
    def cage(self) -> Cage:
        """Of ``case``."""
        return self.physical.cage

    @property
    def penetration_max(self) -> float:
        """[diameter] Deepest finger in the attacks at both levels."""
        runs = [run for a in self.attackers for run in (a.below, a.above) if run is not None]
        return max((float(run.penetration_max.max()) for run in runs), default=0.0)


def at(level: float, sigma_0: float, sign: int) -> float:
    """S -+ min(0.002 S, 0.1 (S - sigma_0)).

    >>> at(2.0, 1.0, -1), round(at(1.01, 1.0, 1), 6)
    (1.996, 1.011)
    """
    return level + sign * min(NEAR * level, 0.1 * (level - sigma_0))


def escape(case: Case, attacks: int, seed: int, threads: int, report: Report) -> Escape:
    """Plan one case, derive discs for point fingers, attack and measure with every attacker.

    The same for any number of threads: every attack has random numbers of its own.
    """
    report("planning", 0, 1)
    cage = plan(case.outline, case.contacts, case.finger_radius)
    if cage.status == "not_a_cage":
        why = f"not_a_cage ({cage.why}): nothing to attack"
        return Escape(PhysicalCase.of(case, cage), attacks, seed, why=why)
    try:
        physical = physical_case(case, cage=cage)
    except InputError as error:
        blank = Escape(PhysicalCase.of(case, cage), attacks, seed)
        return replace(blank, verdict="no_derived_case", why=str(error))
    report("planning", 1, 1)
    return attacked(physical, attacks, seed, threads, report)


def attacked(
    physical: PhysicalCase,
    attacks: int,
    seed: int,
    threads: int,
    report: Report,
    measuring: Sequence[str] = ATTACKERS,
) -> Escape:
    """All attacks on a planned case; those in ``measuring`` also measure sigma_max."""
    rng = np.random.default_rng([seed, 4])
    return judged(_attacked(Escape(physical, attacks, seed), rng, threads, report, measuring))


def _attacked(
    blank: Escape,
    rng: np.random.Generator,
    threads: int,
    report: Report,
    measuring: Sequence[str],
) -> Escape:
    case, cage, attacks = blank.case, blank.cage, blank.attacks
    unit = case.outline.diameter
    streams = rng.spawn(9)
    if cage.sigma_max is None:
        below = cage.sigma_largest or cage.sigma_0
        setup = AttackSetup.of(blank.physical, below, threads)
        report("attacks", 0, 1)
        only = AttackResult("random", setup.random(np.full(attacks, below / unit), streams[0]))
        report("attacks", 1, 1)
        return replace(blank, setup=setup, below=below, attackers=(only,))
    upper = cage.sigma_max_upper or cage.sigma_max
    levels = at(cage.sigma_max, cage.sigma_0, -1), at(upper, cage.sigma_0, 1)
    setup = AttackSetup.of(blank.physical, levels[0], threads)
    room = min(0.05 * upper, 0.5 * (upper - cage.sigma_0))
    window = ((cage.sigma_max - room) / unit, (upper + room) / unit)

    def of_attacker(
        name: str, attack_at: AttackAt, number: int, rounds: int, repeats: int
    ) -> AttackResult:
        first = 3 * ATTACKERS.index(name)
        report("attacks", first, 9)
        below = attack_at(np.full(number, levels[0] / unit), streams[first])
        if name == "random" and name not in measuring:
            return AttackResult(
                name, below
            )  # above it proves nothing: it may or may not find the way
        report("attacks", first + 1, 9)
        above = attack_at(np.full(number, levels[1] / unit), streams[first + 1])
        if name not in measuring:
            return AttackResult(name, below, above)
        report("attacks", first + 2, 9)
        found = measure(
            attack_at, window, streams[first + 2], rounds=rounds, sections=4, repeats=repeats,
            known=(below, above),
        )  # fmt: skip
        return AttackResult(name, below, above, found)

    random = of_attacker(
        "random", setup.random, attacks, 2, min(max(4, attacks // 4), MOST_REPEATS)
    )
    attackers = [random, of_attacker("guided", setup.guided, attacks, 4, 3)]
    rigid = setup.rigid(random.below)
    if rigid is not None:
        attackers.append(of_attacker("rigid", rigid, min(attacks, MOST_TREES), 4, 2))
    report("attacks", 9, 9)
    return replace(
        blank, setup=setup, below=levels[0], above=levels[1], attackers=tuple(attackers)
    )  # fmt: skip


def judged(result: Escape) -> Escape:
    """The verdict on attacks that were made."""
    unit, sigma_0 = result.case.outline.diameter, result.cage.sigma_0
    if result.cage.sigma_max is not None:
        room = (result.cage.sigma_max - sigma_0) / unit
        if room < THINNEST * result.penetration_max:
            why = (
                f"sigma_max - sigma_0 is {room:.2g} diameters, under {THINNEST:g} times the "
                f"penetration of {result.penetration_max:.2g}"
            )
            return replace(result, verdict="too_thin_for_physics", why=why)
    failures = tuple(sentence for a in result.attackers for sentence in _failures(result, a))
    return replace(result, failures=failures, verdict="failed" if failures else "ok")


def _failures(result: Escape, of_attacker: AttackResult) -> Iterator[str]:
    """What did not hold. Nothing is forgiven: the limits are those promised."""
    name = f"{result.case.name}: {of_attacker.attacker} attacks"
    for run in (of_attacker.below, of_attacker.above):
        if run is not None and run.diverged:
            yield f"{name}: {run.diverged} of {len(run)} diverged (seed {result.seed})"
    if of_attacker.below.escapes:
        count = len(of_attacker.below)
        yield f"{name}: {of_attacker.below.escapes} of {count} escaped below sigma_max"
    if of_attacker.attacker == "guided" and of_attacker.above is not None:
        out, tried = of_attacker.above.escapes, len(of_attacker.above)
        if out < SURE * tried:
            yield f"{name}: only {out} of {tried} escaped above sigma_max along the plan's way out"
    top, found, unit = result.cage.sigma_max, of_attacker.measured, result.case.outline.diameter
    if found is None or top is None:
        return
    low, high = at(top, result.cage.sigma_0, -1), result.above or math.inf
    if found.high * unit < low:
        yield f"{name} measure a sigma_max of at most {found.high * unit:.6g}; planned {top:.6g}"
    if of_attacker.attacker == "guided" and found.low * unit > high:
        yield f"{name} measure a sigma_max of at least {found.low * unit:.6g}; planned {top:.6g}"
