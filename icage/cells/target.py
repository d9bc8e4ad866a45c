"""The target: the strict local minimum of sigma next to the contacts that were asked for."""

from __future__ import annotations

from dataclasses import dataclass, replace

from icage.arrays import FloatArray, IntArray
from icage.cells.free_space import Configuration, FreeSpace, Search, search
from icage.cells.kernels import minimum, near, plateau
from icage.cells.kernels.columns import (
    BIRTH_SIGMA,
    NEAR_DX,
    NEAR_DY,
    NEAR_MOVED,
    NEAR_SIGMA,
    NEAR_TURNED,
    NEAR_WX,
    NEAR_WY,
)
from icage.cells.kernels.near import Hand
from icage.cells.kernels.tree import births
from icage.cells.largest_sigma import opens_to
from icage.errors import GraspError
from icage.tolerance import DEPTH_CUT, NOT_A_CAGE, SAME_POINT, TARGET_SHIFT, TARGET_TURN

_MAX_CELLS = minimum.MOST_CELLS


@dataclass(frozen=True, slots=True)
class Target:
    """A local minimum, the cell to start from, and how far it is from what was asked."""

    at: Configuration
    cell: IntArray
    sigma_0: float
    moved: float
    turned: float
    plateau: tuple[Configuration, Configuration] | None


def find_target(
    free_space: FreeSpace,
    wanted: Configuration,
    *,
    reach: float = TARGET_SHIFT,
    turn: float = TARGET_TURN,
) -> Target | None:
    """The local minimum nearest to a configuration, or None if there is none within ``reach``.

    ``reach`` [diameter] bounds how far a finger may be from where it was asked to be, ``turn``
    [rad] by how much the hand may turn.

    Raises
    ------
    GraspError:
        More cells meet round the contacts than can be looked at: to leave some out could miss the
        way to close further.
    """
    found = minimum.nearest_minimum(
        free_space.pieces, free_space.z, _hand(wanted), reach, turn, free_space.cap,
        free_space.worst, _MAX_CELLS,
    )  # fmt: skip
    if found.total > _MAX_CELLS:
        raise GraspError(
            f"{found.total} cells meet round the contacts; at most {_MAX_CELLS} fit: too many "
            "vertices lie within a hair of them, simplify the outline"
        )
    if found.row < 0:
        return None
    best: Target | None = _target(found, found.row)
    if found.plateau.long:
        best = replace(best, plateau=_ends(found.plateau, best.at))
    around = _search_to_the_cut(free_space, best)
    if best.plateau is None and not _has_depth(around, best.sigma_0):
        best = _nearest_deep(free_space, _all_of(found))
        if best is None:
            return None
        around = _search_to_the_cut(free_space, best)
    if not _isolated(around, best.sigma_0):
        return best
    return _not_isolated(free_space, _all_of(found), around) or best


def _search_to_the_cut(free_space: FreeSpace, target: Target) -> Search:
    """What lies round a minimum up to the depth cut."""
    top = target.sigma_0 + DEPTH_CUT * free_space.pieces.diameter
    return search(free_space, target.cell, target.sigma_0, stop_above=top)


def _nearest_deep(free_space: FreeSpace, others: list[Target]) -> Target | None:
    """The nearest minimum of those that are deep enough to count, each place looked at once."""
    best: Target | None = None
    for target in others:
        if best is not None and target.moved >= best.moved - SAME_POINT:
            continue
        if not is_local_minimum(free_space, target.at, target.sigma_0):
            continue
        ends = plateau_through(free_space, target.at, target.sigma_0)
        around = _search_to_the_cut(free_space, target)
        if ends is not None or _has_depth(around, target.sigma_0):
            best = replace(target, plateau=ends)
    return best


def _all_of(found: minimum.Nearest) -> list[Target]:
    """The least points of all cells near the contacts, by sigma."""
    return [_target(found, row) for row in range(len(found.near))]


def _target(found: minimum.Nearest, row: int) -> Target:
    """The least point of a cell near the contacts, as if it were a strict minimum."""
    here = found.near[row].tolist()
    at = Configuration(complex(here[NEAR_DX], here[NEAR_DY]), complex(here[NEAR_WX], here[NEAR_WY]))
    return Target(at, found.cells[row], here[NEAR_SIGMA], here[NEAR_MOVED], here[NEAR_TURNED], None)


