"""A cage as the document ``icage-plan/1``, and as a few lines to read."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, Final

import shapely

from icage.brink import Brink
from icage.cage import Cage
from icage.cells.regions import FingerRegion
from icage.search_log import SearchLog
from icage.shelf import Shelf
from icage.wedge import Wedge, WedgeKind


def plan_document(
    cage: Cage,
    regions: Sequence[FingerRegion],
    name: str,
    unit: str,
    *,
    exact_fit: bool = False,
) -> dict[str, Any]:
    """Everything about a cage that outlives this process; lengths in ``unit``.

    ``exact_fit`` asks for its wedge, too: two more searches.
    """
    wedge = cage.wedge if exact_fit else None
    return {
        "format": "icage-plan/1",
        "name": name,
        "unit": unit,
        "diameter": cage.outline.diameter,
        "outline": {"vertices": cage.outline.vertices},
        "finger_radius": cage.finger_radius,
        "hand": {"phi_deg": cage.hand.phi_deg, "unit_fingers": cage.hand.unit_fingers},
        "verdict": cage.status,
        **({"why": cage.why} if cage.why is not None else {}),
        "contacts": cage.contacts,
        "adjusted_by": cage.adjusted_by,
        "sigma_0": cage.sigma_0,
        "sigma_first": cage.sigma_first,
        "sigma_max": cage.sigma_max,
        **({} if cage.shelf is None else {"shelf": _stop(cage.shelf)}),
        **({} if cage.brink is None else {"brink": _stop(cage.brink)}),
        **({} if wedge is None else {"wedge": wedge_document(wedge)}),
        **(_brackets(cage) if cage.finger_radius > 0.0 else {}),
        "punctures": [
            {
                "sigma": puncture.sigma,
                "kind": puncture.kind,
                "joins": puncture.joins,
                "contacts": puncture.contacts,
                "free_fingers": puncture.free_fingers,
            }
            for puncture in cage.punctures
        ],
        "escape_path": cage.escape_path,
        "escape_free_at": cage.escape_free_at,
        "min_finger_gap": cage.min_finger_gap,
        "grasps": [
            {
                "id": grasp.id,
                "target": grasp.target,
                "sigma_0": grasp.sigma,
                "contacts": grasp.contacts,
                "free_fingers": grasp.free_fingers,
                **({"plateau": grasp.plateau} if grasp.plateau is not None else {}),
            }
            for grasp in cage.grasps
        ],
        "regions": [_region(region) for region in regions],
        "warnings": cage.warnings,
        **({"search": _search(cage.search)} if cage.search is not None else {}),
    }


def _stop(stop: Shelf | Brink) -> dict[str, Any]:
    return {"sigma": stop.sigma, "contacts": stop.contacts}


def wedge_document(wedge: Wedge) -> dict[str, Any]:
    """A wedge as in ``icage-plan/1``."""
    return {
        "sigma": wedge.sigma,
        "kind": wedge.kind,
        "fit": wedge.fit,
        "contacts": wedge.contacts,
    }


def _search(log: SearchLog) -> dict[str, Any]:
    return {
        "iterations": [
            {"sigma": step.sigma, "pair": step.pair, "edges": step.edges, "kind": step.kind}
            for step in log.iterations
        ],
        "rectangles_explored": log.rectangles_explored,
        "rectangles_total": log.rectangles_total,
        "nodes": log.nodes,
        "tunnel_edges_tried": log.tunnel_edges_tried,
        "tunnel_edges_used": log.tunnel_edges_used,
    }


def _brackets(cage: Cage) -> dict[str, Any]:
    return {
        "sigma_first_upper": cage.sigma_first_upper,
        "sigma_first_converged": cage.sigma_first_converged,
        "sigma_max_lower": cage.sigma_max_lower,
        "sigma_max_upper": cage.sigma_max_upper,
    }


def _region(region: FingerRegion) -> dict[str, Any]:
    return {
        "finger": region.finger,
        "level": region.level_name,
        "bound": region.bound,
        "area_gap": region.area_gap,
        "polygons": [
            {"outer": _ring(part.exterior, ccw=True), "holes": [_ring(h) for h in part.interiors]}
            for part in region.geometry.geoms
        ],
    }


def _ring(ring: shapely.LinearRing, ccw: bool = False) -> list[list[float]]:
    """An open ring; outer ones counterclockwise, holes clockwise."""
    points = shapely.get_coordinates(ring)[:-1]
    return (points if ring.is_ccw == ccw else points[::-1]).tolist()


def plan_summary(cage: Cage, name: str, unit: str, *, exact_fit: bool = False) -> Iterator[str]:
    """Lines for a reader: what holds, up to which opening, and what comes after.

    ``exact_fit`` asks what of it hangs on an exact fit, too.
    """
    phi_1, phi_2 = cage.hand.phi_deg
    yield (
        f"{name}: {len(cage.outline)} vertices, diameter {cage.outline.diameter:.6g} {unit}, "
        f"hand (phi_1, phi_2) = ({phi_1:.4g}, {phi_2:.4g}) deg, {_fingers(cage, unit)}"
    )
    yield f"verdict      {cage.status.replace('_', ' ')}{f': {cage.why}' if cage.why else ''}"
    yield f"sigma_0      {cage.sigma_0:.9g} {unit}"
    if cage.status != "not_a_cage":
        ends = "closing ends only in the target"
        stops = {"shelf": cage.shelf, "brink": cage.brink}
        on = " or ".join(f"a {name}" for name, stop in stops.items() if stop is not None)
        stays = f", or stays on {on}" if on else ""
        wedge = cage.wedge if exact_fit else None
        exact = "" if wedge is None else ", if all fits exactly"
        yield _level("sigma_first", cage.sigma_first, cage, ends + stays + exact)
        if cage.shelf is not None:
            yield _level("shelf", cage.shelf.sigma, cage, f"{ends} (parallel edges){exact}")
        if cage.brink is not None:
            yield _level("brink", cage.brink.sigma, cage, f"{ends} (the end of an edge){exact}")
        if wedge is not None:
            yield _wedge_line(cage, wedge, unit)
        yield _level("sigma_max", cage.sigma_max, cage, "the object cannot escape")
        for puncture in cage.punctures:
            joins = f", joins grasp {', '.join(map(str, puncture.joins))}" if puncture.joins else ""
            yield f"puncture     {puncture.sigma:.9g} {unit}, {puncture.kind}{joins}"
        yield f"grasps       {len(cage.grasps)}, the target among them"
        if cage.escape_path is not None:
            yield (
                f"escape path  {len(cage.escape_path)} rows, the object is free from row "
                f"{cage.escape_free_at} on (counted from 0)"
            )
        yield "regions      in the JSON from inside and from outside: draw the inner, safe ones"
    if cage.search is not None:
        log = cage.search
        yield (
            f"search       {len(log.iterations)} nodes met, {log.rectangles_explored} of "
            f"{log.rectangles_total} rectangles, {log.tunnel_edges_used} tunnel edges used "
            f"({log.tunnel_edges_tried} tried)"
        )
    for warning in cage.warnings:
        yield f"warning      {warning}"


_WEDGED: Final = {
    WedgeKind.THINNER: "fingers {fit:.2g} {unit} thinner may end elsewhere",
    WedgeKind.THICKER: "fingers {fit:.2g} {unit} thicker may end elsewhere",
}


def _wedge_line(cage: Cage, wedge: Wedge, unit: str) -> str:
    why = _WEDGED[wedge.kind].format(fit=wedge.fit, unit=unit)
    if wedge.sigma <= cage.sigma_0:
        return f"wedge        closing ends in the target by an exact fit only: {why}"
    return _level("wedge", wedge.sigma, cage, f"this hangs on no exact fit ({why})")


def _fingers(cage: Cage, unit: str) -> str:
    if cage.finger_radius == 0.0:
        return "point fingers"
    return f"disc fingers of radius {cage.finger_radius:.6g} {unit}"


def _level(name: str, sigma: float | None, cage: Cage, meaning: str) -> str:
    if sigma is None:
        return f"{name:<13}none: {meaning}, however far the hand opens"
    return f"{name:<13}{sigma:.9g} ({sigma / cage.sigma_0:.6g} sigma_0): below it {meaning}"
