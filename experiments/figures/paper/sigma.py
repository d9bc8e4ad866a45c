"""Sigma along the way out, and over the iterations of the search. [Bunis2018, Sec. VI]

The paper reads punctures off as local maxima of sigma over the closed list. The order in which
nodes leave the open list jumps between branches, so most of those maxima are no punctures: the way
out shows its punctures, and the running maximum rises to each of them.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from experiments.figures.drawing.palette import FINGERS, INK, ORANGE, PURPLE, QUIET_INK, SKY
from experiments.figures.paper.page import heading, new_sheet
from experiments.figures.paper.study import Study
from icage.contact_space.basins import escape_edge, meetings
from icage.tolerance import DEPTH_CUT

_STEPS = 12
"""Points drawn between two rows of the path: sigma is convex there."""

_CLOSE = 0.03
"""[sigma_max] Levels this close share one name."""

_ASIDE = "puncture off the way (a), of the search (b)"


def draw(study: Study) -> tuple[Figure, str | None]:
    """(a) sigma along the plan's way out; (b) sigma and its running maximum over the iterations."""
    figure = new_sheet(4.8)
    along, over = figure.subplots(2, 1)
    count = _way(along, study)
    _iterations(over, study)
    where = f", on {study.segments} chords a quadrant" if study.segments else ""
    heading(over, "b", f"nodes in the order in which one search met them{where}; running maximum")
    keys = [
        Line2D([], [], color=PURPLE, lw=1.3, label=r"$\sigma$ on the way out"),
        Line2D([], [], color=SKY, marker=".", ms=4.0, lw=0.4, label=r"$\sigma$ of a node"),
        Line2D([], [], color=INK, lw=1.2, label="running maximum"),
        Line2D([], [], ls="", marker="o", ms=5.0, color=FINGERS[0], label="immobilizing grasp"),
        Line2D([], [], ls="", marker="s", ms=5.0, color=ORANGE, label="puncture of the plan"),
        Line2D([], [], ls="", marker="s", ms=4.5, mfc="none", color=ORANGE, label=_ASIDE),
    ]
    figure.legend(handles=keys, loc="outside lower center", ncols=3)
    levels = ", ".join(
        f"{'escape' if p.kind == 'escape' else 'joins ' + ' '.join(map(str, p.joins))} at "
        f"{p.sigma:.9g}"
        for p in study.answer.punctures
    )
    total = len(study.answer.punctures)
    count_words = f"{total} puncture{'' if total == 1 else 's'} of the plan"
    unit = study.case.unit
    return figure, f"{count_words} [{unit}]: {levels or 'none'}; {count} on the way out"


def _way(axes: Axes, study: Study) -> int:
    """Sigma over the way of the fingers on the plan's escape path; how many punctures lie on it.

    Drawn to where the object is free: the rest of the path only pinches the hand.
    """
    cage = study.answer
    path, free = cage.escape_path, cage.escape_free_at
    if path is None or free is None:
        axes.set_axis_off()
        words = "the hand never escapes" if cage.status == "never_escapes" else "not a cage"
        axes.text(0.5, 0.5, f"{words}: there is no way out", ha="center")
        return 0
    heading(axes, "a", r"$\sigma$ along the plan's way out, until the object is free")
    rows = path[: free + 1]
    hands = cage.hand.fingers(rows)
    lengths = np.hypot(*np.moveaxis(np.diff(hands, axis=0), -1, 0)).max(axis=1)
    stops = np.concatenate([[0.0], np.cumsum(lengths)])
    share = np.linspace(0.0, 1.0, _STEPS)
    w = rows[:, 3] * np.exp(1j * rows[:, 2])
    x = np.concatenate([a + share * (b - a) for a, b in pairwise(stops)])
    sigma = np.abs(np.concatenate([a + share * (b - a) for a, b in pairwise(w)]))
    axes.plot(x, sigma, color=PURPLE, lw=1.3, zorder=3)
    axes.plot(stops[1:], rows[1:, 3], ".", ms=2.5, color=PURPLE, zorder=4)
    axes.plot(
        0.0, cage.sigma_0, "o", ms=6.0, color=FINGERS[0], mec="white", zorder=5, clip_on=False
    )
    # With discs the path keeps clear of the arcs' tangents, the punctures lie on their chords.
    near = max(study.near, 0.05 * cage.finger_radius)
    count = 0
    for puncture in cage.punctures:
        off = np.hypot(*np.moveaxis(hands - puncture.contacts, -1, 0)).max(axis=1)
        on_way = bool(off.min() <= near)
        at = stops[int(np.argmin(off))] if on_way else 0.02 * stops[-1]
        face = ORANGE if on_way else "none"
        edge, size = ("white", 6.0) if on_way else (ORANGE, 5.0)
        axes.plot(at, puncture.sigma, "s", ms=size, mfc=face, mec=edge, zorder=5, clip_on=False)
        count += on_way
    _levels(axes, study)
    axes.set_xlim(0.0, stops[-1])
    axes.set_xlabel(f"way of the fingers, largest of the three [{study.case.unit}]", labelpad=1.0)
    return count


