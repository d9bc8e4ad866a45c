"""What was found, as the document ``icage-jams/1`` and as a page."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from typing import Any, Final

import numpy as np

from experiments.io.intervals import rate_upper, wilson
from experiments.io.versions import versions
from experiments.jams.beside import Attacked, JamTested
from experiments.jams.closings import Ends
from experiments.jams.run import Judged
from experiments.jams.settings import Changed
from icage.arrays import FloatArray
from icage.friction.levels import FrictionLevel
from sim.grip.stick import RUBBING

FORMAT: Final = "icage-jams/1"


def jams_document(
    rows: Sequence[Judged], changed: Sequence[Changed], skipped: Sequence[tuple[str, str]]
) -> dict[str, Any]:
    """Levels over sigma_0, lengths in diameters, angles in [rad], forces in drive forces."""
    return {
        "format": FORMAT,
        "versions": versions(),
        "config": asdict(RUBBING),
        "cases": [_case(row) for row in rows],
        "settings": [_changed(one) for one in changed],
        "skipped": [{"case": name, "why": why} for name, why in skipped],
        "failures": [sentence for row in rows for sentence in row.failures],
    }


def _case(row: Judged) -> dict[str, Any]:
    cage, case = row.physical.cage, row.physical.case
    return {
        "case": row.name,
        "origin": row.physical.origin,
        "finger_radius": case.finger_radius / case.outline.diameter,
        "seed": row.seed,
        "sigma_first": None if cage.sigma_first is None else cage.sigma_first / cage.sigma_0,
        "levels": [
            {
                "mu": one.mu,
                "sigma_first": None if one.sigma_first is None else one.sigma_first / cage.sigma_0,
                "fingers": None if one.jam is None else one.jam.fingers,
                "ends": _foretold(one),
            }
            for one in row.levels
        ],
        "closings": [ends_document(ends) for ends in row.ends],
        "jams": [_jam(row, jam) for jam in row.jams],
        "untested_jams": row.untested,
    }


def _foretold(level: FrictionLevel) -> dict[str, float] | None:
    """How far from the target closings may stop, in diameters and radians."""
    ends = level.ends
    return None if ends is None else {"position": ends.position_max, "angle": ends.angle_max}


def ends_document(ends: Ends) -> dict[str, Any]:
    """Closings from one side of a level in numbers."""
    beyond = ends.residual[~np.isnan(ends.residual)]
    there = ends.in_target & ends.kept
    kept = int(ends.kept.sum())
    return {
        "side": ends.side,
        "mu": ends.mu,
        "trials": kept,
        "near_level": len(ends) - kept,
        "near_level_in_target": int((ends.in_target & ends.near_level).sum()),
        "from_afar": int((ends.from_afar & ends.kept).sum()),
        "target": int(there.sum()),
        "target_rate": wilson(int(there.sum()), kept),
        "settled": int(ends.settled.sum()),
        "repeated": ends.repeated,
        "sunk": int(ends.sunk.sum()),
        "stray": int(ends.stray.sum()),
        "residual": float(beyond.max(initial=0.0)),
        "to_nearest_jam": _largest(ends.to_jam),
        "position_error": float(ends.position[there].max(initial=0.0)),
        "angle_error": float(ends.angle[there].max(initial=0.0)),
        "penetration": ends.penetration,
    }


def _largest(values: FloatArray) -> float | None:
    known = values[~np.isnan(values)]
    return float(known.max()) if len(known) and np.isfinite(known).all() else None


def _jam(row: Judged, tested: JamTested) -> dict[str, Any]:
    found = tested.measured
    return {
        "fingers": tested.jam.fingers,
        "sigma": tested.jam.sigma / row.physical.cage.sigma_0,
        "contacts": tested.jam.contacts,
        "limits_at": tested.found_at,
        "touching": tested.touching,
        "foretold": tested.foretold,
        "slips_at": found.slips,
        "sticks_at": found.sticks if math.isfinite(found.sticks) else None,
        "released_at": tested.released if math.isfinite(tested.released) else None,
        "off": tested.off if math.isfinite(tested.off) else None,
        "penetration": found.penetration,
        "weaker": _attacked(tested.weaker),
        "stronger": _attacked(tested.stronger),
    }


def _attacked(run: Attacked) -> dict[str, Any]:
    return {
        "mu": run.mu,
        "trials": run.trials,
        "stuck": run.stuck,
        "stuck_rate": wilson(run.stuck, run.trials),
        "median_moved": run.moved[0],
        "largest_moved": run.moved[1],
        "stray": run.stray,
        "residual": run.residual,
        "penetration": run.penetration,
    }


def _changed(one: Changed) -> dict[str, Any]:
    ratios = [ratio for ratio in one.thresholds if math.isfinite(ratio)]
    return {
        "setting": one.name,
        "jams": len(one.thresholds),
        "threshold_ratio": [min(ratios, default=None), max(ratios, default=None)],
        "trials": one.trials,
        "same_side_of_the_tolerance": one.same,
        "stray": one.stray,
        "moved_95": one.shift,
        "penetration": one.penetration,
    }


def page(document: dict[str, Any], command: str) -> Iterator[str]:
    """The document as Markdown."""
    cases, config = document["cases"], document["config"]
    yield "# Physics as the judge of sigma_first(mu)"
    yield ""
    yield from _sums(document)
    yield ""
    yield (
        f"MuJoCo {document['versions']['mujoco']}, elliptic cones, time step "
        f"{config['time_step']:g} s, impratio {config['impratio']:g}, seed "
        f"{cases[0]['seed'] if cases else 0}. Lengths in object diameters, sigma in sigma_0."
    )
    yield ""
    yield "## Closings"
    yield ""
    yield (
        "below: ended within the tolerance of the target (0.005 diameters, 0.02 rad), of those "
        "that began below sigma_first(mu); thin: the same of those that fingers sinking in may "
        "have carried over it; afar: began outside that tolerance; above: ended in the "
        "target, of those that began above; stray: ended where no forces within the cones balance; "
        "residual: largest left over at an end outside the target, over the drive force; jam: how "
        "far three of those ends are from the nearest planned jam, at most."
    )
    yield ""
    head = "case", "mu", "sigma_first(mu)", "below", "thin", "afar", "above", "stray"
    yield f"| {' | '.join((*head, 'residual', 'jam', 'deepest'))} |"
    yield f"|{'---|' * 11}"
    for case in cases:
        for level in case["levels"]:
            runs = {r["side"]: r for r in case["closings"] if r["mu"] == level["mu"]}
            yield _closing_row(case["case"], level, runs)
    yield ""
    yield "## Jams"
    yield ""
    yield (
        "foretold: least mu at which the jam holds; put down: slips at the one, sticks at the "
        "other; let go: where it slips if it stuck with more; off: the least at which it held, "
        "against what was foretold; at 0.9, at 1.1: of hands that start beside it, opened, moved "
        "and turned a little, those that end beside it at so many times what is foretold; moved: "
        "how far the middle one of those ended from it."
    )
    yield ""
    head = "case", "sigma", "fingers (contacts)", "foretold", "put down", "let go", "off"
    yield f"| {' | '.join((*head, 'at 0.9', 'at 1.1', 'moved'))} |"
    yield f"|{'---|' * 10}"
    for case in cases:
        yield from (_jam_row(case["case"], jam) for jam in case["jams"])
    if document["settings"]:
        yield ""
        yield "## Settings"
        yield ""
        yield (
            "thresholds: measured over those with the usual settings; as before: ends on the same "
            "side of the tolerance; moved: 95 of 100 ends by less than that."
        )
        yield ""
        yield "| changed | jams | thresholds | as before | stray | moved | deepest |"
        yield "|---|---|---|---|---|---|---|"
        yield from (_setting_row(one) for one in document["settings"])
    for title, lines in (
        ("Failures", document["failures"]),
        ("Left out", [f"{one['case']}: {one['why']}" for one in document["skipped"]]),
    ):
        if lines:
            yield ""
            yield f"## {title}"
            yield ""
            yield from (f"- {line}" for line in lines)
    yield ""
    yield f"    {command}"


def _sums(document: dict[str, Any]) -> Iterator[str]:
    closings = [run for case in document["cases"] for run in case["closings"]]
    below = [run for run in closings if run["side"] == "below"]
    above = [run for run in closings if run["side"] == "above"]
    jams = [jam for case in document["cases"] for jam in case["jams"]]
    right, trials = sum(r["target"] for r in below), sum(r["trials"] for r in below)
    low, high = wilson(right, trials)
    most = rate_upper(trials - right, trials)
    afar = sum(r["from_afar"] for r in below)
    thin, held = (sum(r[key] for r in below) for key in ("near_level", "near_level_in_target"))
    yield (
        f"**{right} of {trials}** closings from below sigma_first(mu) ended in the target (rate "
        f"{low:.5f} to {high:.5f}, Wilson at 95 %; failures under {most:.2g}, Clopper-Pearson); "
        f"{afar} of them began outside the tolerance. {thin} more began so near to the level that "
        f"fingers sinking in may have carried them over: {held} of them ended in the target."
    )
    out = sum(r["trials"] - r["target"] for r in above)
    worst = max((r["residual"] for r in above), default=0.0)
    yield (
        f"**{sum(r['stray'] for r in above)} of {out}** ends outside the target from above were "
        f"where nothing holds; the largest residual was {worst:.1e} drive forces."
    )
    weak, strong = ([jam[kind] for jam in jams] for kind in ("weaker", "stronger"))
    near, nearer = (sum(1 for jam in jams if _within(jam, share)) for share in (0.05, 0.01))
    two = [jam for jam in jams if jam["touching"] == 2]
    early = sum(1 for jam in jams if jam["sticks_at"] and jam["sticks_at"] < 0.95 * jam["foretold"])
    yield (
        f"**{near} of {len(jams)}** limiting jams begin to hold within 5 % of the friction "
        f"foretold, {nearer} within 1 %; {early} hold at less. Of those on two contacts "
        f"{sum(1 for jam in two if _within(jam, 0.05))} of {len(two)} do. Beside them "
        f"{_stuck(weak)} hands stuck at 0.9 of it and "
        f"{_stuck(strong)} at 1.1."
    )


def _stuck(runs: list[dict[str, Any]]) -> str:
    return f"{sum(run['stuck'] for run in runs)} of {sum(run['trials'] for run in runs)}"


def _within(jam: dict[str, Any], share: float) -> bool:
    return jam["off"] is not None and abs(jam["off"]) <= share


def _closing_row(name: str, level: dict[str, Any], runs: dict[str, Any]) -> str:
    below, above = runs.get("below"), runs.get("above")
    deepest = max((run["penetration"] for run in runs.values()), default=0.0)
    first = "-" if level["sigma_first"] is None else f"{level['sigma_first']:.5f}"
    cells = (
        name, f"{level['mu']:g}", first,
        "-" if below is None else f"{below['target']}/{below['trials']}",
        "-" if below is None else f"{below['near_level_in_target']}/{below['near_level']}",
        "-" if below is None else str(below["from_afar"]),
        "-" if above is None else f"{above['target']}/{above['trials']}",
        str(sum(run["stray"] for run in runs.values())),
        "-" if above is None else f"{above['residual']:.0e}",
        "-" if above is None or above["to_nearest_jam"] is None
        else f"{above['to_nearest_jam']:.0e}",
        f"{deepest:.1e}",
    )  # fmt: skip
    return f"| {' | '.join(cells)} |"


def _jam_row(name: str, jam: dict[str, Any]) -> str:
    sticks, low, released = jam["sticks_at"], jam["slips_at"], jam["released_at"]
    end = "-" if sticks is None else f"{sticks:.5f}"
    off = "-" if jam["off"] is None else f"{100.0 * jam['off']:+.1f} %"
    weak, strong = jam["weaker"], jam["stronger"]
    cells = (
        name, f"{jam['sigma']:.5f}", f"{', '.join(map(str, jam['fingers']))} ({jam['touching']})",
        f"{jam['foretold']:.5f}", f"{low:.5f} to {end}",
        "-" if released is None else f"{released:.5f}", off,
        f"{weak['stuck']}/{weak['trials']}", f"{strong['stuck']}/{strong['trials']}",
        f"{weak['median_moved']:.1e}, {strong['median_moved']:.1e}",
    )  # fmt: skip
    return f"| {' | '.join(cells)} |"


def _setting_row(one: dict[str, Any]) -> str:
    low, high = one["threshold_ratio"]
    ratio = "-" if low is None else f"{low:.4f} to {high:.4f}"
    return (
        f"| {one['setting']} | {one['jams']} | {ratio} | "
        f"{one['same_side_of_the_tolerance']}/{one['trials']} | {one['stray']} | "
        f"{one['moved_95']:.1e} | {one['penetration']:.1e} |"
    )