def _hand(at: Configuration) -> Hand:
    return Hand(at.d.real, at.d.imag, at.w.real, at.w.imag)


def _ends(found: plateau.Plateau, at: Configuration) -> tuple[Configuration, Configuration]:
    a, b = complex(found.a_x, found.a_y), complex(found.b_x, found.b_y)
    return Configuration(a, at.w), Configuration(b, at.w)


def _isolated(around: Search, sigma: float) -> bool:
    """Whether a hand of this least sigma can do nothing; ``around`` is the search up to the cut."""
    return around.never_escapes and not opens_to(around, sigma * (1.0 + NOT_A_CAGE))


def _not_isolated(free_space: FreeSpace, others: list[Target], shut: Search) -> Target | None:
    """The nearest minimum that can open, of the least points of cells.

    Where more fingers are held than are needed, rounding of the hand's shape may leave a point of
    free space behind, shut off from the minimum that it was and lower by a little. ``shut`` is the
    search of that point; whoever lies in it, or in another like it, is not looked at again.
    """
    seen = _cells_of(shut)
    for target in sorted(others, key=lambda t: (t.moved, t.sigma_0)):
        if tuple(target.cell.tolist()) in seen:
            continue
        around = _search_to_the_cut(free_space, target)
        if _isolated(around, target.sigma_0):
            seen |= _cells_of(around)
        elif _has_depth(around, target.sigma_0):
            return replace(target, plateau=plateau_through(free_space, target.at, target.sigma_0))
    return None


def _cells_of(found: Search) -> set[tuple[int, ...]]:
    return {tuple(row) for row in found.nodes[:, :3].tolist()}


def is_local_minimum(free_space: FreeSpace, here: Configuration, sigma: float) -> bool:
    """Whether no cell round the configuration goes deeper by more than the depth cut."""
    return minimum.is_local_minimum(
        free_space.pieces, free_space.z, _hand(here), sigma, free_space.cap, free_space.worst
    )


def is_strict_minimum(free_space: FreeSpace, here: Configuration, sigma: float) -> bool:
    """Whether it is such a minimum and no ``plateau_through`` it leads away."""
    return minimum.is_strict_minimum(
        free_space.pieces, free_space.z, _hand(here), sigma, free_space.cap, free_space.worst
    )


def _has_depth(around: Search, sigma: float) -> bool:
    """Whether a hand of this least sigma must open by more than the depth cut to close further.

    ``around`` is the search up to the cut. A minimum that is less deep does not
    count. [docs/formats.md, Tolerances]
    """
    if around.escaped:
        return False
    free_space = around.free_space
    value, _ = births(
        free_space.pieces, free_space.z, around.nodes, free_space.cap, free_space.worst
    )
    return bool(value[:, BIRTH_SIGMA].min() >= sigma - DEPTH_CUT * free_space.pieces.diameter)


def plateau_through(
    free_space: FreeSpace, here: Configuration, sigma: float
) -> tuple[Configuration, Configuration] | None:
    """Ends of the translations at constant sigma through a minimum (opposing parallel edges)."""
    found = plateau.plateau_through(
        free_space.pieces, free_space.z, _hand(here), sigma, free_space.cap, free_space.worst,
        minimum.MOST_CELLS,
    )  # fmt: skip
    return _ends(found, here) if found.long else None


def cells_near(free_space: FreeSpace, at: Configuration, reach: float) -> IntArray:
    """All cells (k, fingers) whose pieces come within ``reach`` [unit] of the fingers."""
    return near.cells_near(free_space.pieces, free_space.z, _hand(at), reach, minimum.MOST_CELLS)[0]


def contacts_as_configuration(free_space: FreeSpace, contacts: FloatArray) -> Configuration:
    """The configuration whose fingers 1 and 2 are at the first two contacts."""
    d = complex(*(contacts[0] - free_space.origin))
    return Configuration(d, complex(*(contacts[1] - contacts[0])))