def _iterations(axes: Axes, study: Study) -> None:
    """The log of the search; punctures where their edge was crossed.

    With discs the search is on one coarse polygon: its punctures are not the plan's, and hollow.
    """
    found = study.found
    punctures = [m.edge for m in meetings(found, DEPTH_CUT * study.polygon.diameter)]
    if found.escaped:
        punctures.append(escape_edge(found))
    steps = found.log().iterations
    sigma = np.array([step.sigma for step in steps])
    axes.plot(sigma, ".-", ms=2.5, lw=0.3, color=SKY, zorder=2)
    axes.plot(np.maximum.accumulate(sigma), color=INK, lw=1.2, zorder=3, drawstyle="steps-post")
    first = _iteration_of_region(study)
    minima = {0}
    for met in meetings(found, DEPTH_CUT * study.polygon.diameter):
        minima |= set(met.minima)
    rows = sorted(first[node] for node in minima)
    axes.plot(rows, sigma[rows], "o", ms=5.0, color=FINGERS[0], mec="white", ls="", zorder=5)
    at = _iteration_of_edge(study)
    rows = sorted({at[e] for e in punctures})
    face, edge = ("none", ORANGE) if study.segments else (ORANGE, "white")
    axes.plot(rows, sigma[rows], "s", ms=5.0, mfc=face, mec=edge, ls="", zorder=5)
    _levels(axes, study)
    axes.set_xlim(-0.01 * len(sigma), 1.01 * len(sigma))
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set_xlabel("iteration", labelpad=1.0)


def _iteration_of_edge(study: Study) -> list[int]:
    """Index in the log of each edge: it is followed by the region that it reached first."""
    found, at = study.found, []
    k = 1
    for e, to in enumerate(found.edges[:, 1].tolist()):
        at.append(k)
        k += 2 if to >= 0 and found.regions[to, 4] == e else 1
    return at


def _iteration_of_region(study: Study) -> list[int]:
    """Index in the log of each region's least node."""
    at = _iteration_of_edge(study)
    return [at[int(e)] + 1 if e >= 0 else 0 for e in study.found.regions[:, 4]]


def _levels(axes: Axes, study: Study) -> None:
    """Lines at the plan's sigma_0, sigma_first, sigma_max with names at the right."""
    cage = study.answer
    names: dict[float, str] = {cage.sigma_0: r"$\sigma_0$"}
    first, last = cage.sigma_first, cage.sigma_max
    close = last is not None and first is not None and abs(last - first) < _CLOSE * last
    if last is not None:
        names[last] = r"$\sigma_{\mathrm{max}}$"
        if first != last and close:
            names[last] = r"$\sigma_{\mathrm{first}}, \sigma_{\mathrm{max}}$"
    if first is not None and first != last:
        names[first] = "" if close else r"$\sigma_{\mathrm{first}}$"
    axes.set_ylim(bottom=0.0)
    below = None
    for value, name in sorted(names.items()):
        axes.axhline(value, color=QUIET_INK, lw=0.6, ls=(0, (4, 3)), zorder=1)
        if not name:
            continue
        tight = below is not None and value - below < 0.09 * axes.get_ylim()[1]
        below = value
        shift = 5.0 if tight else (-5.0 if _next(names, value, axes) else 0.0)
        axes.annotate(
            name, (1.0, value), (4.0, shift),
            xycoords=("axes fraction", "data"), textcoords="offset points", va="center",
            fontsize=8.0, annotation_clip=False,
        )  # fmt: skip
    axes.set_ylabel(rf"$\sigma$ [{study.case.unit}]", labelpad=2.0)
    axes.tick_params(length=2.0, pad=1.5)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def _next(levels: dict[float, str], value: float, axes: Axes) -> bool:
    """Whether another level lies so close above that the names would touch."""
    return any(0.0 < other - value < 0.09 * axes.get_ylim()[1] for other in levels)
