"""The grasps that are asked for: the best of any hand, or all of one."""

from __future__ import annotations

from argparse import Namespace

from experiments.cases.chosen import best_grasps_of
from experiments.grasps.wanted_by_options import refuse_limits, wanted_of
from icage.case import Case
from icage.grasps.of_one_hand import grasps_of_hand
from icage.grasps.planned import PlannedGrasps, planned_grasps_of_hand
from icage.grasps.wanted import Wanted
from icage.hand import HandShape
from icage.kernels.compiled import long_job


def planned_grasps(case: Case, args: Namespace) -> PlannedGrasps:
    """Grasps in the order in which they are listed, each planned.

    Raises
    ------
    InputError:
        The options fit neither a search nor one hand, or there is no such grasp.
    """
    if args.phi is not None and args.within is None:
        refuse_limits(args)
        long_job()
        return _of_one_hand(case, args.phi, Wanted(args.aim, mu=args.mu))
    return best_grasps_of(case, args.top, wanted_of(args), args.seed, args.workers, args.seconds)


def _of_one_hand(case: Case, phi: list[float], wanted: Wanted) -> PlannedGrasps:
    radius = case.finger_radius
    hand = HandShape.from_angles_deg(phi[0], phi[1])
    found = grasps_of_hand(case.outline, hand, radius)
    return planned_grasps_of_hand(case.outline, radius, hand, found, wanted)
