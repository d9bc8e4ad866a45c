"""What ``icage grasps`` answers for one object: a document of format ``icage-grasps/1``."""

from __future__ import annotations

from argparse import Namespace
from typing import Any

from experiments.cases.free_gap import free_gap
from icage.cage import Cage
from icage.case import Case
from icage.formats.case_json import GRASPS, object_document
from icage.formats.plan_json import wedge_document
from icage.grasps.planned import PlannedGrasps


def grasps_document(case: Case, planned: PlannedGrasps, args: Namespace) -> dict[str, Any]:
    """The first ``args.top`` grasps and what came to nothing; lengths in the case's unit."""
    best = zip(planned.cages[: args.top], planned.scores, planned.alike, strict=False)
    return {
        **object_document(case, GRASPS),
        "aim": args.aim,
        **({} if args.mu is None else {"mu": args.mu}),
        "grasps": [{**_entry(cage, score), "alike": alike} for cage, score, alike in best],
        "failed": [{"contacts": f.contacts, "why": f.why} for f in planned.failures],
        "triples_left_out": planned.triples_left_out,
        "unplanned": planned.unplanned,
        "searches_broken_off": planned.searches_broken_off,
        "ended": planned.ended,
    }


def _entry(cage: Cage, score: float) -> dict[str, Any]:
    return {
        "contacts": cage.contacts,
        "phi_deg": cage.hand.phi_deg,
        "sigma_0": cage.sigma_0,
        "sigma_first": cage.sigma_first,
        "sigma_max": cage.sigma_max,
        "score": score,
        **({} if cage.wedge is None else {"wedge": wedge_document(cage.wedge)}),
        "free_gap": free_gap(cage),
        "verdict": cage.status,
        "free_fingers": cage.grasps[0].free_fingers,
        "escape_free_fingers": cage.punctures[-1].free_fingers if cage.sigma_max else None,
    }
