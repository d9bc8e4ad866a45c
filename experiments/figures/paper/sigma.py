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
from icage.arrays import FloatArray
from icage.contact_space.basins import escape_edge, meetings
from icage.contact_space.kernels.explore import TUNNEL
from icage.tolerance import DEPTH_CUT

_STEPS = 12
"""Points drawn between two seams: sigma is convex there."""


def draw(study: Study) -> tuple[Figure, str | None]:
    """(a) sigma along the way out; (b) sigma and its running maximum over the iterations."""
    figure = new_sheet(4.8)
    along, over = figure.subplots(2, 1)
    edges = [m.edge for m in meetings(study.found, DEPTH_CUT * study.polygon.diameter)]
    if study.found.escaped:
        edges.append(escape_edge(study.found))
        count = _way(along, study, set(edges))
        heading(along, "a", r"$\sigma$ along the way out, from the target to a pinched hand")
    else:
        count = 0
        along.set_axis_off()
        along.text(0.5, 0.5, "the hand never escapes: there is no way out", ha="center")
    _iterations(over, study, edges)
    heading(over, "b", "nodes in the order in which they were met, and the running maximum")
    keys = [
        Line2D([], [], color=PURPLE, lw=1.3, label=r"$\sigma$ on the way out"),
        Line2D([], [], color=SKY, marker=".", ms=4.0, lw=0.4, label=r"$\sigma$ of a node"),
        Line2D([], [], color=INK, lw=1.2, label="running maximum"),
        Line2D([], [], ls="", marker="o", ms=5.0, color=FINGERS[0], label="immobilizing grasp"),
        Line2D([], [], ls="", marker="s", ms=5.0, color=ORANGE, label="puncture"),
    ]
    figure.legend(handles=keys, loc="outside lower center", ncols=5)
    return figure, f"{len(edges)} punctures, {count} of them on the way out"


def _way(axes: Axes, study: Study, punctures: set[int]) -> int:
    """Sigma over the length of the path in (d, w); returns how many punctures lie on it."""
    found = study.found
    hands: list[FloatArray] = [study.look.target.hand]
    at: dict[int, int] = {}
    for e in found.way_out():
        hands.append(found.hands[e, 1:5])
        at[e] = len(hands) - 1
        if found.edges[e, 3] == TUNNEL:
            hands.append(found.hands[e, 5:9])
    last = hands[-1].copy()
    hands.append(_pinched(study, last))
    lengths = [float(np.hypot(*np.abs(_moved(study, a, b)))) for a, b in pairwise(hands)]
    stops = np.concatenate([[0.0], np.cumsum(lengths)])
    share = np.linspace(0.0, 1.0, _STEPS)
    x = np.concatenate([a + share * (b - a) for a, b in pairwise(stops)])
    w = np.concatenate([a[2:] + share[:, None] * (b - a)[2:] for a, b in pairwise(hands)])
    axes.plot(x, np.hypot(*w.T), color=PURPLE, lw=1.3, zorder=3)
    sigma = np.array([np.hypot(h[2], h[3]) for h in hands])
    axes.plot(stops[1:-1], sigma[1:-1], ".", ms=2.5, color=PURPLE, zorder=4)
    axes.plot(0.0, sigma[0], "o", ms=6.0, color=FINGERS[0], mec="white", zorder=5, clip_on=False)
    here = sorted(punctures & at.keys(), key=lambda e: stops[at[e]])
    for e in here:
        axes.plot(stops[at[e]], sigma[at[e]], "s", ms=6.0, color=ORANGE, mec="white", zorder=5)
    _levels(axes, study)
    axes.set_xlim(0.0, stops[-1])
    axes.set_xlabel(f"way of the fingers, largest of the three [{study.case.unit}]", labelpad=1.0)
    return len(here)


def _moved(study: Study, a: FloatArray, b: FloatArray) -> FloatArray:
    """The longest move of a finger between two hands, as a vector (2,)."""
    moves = study.plane.contacts(b) - study.plane.contacts(a)
    return moves[int(np.argmax(np.hypot(*moves.T)))]


def _pinched(study: Study, last: FloatArray) -> FloatArray:
    """The pinched hand at the end of the way out."""
    path = study.look.escape_path()
    assert path is not None
    x, y = path[0][-1, :2] - study.plane.origin
    return np.array([x, y, 0.0, 0.0])


def _iterations(axes: Axes, study: Study, punctures: list[int]) -> None:
    """The log of the search; punctures where their edge was crossed."""
    found = study.found
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
    axes.plot(rows, sigma[rows], "s", ms=5.0, color=ORANGE, mec="white", ls="", zorder=5)
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
    """Lines at sigma_0, sigma_first, sigma_max with names at the right."""
    found = study.found
    names = {study.sigma_0: r"$\sigma_0$"}
    first, last = study.look.sigma_first, found.level
    close = np.isfinite(last) and abs(last - first) < 0.05 * (last - study.sigma_0)
    if np.isfinite(last):
        names[last] = r"$\sigma_{\mathrm{max}}$"
        if first != last and close:
            names[last] = r"$\sigma_{\mathrm{first}}, \sigma_{\mathrm{max}}$"
    if np.isfinite(first) and first != last and not close:
        names[first] = r"$\sigma_{\mathrm{first}}$"
    axes.set_ylim(bottom=0.0)
    below = None
    for value, name in sorted(names.items()):
        axes.axhline(value, color=QUIET_INK, lw=0.6, ls=(0, (4, 3)), zorder=1)
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
